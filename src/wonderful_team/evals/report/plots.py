"""Plots of a study by matplotlib, as SVG text that goes into the page."""

from __future__ import annotations

import io
import warnings
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from wonderful_team.core.intervals import wilson_interval
from wonderful_team.errors import MissingExtraError
from wonderful_team.evals.ablation import NOT_SCORED, ends_seen
from wonderful_team.evals.names import NO_MODEL, short_names
from wonderful_team.evals.paper import paper_beside
from wonderful_team.evals.summary import Summary
from wonderful_team.evals.trials import PRIVILEGED, Condition

_MARKS = "osD^vP*X<>"
MOST_PER_TASK = 5
"""Conditions side by side that a plot per task can still show."""
LONGEST_TICK = 40
INCH_A_LETTER = 0.075
LEAST_LABELLED = 3.0
"""Least share of a bar that has room for its number [%]."""
_END_COLOURS = {
    "success": "#9cc7a3", "planning": "#e6a04d", "grounding": "#6f9fd0", "execution": "#b08fc7", "crash": "#c0504d", NOT_SCORED: "#d5d8dc",
}  # fmt: skip
_BLUE, _GREY = "#2b5c8a", "#8a8f98"


def rate_plot(summary: Summary) -> str:
    """Success of every condition with its 95 % interval; controls in grey."""
    conditions = [one for one in (*summary.main, *summary.main_bounds) if summary.cell(one).rate.n]
    names, model = _names(conditions, summary)
    figure, axes = _figure(7.2 + _wider(names.values()), 0.9 + 0.42 * max(1, len(conditions)))
    for place, one in enumerate(reversed(conditions)):
        rate = summary.cell(one).rate
        low, high = wilson_interval(rate.successes, rate.n)
        share = rate.successes / rate.n
        errors = [[100 * max(0.0, share - low)], [100 * max(0.0, high - share)]]
        axes.errorbar(100 * share, place, xerr=errors, fmt="o", color=_colour(one, summary), capsize=4)
    rates = {one: summary.cell(one).rate for one in conditions}
    axes.set_yticks(
        range(len(conditions)),
        [f"{names[one]} ({rates[one].successes}/{rates[one].n})" for one in reversed(conditions)],
    )
    axes.set_ylim(-0.6, len(conditions) - 0.4)
    axes.set_xlim(-3, 103)
    axes.set_xlabel(f"success{model} [%],\n95 % Wilson interval")
    return _svg(figure)


def cost_plot(summary: Summary) -> str:
    """Success against cost per trial: money where all prices are known, else calls; "" where nothing was asked or paid."""
    conditions = [one for one in (*summary.main, *summary.main_bounds) if summary.cell(one).rate.n]
    cells = {one: summary.cell(one) for one in conditions}
    paid = [cell for cell in cells.values() if cell.usd_per_trial]
    in_money = bool(paid) and all(cell.usd_per_trial is not None for cell in cells.values())
    if not in_money and not any(cell.mean("calls") for cell in cells.values()):
        return ""
    names, model = _names(conditions, summary)
    figure, axes = _figure(8.6 + _wider(names.values()), max(3.4, 0.21 * len(conditions)))
    for place, (one, cell) in enumerate(cells.items()):
        across = cell.usd_per_trial if in_money else cell.mean("calls")
        low, high = wilson_interval(cell.rate.successes, cell.rate.n)
        share = cell.rate.successes / cell.rate.n
        errors = [[100 * max(0.0, share - low)], [100 * max(0.0, high - share)]]
        style = {"fmt": _MARKS[place % len(_MARKS)], "capsize": 4, "label": names[one], "alpha": 0.8}
        axes.errorbar(across or 0.0, 100 * share, yerr=errors, color=f"C{place % 10}", **style)
    axes.set_ylim(-5, 108)
    axes.margins(x=0.1)
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    axes.set_xlabel("USD per trial" if in_money else "model calls per trial\n(no price is known, or nothing was paid)")
    axes.set_ylabel(f"success{model} [%]".replace(" with ", "\nwith "))
    return _svg(figure)


def task_plot(summary: Summary) -> str:
    """Success per task of what was compared, the paper's figures as hollow diamonds; "" for one task or too many conditions."""
    conditions = [one for one in summary.main if summary.cell(one).rate.n]
    if len(summary.tasks) < 2 or not 1 <= len(conditions) <= MOST_PER_TASK:
        return ""
    sides = [(one, False) for one in conditions] + [(one, True) for one in conditions]
    sides = [side for side in sides if not side[1] or any(paper_beside(task, side[0]) for task in summary.tasks)]
    figure, axes = _figure(8.6, 1.0 + (0.14 + 0.1 * len(sides)) * len(summary.tasks))
    for place, (one, published) in enumerate(sides):
        shift = (place - (len(sides) - 1) / 2) * 0.8 / len(sides)
        found = [_task_rate(summary, one, task, published) for task in summary.tasks]
        drawn = [(row + shift, *rate) for row, rate in enumerate(found) if rate is not None]
        if not drawn:
            continue
        rows, shares, lows, highs = zip(*drawn, strict=True)
        errors = [
            [s - low for s, low in zip(shares, lows, strict=True)],
            [h - s for s, h in zip(shares, highs, strict=True)],
        ]
        colour = f"C{conditions.index(one) % 10}"
        style = {"fmt": "D", "mfc": "white", "alpha": 0.75} if published else {"fmt": "o"}
        label = f"paper ({one.method})" if published else short_names(one.label)
        axes.errorbar(shares, rows, xerr=errors, color=colour, capsize=2, ms=5, lw=1, label=label, **style)
    axes.set_yticks(range(len(summary.tasks)), [_tick(task) for task in summary.tasks])
    axes.set_ylim(len(summary.tasks) - 0.5, -0.5)
    axes.set_xlim(-3, 103)
    axes.set_xlabel("success [%], 95 % Wilson interval; no bar where the paper does not state n")
    axes.legend(fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
    return _svg(figure)


def ends_plot(conditions: Sequence[Condition], ends: Mapping[Condition, Counter[str]]) -> str:
    """How the trials of each condition ended, as bars of shares; "" where none has."""
    ended = [one for one in conditions if sum(ends[one].values())]
    if not ended:
        return ""
    figure, axes = _figure(8.6, 1.0 + 0.42 * len(ended))
    names = [short_names(one.method if len({c.model for c in ended}) == 1 else one.label) for one in ended]
    lefts = [0.0] * len(ended)
    for number, end in enumerate(ends_seen(list(ends.values()))):
        shares = [100 * ends[one][end] / sum(ends[one].values()) for one in ended]
        colour = _END_COLOURS.get(end, f"C{number % 10}")
        axes.barh(range(len(ended)), shares, left=lefts, color=colour, label=end, height=0.7)
        for place, (left, share) in enumerate(zip(lefts, shares, strict=True)):
            if share >= LEAST_LABELLED:
                axes.text(left + share / 2, place, f"{ends[ended[place]][end]}", ha="center", va="center", fontsize=8)
        lefts = [left + share for left, share in zip(lefts, shares, strict=True)]
    axes.set_yticks(range(len(ended)), [f"{n} ({sum(ends[o].values())})" for n, o in zip(names, ended, strict=True)])
    axes.set_ylim(len(ended) - 0.5, -0.5)
    axes.set_xlim(0, 100)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("trials that ended so [%]; numbers are trials")
    axes.legend(fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=6, frameon=False)
    return _svg(figure)


def _tick(task: str) -> str:
    """A task as a label of an axis: of a long one, such as a file's path, the end alone, so that room is left for figures."""
    name = short_names(task.removeprefix("tabletop/"))
    return name if len(name) <= LONGEST_TICK else f"...{name[3 - LONGEST_TICK :]}"


def _task_rate(summary: Summary, one: Condition, task: str, published: bool) -> tuple[float, float, float] | None:
    """Share and interval in percent; None without a figure."""
    if published:
        figure = paper_beside(task, one)
        if figure is None:
            return None
        low, high = figure.interval or (figure.percent / 100, figure.percent / 100)
        return figure.percent, min(100 * low, figure.percent), max(100 * high, figure.percent)
    rate = summary.cell(one, task).rate
    if not rate.n:
        return None
    low, high = wilson_interval(rate.successes, rate.n)
    share = rate.successes / rate.n
    return 100 * share, 100 * min(low, share), 100 * max(high, share)


def _names(conditions: Sequence[Condition], summary: Summary) -> tuple[dict[Condition, str], str]:
    """Labels that leave room for figures, and the model of all that was compared, if it is one: the axis names it."""
    models = {one.model for one in summary.main}
    shared = next(iter(models)) if len(models) == 1 else ""
    names = {}
    for one in conditions:
        words = [word for word in one.label.split(" · ") if not (one in summary.main and word == shared)]
        names[one] = short_names(" · ".join(PRIVILEGED if word.startswith(PRIVILEGED) else word for word in words))
    return names, f" with {shared}" if shared not in ("", NO_MODEL) else ""


def _wider(names: Iterable[str]) -> float:
    """What long labels take [in], on top of a figure's own width."""
    return INCH_A_LETTER * max(0, max(map(len, names), default=0) - LONGEST_TICK)


def _colour(one: Condition, summary: Summary) -> str:
    return _GREY if one in summary.bounds else _BLUE


def _figure(width_in: float, height_in: float) -> tuple[Any, Any]:
    try:
        with warnings.catch_warnings():
            # What matplotlib's own dependencies deprecate is not ours to fix.
            warnings.simplefilter("ignore")
            from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise MissingExtraError("plots in the report", "report") from error
    figure = Figure(figsize=(width_in, height_in), layout="constrained")
    axes = figure.add_subplot()
    axes.grid(visible=True, color="#e4e7eb")
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure, axes


def _svg(figure: Any) -> str:
    out = io.StringIO()
    # No clock in what is written: the same store gives the same page.
    figure.savefig(out, format="svg", metadata={"Date": None})
    text = out.getvalue()
    return text[text.index("<svg") :]
