"""From stores to the page, in the order that readers need: the answer first, how to reproduce it last."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from wonderful_team.core.filesystem import make_private_folder, write_redacted
from wonderful_team.core.text import counted, visible
from wonderful_team.errors import ConfigError
from wonderful_team.evals.ablation import ablations
from wonderful_team.evals.names import short_names
from wonderful_team.evals.report import ablation, tables
from wonderful_team.evals.report.content import link, page_content
from wonderful_team.evals.report.latex import latex_tables
from wonderful_team.evals.store import Store
from wonderful_team.evals.summary import Summary, merge, summarise
from wonderful_team.evals.trials import Row

_HERE = Path(__file__).parent


@dataclass(frozen=True)
class Written:
    """What a report wrote, and the figures in it."""

    page: Path
    csv: Path
    markdown: Path
    latex: tuple[Path, ...]
    summary: Summary
    warnings: tuple[str, ...]


def write_all(
    stores: Sequence[str | Path],
    path: str | Path,
    *,
    baseline: str | None = None,
    csv: str | Path | None = None,
    latex: str | Path | None = None,
    command: str = "",
) -> Written:
    """Write the page, and CSV, Markdown and LaTeX beside it.

    Args:
        stores: Files of `bench`; several are merged.
        path: The HTML page.
        baseline: Compare every method with this one only.
        csv: Where the table of trials goes; default beside the page.
        latex: Folder of the LaTeX tables; default none is written.
        command: What the page says of how it was made.

    Raises:
        ConfigError: No such store, or the baseline is not in it.
    """
    page = Path(path)
    rows, requests, conflicts = read_stores(stores)
    summary = summarise(rows, requests)
    methods = {one.method for one in summary.compared}
    if baseline is not None and baseline not in methods:
        raise ConfigError(f"baseline {baseline!r}: the stores compare {', '.join(sorted(methods)) or 'nothing'}")
    make_private_folder(page.parent)
    table = Path(csv) if csv is not None else page.with_suffix(".csv")
    write_redacted(table, tables.to_csv(rows))
    markdown = page.with_suffix(".md")
    write_redacted(markdown, tables.to_markdown(summary, baseline))
    tex = _write_latex(summary, Path(latex), baseline) if latex is not None else ()
    warnings = (*conflicts, *summary.warnings())
    files = {"CSV": table, "Markdown": markdown, **{f"LaTeX {file.stem}": file for file in tex}}
    content = page_content(summary, warnings, baseline, page)
    files |= _write_ablations(summary, page)
    content["files"] = {name: link(str(file), page) for name, file in files.items()}
    content["stores"] = [(str(one), _hash(Path(one))) for one in stores]
    content["command"] = command
    write_redacted(page, visible(_render(content), layout=True), errors="xmlcharrefreplace")
    return Written(page, table, markdown, tex, summary, warnings)


def _write_ablations(summary: Summary, page: Path) -> dict[str, Path]:
    """CSV of what members add and of how trials ended, where members were left out."""
    found = ablations(summary)
    if not found:
        return {}
    texts = {"effects": ablation.effects_csv(found), "ends": ablation.ends_csv(summary, found)}
    files = {f"CSV {name}": page.with_name(f"{page.stem}-{name}.csv") for name in texts}
    for file, text in zip(files.values(), texts.values(), strict=True):
        write_redacted(file, text)
    return files


def read_stores(stores: Sequence[str | Path]) -> tuple[list[Row], list[dict[str, Any]], list[str]]:
    """Rows and requests of several stores, merged, with what does not fit together.

    Raises:
        ConfigError: No store is named, or one does not exist.
    """
    if not stores:
        raise ConfigError("name at least one store file")
    parts: list[list[Row]] = []
    requests: list[dict[str, Any]] = []
    for one in stores:
        with Store(one, must_exist=True) as store:
            parts.append(store.rows())
            requests += store.requests()
    rows, conflicts = merge(parts)
    return rows, requests, conflicts


def _write_latex(summary: Summary, folder: Path, baseline: str | None) -> tuple[Path, ...]:
    make_private_folder(folder)
    made = latex_tables(summary, baseline)
    for name, text in made.items():
        write_redacted(folder / f"{name}.tex", text)
    return tuple(folder / f"{name}.tex" for name in made)


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def _render(content: Mapping[str, Any]) -> str:
    environment = Environment(
        loader=FileSystemLoader(_HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["short"] = short_names
    environment.filters["counted"] = counted
    style = Markup((_HERE / "report.css").read_text(encoding="utf-8"))
    return environment.get_template("report.html.j2").render(style=style, **content)
