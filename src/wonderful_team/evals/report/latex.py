"""A study's tables for a paper: booktabs, narrow enough for a column of text."""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team.core.intervals import Rate
from wonderful_team.evals.names import short_names
from wonderful_team.evals.paper import PaperFigure, paper_beside, published
from wonderful_team.evals.report.tables import PAIR_HEAD, in_order, number, pair_words
from wonderful_team.evals.summary import Summary

CONDITIONS_HEAD = ("method · model", "success [%]", "95 %", "n", "errors", "unscored", "USD/trial", "calls", "rounds")


def latex_tables(summary: Summary, baseline: str | None = None) -> dict[str, str]:
    """Tables of conditions, of tasks, and of pairs where two things were compared, by name."""
    tables = {"conditions": _conditions(summary), "tasks": _tasks(summary)}
    pairs = [pair_words(one) for one in summary.pairs(baseline)]
    if pairs:
        caption = "Differences in points on the same scenes: Newcombe's paired interval, exact McNemar test."
        tables["pairs"] = to_latex(PAIR_HEAD, [[tex(word) for word in line] for line in pairs], caption, "ll")
    return tables


def _conditions(summary: Summary) -> str:
    lines = []
    for one in in_order(summary):
        cell = summary.cell(one)
        share, bounds = "no data", ""
        if cell.rate.interval is not None:
            low, high = cell.rate.interval
            share, bounds = f"{100 * cell.rate.successes / cell.rate.n:.1f}", f"{100 * low:.1f}--{100 * high:.1f}"
        counts = [str(cell.rate.n), str(cell.count("error")), str(cell.count("unscored"))]
        means = [number(cell.usd_per_trial, 3), number(cell.mean("calls"), 1), number(cell.mean("rounds"), 1)]
        lines.append([tex(one.label), share, bounds, *counts, *means])
    return to_latex(CONDITIONS_HEAD, lines, "Success per method and model with 95 % Wilson intervals.", "l")


def _tasks(summary: Summary) -> str:
    """What was compared, with the paper's figures beside it; the controls stand in the table of conditions."""
    head, columns = ["task"], []
    for one in summary.main:
        head.append(one.label)
        columns.append([_rate(summary.cell(one, task).rate) for task in summary.tasks])
        figures = [paper_beside(task, one) for task in summary.tasks]
        if any(figures):
            head.append(f"paper ({one.method})")
            columns.append([_figure(figure) for figure in figures])
    world = {task.partition("/")[0] for task in summary.tasks}
    names = [task.partition("/")[2] if len(world) == 1 and "/" in task else task for task in summary.tasks]
    lines = [[tex(name), *cells] for name, *cells in zip(names, *columns, strict=True)]
    caption = f"Success per task [%]; in brackets the 95 % Wilson interval and n. Paper: {published()['source']}."
    return to_latex(head, lines, caption, "l")


def _rate(rate: Rate) -> str:
    return _with_bounds(100 * rate.successes / rate.n, rate.interval, rate.n) if rate.n else "--"


def _figure(figure: PaperFigure | None) -> str:
    if figure is None:
        return "--"
    return _with_bounds(figure.percent, figure.interval, figure.n)


def _with_bounds(percent: float, interval: tuple[float, float] | None, n: int | None) -> str:
    if interval is None:
        return f"{percent:g}"
    return rf"{percent:.0f} {{\tiny [{100 * interval[0]:.0f}--{100 * interval[1]:.0f}; {n}]}}"


def to_latex(head: Sequence[str], lines: Sequence[Sequence[str]], caption: str, left: str) -> str:
    """A table for booktabs.

    Args:
        head: Words of the first line.
        lines: The rest, as LaTeX.
        caption: Words.
        left: Columns that are set flush left, as "l" or "ll"; the others are flush right.
    """
    body = "\n".join(f"    {' & '.join(line)} \\\\" for line in lines)
    columns = left + "r" * (len(head) - len(left))
    return (
        "% needs \\usepackage{booktabs}\n"
        "\\begin{table}\n  \\centering\\scriptsize\\setlength{\\tabcolsep}{3pt}\n"
        f"  \\caption{{{tex(caption)}}}\n"
        f"  \\begin{{tabular}}{{{columns}}}\n    \\toprule\n"
        f"    {' & '.join(map(_stacked, head))} \\\\\n    \\midrule\n{body}\n    \\bottomrule\n"
        "  \\end{tabular}\n\\end{table}\n"
    )


def _stacked(label: str) -> str:
    """A label over several lines: its parts would widen the column."""
    parts = [tex(part) for part in label.split(" · ")]
    return parts[0] if len(parts) == 1 else r"\shortstack[r]{" + r"\\".join(parts) + "}"


_TEX = {
    "%": r"\%",
    "_": r"\_",
    "&": r"\&",
    "#": r"\#",
    "$": r"\$",
    "·": r"$\cdot$",
    "{": r"\{",
    "}": r"\}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"$<$",
    ">": r"$>$",
    "|": r"\textbar{}",
    "\\": r"\textbackslash{}",
}


def tex(word: str) -> str:
    """Words as LaTeX, FILE.py:NAME without its folders."""
    return "".join(_TEX.get(letter, letter) for letter in short_names(word))
