"""A study's figures as CSV, Markdown, LaTeX, JSON and a pandas frame."""

from __future__ import annotations

import csv
import importlib
import io
import json
from collections.abc import Sequence
from typing import Any

from wonderful_team.core.text import visible
from wonderful_team.errors import MissingExtraError
from wonderful_team.evals.ablation import ablations
from wonderful_team.evals.pairing import Pair
from wonderful_team.evals.paper import paper_beside
from wonderful_team.evals.report import ablation, judgements
from wonderful_team.evals.report.paired import paired_figures
from wonderful_team.evals.schema import CONDITION
from wonderful_team.evals.summary import Cell, Summary
from wonderful_team.evals.trials import JUDGED, JUDGED_SUBGOAL, Condition, Row

_JUDGED = frozenset((*JUDGED.values(), *JUDGED_SUBGOAL.values()))
_RESULT = (
    "outcome",
    "stage",
    "reason",
    "calls",
    "tokens",
    "pictures",
    "usd",
    "seconds",
    "rounds",
    "page",
    "instruction",
)


def trial_record(row: Row) -> dict[str, Any]:
    """One trial flat, for a line of a table; None for everything that is not known yet."""
    spec, result = row.spec, row.result
    flat: dict[str, Any] = {
        "task": spec.task,
        "seed": spec.seed,
        "repeat": spec.repeat,
        **_condition_values(spec.condition),
    }
    flat |= {name: None if result is None else getattr(result, name) for name in _RESULT}
    flat["provenance"] = None if result is None else " ".join(result.provenance)
    flat["versions"] = None if result is None else json.dumps(dict(result.versions))
    return flat | ({} if result is None else {f"fact {name}": value for name, value in result.facts.items()})


def _condition_values(condition: Condition) -> dict[str, Any]:
    """A condition as the columns of a store."""
    return dict(zip(CONDITION, condition.values, strict=True))


def to_csv(rows: Sequence[Row]) -> str:
    """One line per trial."""
    records = [trial_record(row) for row in rows]
    columns = list(dict.fromkeys(name for record in records for name in record))
    out = io.StringIO()
    writer = csv.DictWriter(out, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows({k: visible(v) if isinstance(v, str) else v for k, v in record.items()} for record in records)
    return out.getvalue()


def to_frame(rows: Sequence[Row]) -> Any:
    """One line per trial as a pandas frame.

    Raises:
        MissingExtraError: pandas is not installed.
    """
    try:
        pandas = importlib.import_module("pandas")
    except ModuleNotFoundError as error:
        raise MissingExtraError("a pandas frame", "report") from error
    return pandas.DataFrame([trial_record(row) for row in rows])


def condition_json(cell: Cell) -> dict[str, Any]:
    """A cell for machines."""
    rate = cell.rate
    return {
        **_condition_values(cell.condition),
        "successes": rate.successes,
        "scored": rate.n,
        "success": rate.share,
        "interval": rate.interval and list(rate.interval),
        "errors": cell.count("error"),
        "unscored": cell.count("unscored"),
        "missing": cell.missing,
        "retried": cell.retried,
        "seeds": cell.seed_range,
        "usd": cell.usd,
        "usd_per_trial": cell.usd_per_trial,
        "usd_per_success": cell.usd_per_success,
        **{f"mean_{name}": cell.mean(name) for name in ("seconds", "calls", "rounds", "tokens")},
        "provenance": list(cell.badges),
    }


JUDGEMENTS = "What methods said became of their actions, against the simulator's truth at that moment"
HEAD = (
    "method · model",
    "success",
    "95 %",
    "n",
    "errors",
    "unscored",
    "seeds",
    "USD/trial",
    "USD/success",
    "s",
    "calls",
    "rounds",
)


def cell_words(cell: Cell) -> tuple[str, ...]:
    """The line of a cell, in the order of HEAD."""
    rate = cell.rate
    badges = f" [{', '.join(cell.badges)}]" if cell.badges else ""
    interval = "no data"
    if rate.interval is not None:
        low, high = rate.interval
        interval = f"{100 * low:.1f} to {100 * high:.1f}"
    return (
        cell.condition.label + badges,
        "no data" if rate.share is None else f"{100 * rate.share:.1f} %",
        interval,
        str(rate.n),
        str(cell.count("error")),
        str(cell.count("unscored")),
        cell.seed_range,
        number(cell.usd_per_trial, 4),
        "no success" if cell.results and not cell.count("success") else number(cell.usd_per_success, 4),
        *(number(cell.mean(name), 1) for name in ("seconds", "calls", "rounds")),
    )


PAIR_HEAD = ("first", "second", "first less second", "95 %", "exact p", "pairs", "only first", "only second")


def pair_words(one: Pair) -> tuple[str, ...]:
    """The line of a comparison, in the order of PAIR_HEAD."""
    return (one.first.label, one.second.label, *paired_figures(one))


FEW_PAIRS = 3
"""So many comparisons are written out task by task in text."""
PAIR_TASK_HEAD = ("first", "second", "task", *PAIR_HEAD[2:])


def pair_tasks(summary: Summary, one: Pair) -> list[tuple[str, ...]]:
    """A comparison task by task, in the order of PAIR_TASK_HEAD; none where there is one task."""
    if len(summary.tasks) < 2:
        return []
    by_task = ((task, summary.compare(one.first, one.second, task)) for task in summary.tasks)
    return [(one.first.label, one.second.label, task, *paired_figures(found)) for task, found in by_task if found.n]


VARIANT_HEAD = ("", "success", "95 %", "n", "errors", "less the whole", "95 %", "exact p", "pairs")


def variant_words(cell: Cell, against: Pair | None) -> tuple[str, ...]:
    """The line of an isolated part or a harder tier, in the order of VARIANT_HEAD; `against` pairs it with the whole."""
    condition = cell.condition
    parts = [f"{condition.isolate} alone"] if condition.isolate else []
    parts += [condition.perturb] if condition.perturb else []
    _, share, interval, n, errors, *_ = cell_words(cell)
    paired = ("", "", "", "") if against is None else pair_words(against)[2:6]
    return (" · ".join(parts) or "whole, as it is", share, interval, n, errors, *paired)


def in_order(summary: Summary) -> tuple[Condition, ...]:
    """All conditions: those compared as they are, then the parts and tiers, then the controls."""
    rest = tuple(one for one in summary.compared if one not in summary.main)
    return (*summary.main, *rest, *summary.bounds)


def number(value: float | None, digits: int) -> str:
    """A figure, or that it is not known."""
    return "unknown" if value is None else f"{value:.{digits}f}"


def task_table(summary: Summary) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Success per task and condition, each compared method's column of the paper beside it."""
    head: list[str] = ["task"]
    conditions = (*summary.main, *summary.main_bounds)
    with_paper = {one for one in summary.main if any(paper_beside(task, one) for task in summary.tasks)}
    for one in conditions:
        head += [one.label] + ([f"paper ({one.method})"] if one in with_paper else [])
    lines = []
    for task in summary.tasks:
        line = [task]
        for one in conditions:
            line.append(rate_words(summary.cell(one, task)))
            if one in with_paper:
                line.append(str(paper_beside(task, one) or "-"))
        lines.append(tuple(line))
    return tuple(head), lines


def rate_words(cell: Cell) -> str:
    """A rate with n and interval in one field."""
    rate = cell.rate
    if rate.interval is None:
        return "no data"
    low, high = rate.interval
    return f"{100 * rate.successes / rate.n:.0f} % (n = {rate.n}; {100 * low:.0f} to {100 * high:.0f})"


def fact_tables(summary: Summary) -> list[tuple[tuple[str, ...], list[tuple[str, ...]]]]:
    """What trials measured beside their outcome, as means: a table for each set of figures, a line for each task of a condition."""
    found: dict[tuple[str, ...], list[tuple[str, ...]]] = {}
    for task in summary.tasks:
        for one in summary.compared:
            cell = summary.cell(one, task)
            names = tuple(
                dict.fromkeys(name for result in cell.results for name in result.facts if name not in _JUDGED)
            )
            if names:
                line = (one.label, task, str(len(cell.results)), *(number(cell.fact(name), 3) for name in names))
                found.setdefault(names, []).append(line)
    return [(("method · model", "task", "n", *names), lines) for names, lines in found.items()]


def to_markdown(summary: Summary, baseline: str | None = None) -> str:
    """Answer, warnings and all tables."""
    parts = ["\n".join(summary.headline(baseline))]
    warnings = summary.warnings()
    if warnings:
        parts.append("\n".join(f"- warning: {text}" for text in warnings))
    parts.append(markdown_table(HEAD, [cell_words(summary.cell(one)) for one in in_order(summary)]))
    parts.append(markdown_table(*task_table(summary)))
    pairs = [pair_words(one) for one in summary.pairs(baseline)]
    if pairs:
        parts.append(markdown_table(PAIR_HEAD, pairs))
    by_task = [line for one in summary.pairs(baseline)[:FEW_PAIRS] for line in pair_tasks(summary, one)]
    if by_task and len(pairs) <= FEW_PAIRS:
        parts.append(markdown_table(PAIR_TASK_HEAD, by_task))
    for found in ablations(summary):
        parts.append(f"What each member is worth: {found.base.label}")
        parts.append(markdown_table(ablation.EFFECT_HEAD, ablation.effect_lines(found)))
        parts.append(markdown_table(*ablation.end_lines(found)))
        parts.append(markdown_table(ablation.MOVED_HEAD, ablation.moved_lines(found)))
    for whole, members in summary.variants():
        lines = [variant_words(summary.cell(one), against) for one, against in members]
        parts.append(markdown_table((whole.label, *VARIANT_HEAD[1:]), lines))
    parts += [markdown_table(head, lines) for head, lines in fact_tables(summary)]
    judged = judgements.lines(summary)
    if judged:
        parts += [JUDGEMENTS, markdown_table(judgements.HEAD, judged)]
    return visible("\n\n".join(parts) + "\n", layout=True)


def markdown_table(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    rows = [head, ["---"] * len(head), *lines]
    return "\n".join("| " + " | ".join(word.replace("|", "\\|") for word in row) + " |" for row in rows)
