"""The paper's tables as Markdown, one page, CSV and LaTeX: ours beside the paper's."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from wonderful_team.core.filesystem import make_private_folder, write_redacted
from wonderful_team.core.text import visible
from wonderful_team.evals.names import short_names
from wonderful_team.evals.paper import published
from wonderful_team.evals.paper_filled import filled
from wonderful_team.evals.paper_tables import PaperTable
from wonderful_team.evals.report.content import link
from wonderful_team.evals.report.latex import tex, to_latex
from wonderful_team.evals.report.tables import markdown_table
from wonderful_team.evals.summary import Summary

_HERE = Path(__file__).parent


@dataclass(frozen=True)
class Part:
    """A table of the paper and the study that was run for it, if one was; else why not, where it could not be run."""

    name: str
    table: PaperTable
    summary: Summary | None
    report: Path | None = None
    not_run: str = ""


@dataclass(frozen=True)
class PaperWritten:
    """What was written, and the tables as text."""

    text: str
    page: Path
    csv: tuple[Path, ...]
    latex: tuple[Path, ...]


def write_paper(parts: Sequence[Part], page: Path, *, command: str = "") -> PaperWritten:
    """One page of all parts; a CSV and a LaTeX file for each beside it."""
    make_private_folder(page.parent)
    texts, shown, tables, latex = [], [], [], []
    for part in parts:
        head, lines = filled(part.table, part.summary)
        warnings = [] if part.summary is None else part.summary.warnings()
        notes = [f"Cannot be run yet: it needs {part.table.lacks}."] if part.table.lacks else []
        notes += [f"Not run: {part.not_run}"] if part.not_run else []
        notes += [part.table.note] if part.table.note else []
        title = f"{part.table.title} ({part.table.where})"
        texts.append("\n".join([f"## {part.name}: {title}", "", markdown_table(head, lines), "", *notes, *warnings]))
        table = page.with_name(f"{part.name}-table.csv")
        write_redacted(table, _csv(head, lines))
        file = page.with_name(f"{part.name}-table.tex")
        caption = f"{title}. Paper: {published()['source']}."
        write_redacted(file, to_latex(head, [[tex(word) for word in line] for line in lines], caption, "l"))
        tables.append(table)
        latex.append(file)
        shown.append(
            {
                "name": part.name, "title": title, "head": head, "lines": lines, "notes": notes, "warnings": warnings,
                "report": "" if part.report is None else link(str(part.report), page),
                "files": {"CSV": link(str(table), page), "LaTeX": link(str(file), page)},
            }
        )  # fmt: skip
    text = visible("\n\n".join(texts), layout=True)
    write_redacted(page.with_suffix(".md"), text + "\n")
    environment = Environment(
        loader=FileSystemLoader(_HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {"short": short_names, "commands": as_commands}
    style = Markup((_HERE / "report.css").read_text(encoding="utf-8"))
    html = environment.get_template("paper.html.j2").render(
        style=style, parts=shown, command=command, source=published()["source"], conditions=published()["conditions"]
    )
    write_redacted(page, visible(html, layout=True), errors="xmlcharrefreplace")
    return PaperWritten(text, page, tuple(tables), tuple(latex))


def as_commands(text: str) -> Markup:
    """A note with what stands between backticks, as in Markdown, in the type of commands."""
    parts = [escape(part) for part in text.split("`")]
    return Markup("".join(f"<code>{part}</code>" if k % 2 else part for k, part in enumerate(parts)))  # noqa: S704  every part is escaped


def _csv(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    out = io.StringIO()
    csv.writer(out).writerows([head, *lines])
    return out.getvalue()
