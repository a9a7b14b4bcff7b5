"""`paper`: the paper's tables by name, run for any model, with the paper's figures beside ours."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from wonderful_team.cli import bench
from wonderful_team.cli.options import PATH
from wonderful_team.cli.output import finish
from wonderful_team.core.deadline import limited
from wonderful_team.core.filesystem import make_private_folder

if TYPE_CHECKING:
    from wonderful_team.evals.paper_tables import PaperTable
    from wonderful_team.evals.summary import Summary

OWN = ("suites", "methods", "store", "open_page", "photo_set", "set_format")
"""Options of `bench` that a table decides by itself."""
SHARED = [option for option in bench.command.params if option.name not in OWN]


def _command(
    table: str | None, folder: Path, open_page: bool, only: tuple[str, ...], also: tuple[str, ...], **options: Any
) -> int:
    """List the paper's tables; or run what TABLE needs (what ended stays, and the same command resumes) and print ours beside the paper's."""
    from wonderful_team.errors import UnknownNameError
    from wonderful_team.evals.paper_tables import PAPER_TABLES
    from wonderful_team.evals.plan import split_names

    if table is None:
        return _list(options["as_json"])
    if table != "all" and table not in PAPER_TABLES:
        raise UnknownNameError("table of the paper", table, ["all", *PAPER_TABLES])
    names = [table] if table != "all" else [name for name, one in PAPER_TABLES.items() if one.suites]
    named = split_names(only)
    for method in named:
        known = dict.fromkeys(other for name in names for other in PAPER_TABLES[name].methods)
        if method not in known:
            raise UnknownNameError(f"method of {table}", method, known)
    with limited(options["max_seconds"]):
        return _run(names, folder, open_page, {**options, "only": named, "also": split_names(also)})


def _list(as_json: bool) -> int:
    from wonderful_team.evals.paper_tables import PAPER_TABLES

    width = max(map(len, PAPER_TABLES))
    lines = [
        f"{name:<{width}}  {one.title} ({one.where})"
        + (f"; cannot be run yet: it needs {one.lacks}" if one.lacks else f"; runs {', '.join(one.methods)}")
        for name, one in PAPER_TABLES.items()
    ]
    lines.append("run one:  wonderful-team paper toy --model simulated:paper-gpt-4o")
    told = {
        name: {"title": one.title, "where": one.where, "methods": list(one.methods), "lacks": one.lacks}
        for name, one in PAPER_TABLES.items()
    }
    return finish("paper", text="\n".join(lines), result={"tables": told}, as_json=as_json, code=0)


def _run(names: list[str], folder: Path, open_page: bool, options: dict[str, Any]) -> int:
    from wonderful_team.api.study import Study
    from wonderful_team.cli.run_summary import shown_path
    from wonderful_team.evals.paper_also import with_methods
    from wonderful_team.evals.paper_tables import PAPER_TABLES
    from wonderful_team.evals.report.paper_page import Part, write_paper

    words = shlex.join(["wonderful-team", *(click.get_current_context().obj or ())])
    parts, code, stopped = list[Part](), 0, ""
    study: Study | None = None
    # One store for all: a cap holds for all of them together, and trials that two tables need are run once.
    store = folder / "paper.db"
    make_private_folder(folder)
    for name in names:
        table = with_methods(PAPER_TABLES[name], options["also"])
        summary = None
        not_run = _missing(table, () if options["also"] else options["only"]) if len(names) > 1 else ""
        if not_run:
            click.echo(f"{name}: not run: {not_run}", err=True)
        elif table.suites and not stopped:
            study = Study.from_options(**bench.by_new_names(_options(table, options)), store=store, command=words)
            if options["estimate"]:
                code = bench.tell_estimate("paper", study, options)
                continue
            click.echo(f"{name}: {table.title}", err=True)
            ended, code = bench.run_study(study, options)
            summary, stopped = study.summary(), ended.why
        parts.append(Part(name, table, summary, not_run=not_run))
    if options["estimate"] and not parts:
        return code
    if study is not None:
        # Of all trials of the store, so once they have all been run.
        report = study.report(store.with_suffix(".html"))
        parts = [part if part.summary is None else replace(part, report=report) for part in parts]
    written = write_paper(parts, folder / f"{names[0] if len(names) == 1 else 'all'}-table.html", command=words)
    lines = [written.text, *([f"stopped: {stopped}"] if stopped else [])]
    if open_page:
        click.launch(written.page.resolve().as_uri())
    result = {
        "tables": {part.name: _told(part.table, part.summary) for part in parts},
        "stopped": stopped,
        "page": str(written.page),
        "csv": [str(path) for path in written.csv],
        "latex": [str(path) for path in written.latex],
    }
    last = f"page: {shown_path(written.page)}"
    return finish("paper", text="\n".join(lines), result=result, as_json=options["as_json"], code=code, last_line=last)


def _missing(table: PaperTable, only: Sequence[str]) -> str:
    """Why a table of several is left out: its worlds cannot be started here, or it has none of the methods asked for; "" else."""
    from wonderful_team import registry
    from wonderful_team.api.known_suites import known_suites
    from wonderful_team.errors import ConfigError

    if only and not set(only) & set(table.methods):
        return f"it has none of {', '.join(only)}"
    suites = known_suites()
    try:
        registry.check_ready(
            task for name in table.suites for task in (suites[name].tasks if name in suites else (name,))
        )
    except ConfigError as error:
        return str(error)
    return ""


def _options(table: PaperTable, options: dict[str, Any]) -> dict[str, Any]:
    """What `bench` would be asked."""
    from wonderful_team.evals.trials import DEVELOPMENT_BELOW

    seeds = options["seeds"]
    if seeds is None and table.runs is not None:
        seeds = f"{DEVELOPMENT_BELOW}:{DEVELOPMENT_BELOW + table.runs}"
    chosen = {*options["only"], *options["also"]}
    methods = [name for name in table.methods if not options["only"] or name in chosen]
    return {**options, "suites": table.suites, "methods": methods, "seeds": seeds}


def _told(table: PaperTable, summary: Summary | None) -> dict[str, Any]:
    from wonderful_team.evals.paper_filled import filled

    head, lines = filled(table, summary)
    return {
        "title": table.title,
        "where": table.where,
        "note": table.note,
        "head": list(head),
        "lines": [list(line) for line in lines],
    }


command = click.Command(
    "paper",
    callback=_command,
    help=_command.__doc__,
    short_help="The paper's tables for your model, beside the paper's figures.",
    epilog="\b\nwonderful-team paper\nwonderful-team paper toy --model simulated:paper-gpt-4o\n"
    "wonderful-team paper ablation --model openai:NAME --estimate\nwonderful-team paper all --model simulated:paper-gpt-4o\n"
    "wonderful-team paper vima17 --also mine.py:Mine --method team:paper",
    params=[
        click.Argument(["table"], required=False, metavar="[TABLE|all]"),
        click.Option(
            ["--folder"], type=PATH, default=Path("paper"), show_default=True, metavar="DIR",
            help="Where trials are kept and tables are written.",
        ),
        click.Option(
            ["--method", "only"], multiple=True, metavar="A,B",
            help="Only these of the table's methods, such as the team without its rivals. [default: all]",
        ),
        click.Option(
            ["--also"], multiple=True, metavar="FILE.py:NAME,B",
            help="Methods beside the table's own, one of yours or any other: a column or a line more.",
        ),
        *SHARED,
        click.Option(["--open", "open_page"], is_flag=True, help="Open the page when done."),
    ],
)  # fmt: skip
