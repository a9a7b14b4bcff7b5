"""The paper's tables with what a study measured: head and lines of words."""

from __future__ import annotations

from statistics import fmean

from wonderful_team.core.intervals import wilson_interval
from wonderful_team.evals.paper_tables import Measure, PaperCell, PaperTable
from wonderful_team.evals.summary import Cell, Summary


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
    groups = [[_cells(summary, one) for one in group] for group in cell.ours_over]
    rates = [[held.rate.share for cells in group for held in cells] for group in groups]
    if not groups or any(share is None for group in rates for share in group) or not all(rates):
        return "-" if not groups else "not run yet"
    n = min(held.rate.n for group in groups for cells in group for held in cells)
    mean = fmean(fmean(share for share in group if share is not None) for group in rates)
    return f"{100 * mean:.2f} % (n = {n} a task)"


def _cells(summary: Summary, one: Measure) -> list[Cell]:
    """What a study has for a measure, one for each model."""
    return [
        summary.cell(condition, one.task or None)
        for condition in summary.compared
        if condition.method == one.method and one.replans in (None, condition.replans)
    ]


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
    said = []
    cells = _cells(summary, one)
    for cell in cells:
        successes, n = _counted(cell, one)
        if not n:
            continue
        low, high = wilson_interval(successes, n)
        told = f"{round(100 * successes / n, 1):g} % (n = {n}; {100 * low:.0f} to {100 * high:.0f})"
        badges = f" [{', '.join(cell.badges)}]" if cell.badges else ""
        said.append((f"{cell.condition.model}: " if len(cells) > 1 else "") + told + badges)
    return "; ".join(said) or "not run yet"
