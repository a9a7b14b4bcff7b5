"""The paper's tables with what a study measured: head and lines of words."""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team.core.intervals import mean_interval, wilson_interval
from wonderful_team.core.text import counted
from wonderful_team.evals.paper_tables import Measure, PaperCell, PaperTable
from wonderful_team.evals.summary import Cell, Summary
from wonderful_team.evals.trials import Condition


def filled(table: PaperTable, summary: Summary | None) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Head and lines: for every column ours, where something runs for it, and the paper's, where it reports something."""
    lines = table.lines()
    first = lines[0][1]
    ours = {cell.column for _, cells in lines for cell in cells if cell.ours or cell.ours_over}
    theirs = {cell.column for _, cells in lines for cell in cells if cell.paper}
    head = ["" if not table.suites else "task or line"]
    for cell in first:
        head += [f"ours: {cell.column}"] if cell.column in ours else []
        head += [f"paper: {cell.column}"] if cell.column in theirs else []
    body = []
    for label, cells in lines:
        line = [label]
        for cell in cells:
            line += [_ours(cell, summary)] if cell.column in ours else []
            line += ["-" if cell.paper is None else str(cell.paper)] if cell.column in theirs else []
        body.append(tuple(line))
    return tuple(head), body


def _ours(cell: PaperCell, summary: Summary | None) -> str:
    if summary is None:
        return "not run"
    if cell.ours is not None:
        return _measured(summary, cell.ours)
    return _mean_of(summary, cell.ours_over) if cell.ours_over else "-"


def _mean_of(summary: Summary, groups: Sequence[Sequence[Measure]]) -> str:
    """The mean of the means of groups of rates, one for each condition that has run them all."""
    found: dict[Condition, dict[Measure, Cell]] = {}
    for group in groups:
        for one in group:
            for cell in _cells(summary, one):
                found.setdefault(cell.condition, {})[one] = cell
    told = []
    for condition, cells in found.items():
        whole = [[cells[one] for one in group if one in cells and cells[one].rate.n] for group in groups]
        if [len(group) for group in whole] != [len(group) for group in groups]:
            continue
        weights = [1 / len(groups) / len(group) for group in whole for _ in group]
        rates = [cell.rate for group in whole for cell in group]
        mean, low, high = mean_interval(rates, weights)
        n = f"n = {min(rate.n for rate in rates)} a task; {100 * low:.0f} to {100 * high:.0f}"
        told.append((condition, f"{100 * mean:.2f} % ({n}){_badges([cell for group in whole for cell in group])}"))
    return _beside(told) or "not run yet"


def _cells(summary: Summary, one: Measure) -> list[Cell]:
    """What a study has for a measure, one for each model, and for each way of asking it."""
    cells = (
        summary.cell(condition, one.task or None)
        for condition in summary.compared
        if condition.method == one.method and one.replans in (None, condition.replans)
    )
    return [cell for cell in cells if cell.results]


def _counted(cell: Cell, one: Measure) -> tuple[int, int]:
    """How many of how many."""
    if one.failed:
        failures = [result for result in cell.results if result.outcome == "failure"]
        return sum((result.stage == "crash") == (one.failed == "crash") for result in failures), cell.rate.n
    if one.fact:
        n = len([result for result in cell.results if one.fact in result.facts])
        return round((cell.fact(one.fact) or 0.0) * n), n
    return cell.count("success"), cell.rate.n


def _measured(summary: Summary, one: Measure) -> str:
    told = []
    for cell in _cells(summary, one):
        successes, n = _counted(cell, one)
        if not n:
            told.append((cell.condition, f"no data ({counted(cell.count('error'), 'error')})"))
            continue
        low, high = wilson_interval(successes, n)
        said = f"{round(100 * successes / n, 1):g} % (n = {n}; {100 * low:.0f} to {100 * high:.0f})"
        told.append((cell.condition, f"{said}{_badges([cell])}"))
    return _beside(told) or "not run yet"


def _badges(cells: Sequence[Cell]) -> str:
    """Where the answers came from, as a reader has to know it."""
    names = dict.fromkeys(name for cell in cells for name in cell.badges)
    return f" [{', '.join(names)}]" if names else ""


def _beside(told: Sequence[tuple[Condition, str]]) -> str:
    """Figures of one method, each by its model and what is special about it where there are several."""
    if len(told) == 1:
        return told[0][1]
    return "; ".join(f"{one.label.removeprefix(f'{one.method} · ')}: {said}" for one, said in told)
