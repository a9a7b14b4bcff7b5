"""Further methods in a table of the paper: a column where methods stand side by side, a line where each has its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wonderful_team.evals.names import short_names
from wonderful_team.evals.paper_tables import Measure, PaperCell, PaperTable


def with_methods(table: PaperTable, methods: Sequence[str]) -> PaperTable:
    """The table with these methods too, measured as its own are; those that it has already stand where they are."""
    new = [name for name in dict.fromkeys(methods) if name not in table.methods]
    if not new or not table.suites:
        return table
    lines = table.lines()
    for name in new:
        lines = (
            _with_lines(lines, name) if _by_line(table) else [(label, _beside(cells, name)) for label, cells in lines]
        )
    return replace(table, methods=(*table.methods, *new), lines=lambda: lines)


def _measures(cell: PaperCell) -> list[Measure]:
    return [*([cell.ours] if cell.ours else []), *(one for group in cell.ours_over for one in group)]


def _by_line(table: PaperTable) -> bool:
    """Whether each line is about one method."""
    every = [{one.method for cell in cells for one in _measures(cell)} for _, cells in table.lines()]
    return len({name for names in every for name in names}) > 1 and all(len(names) <= 1 for names in every)


def _with_lines(lines: Sequence[tuple[str, list[PaperCell]]], method: str) -> list[tuple[str, list[PaperCell]]]:
    """A line more, measured as the first one of which something runs."""
    like = next(cells for _, cells in lines if any(_measures(cell) for cell in cells))
    cells = [
        PaperCell(
            cell.column,
            None,
            None if cell.ours is None else replace(cell.ours, method=method),
            tuple(tuple(replace(one, method=method) for one in group) for group in cell.ours_over),
        )
        for cell in like
    ]
    return [*lines, (short_names(method), cells)]


def _beside(cells: Sequence[PaperCell], method: str) -> list[PaperCell]:
    """The cells of a line and those of one method more: one for each thing that the line measures."""
    measured = {
        replace(cell.ours, method=method): cell.column.partition(" | ")[2]
        for cell in reversed(cells)
        if cell.ours is not None
    }
    several = len(measured) > 1
    more = [
        PaperCell(f"{short_names(method)} | {words}" if several else short_names(method), None, one)
        for one, words in reversed(measured.items())
    ]
    return [*cells, *more]
