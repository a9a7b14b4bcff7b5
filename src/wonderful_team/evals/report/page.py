"""From stores to the page, in the order that readers need: the answer first, how to reproduce it last."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from wonderful_team.errors import ConfigError, MissingExtraError
from wonderful_team.evals.pairing import Pair
from wonderful_team.evals.paper import published
from wonderful_team.evals.report import tables
from wonderful_team.evals.report.plots import cost_plot, rate_plot
from wonderful_team.evals.store import Store
from wonderful_team.evals.summary import Summary, merge, summarise
from wonderful_team.evals.trials import Condition, Row

EXAMPLES = 3
GALLERY = 24
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


def write_report(
    stores: Sequence[str | Path],
    path: str | Path,
    *,
    baseline: str | None = None,
    csv: str | Path | None = None,
    latex: str | Path | None = None,
    command: str = "",
) -> Path:
    """Write the page of one or several stores; returns its path. `write_all` says what else was written."""
    return write_all(stores, path, baseline=baseline, csv=csv, latex=latex, command=command).page


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
    page.parent.mkdir(parents=True, exist_ok=True)
    table = Path(csv) if csv is not None else page.with_suffix(".csv")
    table.write_text(tables.to_csv(rows), encoding="utf-8")
    markdown = page.with_suffix(".md")
    markdown.write_text(tables.to_markdown(summary, baseline), encoding="utf-8")
    tex = _write_latex(summary, Path(latex)) if latex is not None else ()
    warnings = (*conflicts, *summary.warnings())
    files = {"CSV": table, "Markdown": markdown, **{f"LaTeX {file.stem}": file for file in tex}}
    content = _content(summary, warnings, baseline, page, files)
    content["stores"] = [(str(one), _hash(Path(one))) for one in stores]
    content["command"] = command
    page.write_text(_render(content), encoding="utf-8")
    return Written(page, table, markdown, tex, summary, warnings)


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


def _content(
    summary: Summary, warnings: Sequence[str], baseline: str | None, page: Path, files: Mapping[str, Path]
) -> dict[str, Any]:
    conditions = (*summary.compared, *summary.bounds)
    pairs = summary.pairs(baseline)
    head, lines = tables.task_table(summary)
    return {
        "summary": summary,
        "answer": summary.headline(baseline),
        "warnings": warnings,
        "head": tables.HEAD,
        "compared": [tables.cell_words(summary.cell(one)) for one in summary.compared],
        "bounds": [tables.cell_words(summary.cell(one)) for one in summary.bounds],
        "plots": _plots(summary),
        "task_head": head,
        "task_lines": lines,
        "paper": published(),
        "pairs": [_pair(one, summary, page) for one in pairs],
        "failures": [_failures(one, summary, page) for one in summary.compared],
        "isolated": [
            (one.label, one.isolate, tables.cell_words(summary.cell(one))) for one in conditions if one.isolate
        ],
        "perturbed": [
            (one.label, one.perturb, tables.cell_words(summary.cell(one))) for one in conditions if one.perturb
        ],
        "facts": _facts(summary),
        "gallery": _gallery(summary, page),
        "files": {name: _link(str(file), page) for name, file in files.items()},
        "versions": sorted({f"{k} {v}" for row in summary.rows if row.result for k, v in row.result.versions.items()}),
    }


def _plots(summary: Summary) -> dict[str, Any]:
    if not any(summary.cell(one).rate.n for one in (*summary.compared, *summary.bounds)):
        return {"missing": "no scored trial: nothing to plot"}
    try:
        # Made by matplotlib from our own figures: labels are escaped by it.
        return {"rates": Markup(rate_plot(summary)), "costs": Markup(cost_plot(summary))}
    except MissingExtraError as error:
        return {"missing": str(error)}


def _pair(one: Pair, summary: Summary, page: Path) -> dict[str, Any]:
    pages = {
        (row.spec.condition, row.spec.task, row.spec.seed, row.spec.repeat): _link(row.result.page, page)
        for row in summary.rows
        if row.result is not None and row.result.page
    }
    listed = [
        {
            "scene": f"{task}#{seed}" + (f" repeat {repeat}" if repeat else ""),
            "won": (one.first if won == "first" else one.second).label,
            "pages": [
                (side.label, pages[side, task, seed, repeat])
                for side in (one.first, one.second)
                if (side, task, seed, repeat) in pages
            ],
        }
        for (task, seed, repeat), won in one.discordant
    ]
    return {"pair": one, "discordant": listed}


def _failures(one: Condition, summary: Summary, page: Path) -> dict[str, Any]:
    stages = []
    for stage, count in summary.stages(one).most_common():
        examples = [
            {"scene": row.spec.scene, "reason": row.result.reason, "page": _link(row.result.page, page)}
            for row in summary.rows
            if row.spec.condition == one
            and row.result is not None
            and row.result.outcome == "failure"
            and (row.result.stage or "unknown") == stage
        ]
        stages.append({"stage": stage, "count": count, "examples": examples[:EXAMPLES]})
    errors = [
        {"scene": row.spec.scene, "reason": row.result.reason, "page": _link(row.result.page, page)}
        for row in summary.rows
        if row.spec.condition == one and row.result is not None and row.result.outcome == "error"
    ]
    return {"label": one.label, "stages": stages, "errors": errors[:EXAMPLES], "error_count": len(errors)}


def _facts(summary: Summary) -> list[tuple[str, list[tuple[str, str]]]]:
    """Means of what trials measured beside their outcome, such as the overlap of boxes on photos."""
    found = []
    for one in summary.compared:
        cell = summary.cell(one)
        names = dict.fromkeys(name for result in cell.results for name in result.facts)
        if names:
            found.append((one.label, [(name, tables.number(cell.fact(name), 3)) for name in names]))
    return found


def _gallery(summary: Summary, page: Path) -> list[dict[str, str]]:
    shown = [row for row in summary.rows if row.result is not None and row.result.page]
    return [
        {
            "page": _link(row.result.page, page),
            "picture": _link(_picture_of(Path(row.result.page).parent), page),
            "scene": row.spec.scene,
            "label": row.spec.condition.label,
            "outcome": row.result.outcome,
            "stage": row.result.stage or "",
        }
        for row in shown[:GALLERY]
        if row.result is not None
    ]


def _picture_of(run: Path) -> str:
    """The plan over the picture, or the last view that was recorded; "" without any."""
    views = [run / "final.png", *sorted((run / "pictures").glob("view_*.png"), reverse=True)]
    return next((str(path) for path in views if path.is_file()), "")


def _link(target: str, page: Path) -> str:
    """A link from the page's folder; "" for nothing."""
    if not target:
        return ""
    return Path(os.path.relpath(Path(target).absolute(), page.parent.absolute())).as_posix()


def _write_latex(summary: Summary, folder: Path) -> tuple[Path, ...]:
    folder.mkdir(parents=True, exist_ok=True)
    head, lines = tables.task_table(summary)
    conditions = [tables.cell_words(summary.cell(one)) for one in (*summary.compared, *summary.bounds)]
    made = {
        "conditions": tables.to_latex(tables.HEAD, conditions, "Success per method and model, 95 % Wilson intervals."),
        "tasks": tables.to_latex(head, lines, f"Success per task. Paper: {published()['source']}."),
    }
    for name, text in made.items():
        (folder / f"{name}.tex").write_text(text, encoding="utf-8")
    return tuple(folder / f"{name}.tex" for name in made)


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def _render(content: Mapping[str, Any]) -> str:
    environment = Environment(
        loader=FileSystemLoader(_HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    style = Markup((_HERE / "report.css").read_text(encoding="utf-8"))
    return environment.get_template("report.html.j2").render(style=style, **content)
