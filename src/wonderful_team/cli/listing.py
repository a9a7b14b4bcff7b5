"""`list`: what there is to choose from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import click

from wonderful_team.cli.options import PATH
from wonderful_team.cli.output import finish
from wonderful_team.core.filesystem import make_private_folder, write_public
from wonderful_team.core.text import counted, ending_words, visible
from wonderful_team.errors import ConfigError, reading

KINDS = ("models", "worlds", "tasks", "suites", "methods", "detectors", "prompts", "words", "runs")


@click.command(
    name="list", short_help="List models, worlds, tasks, suites, methods, detectors, prompts, words or runs."
)
@click.argument("kind", type=click.Choice(KINDS))
@click.option(
    "--out", type=PATH, metavar="DIR", help="For runs: where they lie. For prompts: write them there, to edit."
)
@click.option("--html", type=PATH, metavar="FILE", help="For runs: write a table with pictures that can be filtered.")
@click.option("--open", "open_page", is_flag=True, help="Open the table of --html.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")
def command(kind: str, out: Path | None, html: Path | None, open_page: bool, as_json: bool) -> int:
    """List models, worlds, tasks, suites, methods, detectors, prompts, words (that `offline` reads) or runs, each with a line of help."""
    if kind != "runs" and (html is not None or open_page):
        raise click.UsageError("--html and --open go with `list runs`")
    if open_page and html is None:
        raise click.UsageError("--open goes with --html FILE")
    lists: Mapping[str, Callable[[Path | None], dict[str, str]]] = {
        "models": _models,
        "worlds": _worlds,
        "tasks": _tasks,
        "suites": _suites,
        "methods": _methods,
        "detectors": _detectors,
        "prompts": _prompts,
        "words": _words,
        "runs": _runs,
    }
    found = lists[kind](out)
    width = max((len(name) for name in found), default=0)
    text = "\n".join(f"{name:<{width}}  {words}".rstrip() for name, words in found.items()) or f"no {kind}"
    last = "" if html is None else f"page: {_write_table(html, out, open_page)}"
    if kind == "runs" and (told := _trials_words(out)):
        text += f"\n{told}"
    result = {kind: found} if html is None else {kind: found, "page": str(html)}
    return finish("list", text=text, result=result, as_json=as_json, code=0, last_line=last)


def _write_table(path: Path, out: Path | None, open_page: bool) -> str:
    from wonderful_team.cli.run_summary import shown_path
    from wonderful_team.pages.runs import write_runs_table
    from wonderful_team.record.run_folders import all_runs

    hint = "give another file with --html FILE"
    make_private_folder(path.parent, hint)
    write_runs_table(all_runs(out), path)
    if open_page:
        click.launch(path.resolve().as_uri())
    return shown_path(path)


def _trials_words(out: Path | None) -> str:
    """What is kept of studies beside the runs."""
    from wonderful_team.record.run_folders import TRIALS, runs_folder, trials_kept

    kept = trials_kept(out)
    if not kept and not (runs_folder(out) / TRIALS).is_dir():
        return ""
    where = runs_folder(out) / TRIALS
    return f"{counted(kept, 'trial')} of studies with a record in {where}; of the others: wonderful-team show STORE.db"


def _models(out: Path | None) -> dict[str, str]:
    from wonderful_team.models.profiles import saved_profiles
    from wonderful_team.registry.models import MODEL_FORMS, MODELS

    saved = {name: held if isinstance(held, str) else held.line for name, held in saved_profiles().items()}
    return {**MODELS, **saved, **MODEL_FORMS}


def _worlds(out: Path | None) -> dict[str, str]:
    from wonderful_team.registry.worlds import WORLDS

    return {
        **{name: row.words for name, row in WORLDS.items()},
        "FILE.py:NAME": "your own: a class with the World interface, or a task made with wonderful_team.task",
    }


def _tasks(out: Path | None) -> dict[str, str]:
    from wonderful_team.registry.worlds import task_names

    return task_names()


def _suites(out: Path | None) -> dict[str, str]:
    from wonderful_team.api.known_suites import known_suites

    return {
        name: f"{counted(len(suite.tasks), 'task')}; {suite.help or suite.protocol.name}{'; ' + suite.note if suite.note else ''}"
        for name, suite in known_suites().items()
    }


def _methods(out: Path | None) -> dict[str, str]:
    from wonderful_team.registry.methods import METHODS

    return {
        **{name: row.words for name, row in METHODS.items()},
        "team:-MEMBER-MEMBER": "the team without any of verification, manager, checker, mover, memory (in this order), "
        "as in team:-verification-mover; the same after team:paper",
        "team:-each": "in studies: the team, and the team without each member in turn; also team:paper:-each",
        "FILE.py:NAME": "your own: a class with the Policy interface",
    }


def _detectors(out: Path | None) -> dict[str, str]:
    from wonderful_team.registry.detectors import DETECTOR_FORMS, DETECTORS

    return {**{name: row.words for name, row in DETECTORS.items()}, **DETECTOR_FORMS}


def _prompts(out: Path | None) -> dict[str, str]:
    from wonderful_team.agents import Prompts

    files = Prompts.default().files()
    if out is None:
        return {name: text.strip().partition("\n")[0] for name, text in files.items()}
    hint = "give another folder with --out DIR"
    with reading(f"--out {str(out)!r}", hint):
        other = [
            out / name
            for name, text in files.items()
            if (out / name).exists() and (out / name).read_text(encoding="utf-8") != text
        ]
    if other:
        raise ConfigError(f"--out: {str(other[0])!r} exists with other words; choose an empty folder")
    for name, text in files.items():
        write_public(out / name, text, hint)
    return {str(out / name): "written" for name in files}


def _words(out: Path | None) -> dict[str, str]:
    from wonderful_team.offline.language import known_words

    return known_words()


def _runs(out: Path | None) -> dict[str, str]:
    from wonderful_team.record.record_schema import read_record
    from wonderful_team.record.run_folders import all_runs

    found = {}
    for folder in all_runs(out):
        try:
            content = read_record(folder)
        except ConfigError:
            found[folder.name] = "record unreadable"
            continue
        outcome = content.get("outcome") or {}
        words = "  ".join(ending_words(str(outcome.get("outcome") or ""), outcome.get("reason"))).strip()
        found[folder.name] = visible(words or str(content.get("state", "")))
    return found
