"""`bench`: methods x models x suites x seeds, in one durable store."""

from __future__ import annotations

import contextlib
import math
import shlex
import shutil
import sqlite3
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from wonderful_team.cli.options import CACHE, CACHE_FILE, ENCODING, LOCAL_ONLY, PATH, THOROUGH, TIMEOUT
from wonderful_team.cli.output import finish, say
from wonderful_team.core.deadline import limited
from wonderful_team.core.interrupts import as_keyboard, exit_code

if TYPE_CHECKING:
    from wonderful_team.api.study import Study
    from wonderful_team.evals.monitor import StudyStatus
    from wonderful_team.evals.study import StudyResult

BUDGET = 5
QUIET_S = 10.0


@click.command(
    short_help="Compare methods and models on suites, with controls.",
    epilog="\b\nwonderful-team bench vima3 --estimate\n"
    "wonderful-team bench vima3 fruit --method team,team:paper --seeds 1000:1020 --store study.db\n"
    "wonderful-team bench ablation --method team:-each --model NAME --store ablation.db\n"
    "wonderful-team bench pointing --set photos.json --method point,team --model NAME\n"
    "wonderful-team bench rotate --method mine.py:Mine --store study.db && wonderful-team report study.db",
)
@click.argument("suites", nargs=-1, metavar="SUITE|TASK|FILE.py:TASK|PHOTOS.json ...")
@click.option("--method", "methods", multiple=True, metavar="A,B", help="Methods; default team.")
@click.option(
    "--model",
    "models",
    multiple=True,
    metavar="M,N|ROLE=M",
    help="Models; default offline. M,ROLE=X: M with X for one role; ROLE=X alone: for all of them.",
)
@click.option(
    "--detector",
    metavar="NAME",
    help="Who finds things for methods that look with a detector: see `list detectors`. [default: classical]",
)
@click.option(
    "--thinking", multiple=True, metavar="LEVEL|ROLE=LEVEL", help="off, low, medium or high. [default: the model's own]"
)
@click.option(
    "--price", multiple=True, metavar="IN,OUT|ROLE=IN,OUT", help="USD per million tokens, where none is known."
)
@click.option("--allow-unpriced", is_flag=True, help="Accept models of unknown price without a cap on tokens.")
@LOCAL_ONLY
@TIMEOUT
@ENCODING
@CACHE
@CACHE_FILE
@click.option("--seeds", metavar="FIRST:END", help="For every task; default the suite's own, from 1000 on.")
@click.option("--repeats", type=click.IntRange(1), default=1, show_default=True, help="How often each scene is run.")
@click.option("--replans", type=click.IntRange(0), help="Plans after the first; default the suite's protocol.")
@click.option(
    "--reobserve",
    type=click.IntRange(0),
    default=0,
    show_default=True,
    help="New pictures after a push, the rest planned anew.",
)
@click.option(
    "--isolate",
    multiple=True,
    metavar="whole|planning|grounding",
    help="Truth answers for the other part; several with commas.",
)
@click.option(
    "--perturb",
    multiple=True,
    metavar="KIND=0..3",
    help="Harder tiers: clutter, lighting, camera, texture or paraphrase; one (lighting=2) or several (lighting=0..3).",
)
@click.option(
    "--no-control", "refused", multiple=True, metavar="NAME|all", help="Leave a control out; may be repeated."
)
@click.option(
    "--set",
    "photo_set",
    type=PATH,
    metavar="PATH",
    help="With pointing and boxcheck: your own pictures instead of the toy table.",
)
@click.option(
    "--format",
    "set_format",
    metavar="FORMAT",
    help="How they are written: where2place, refspatial or coco. [default: as the files show]",
)
@click.option("--estimate", is_flag=True, help="Say what it would take, from a few pilot trials, and run no more.")
@click.option("--pilot", type=click.IntRange(1), help="With --estimate: so many trials per condition, also paid ones.")
@click.option("--store", type=PATH, default=Path("study.db"), show_default=True, help="Where trials are kept.")
@click.option("--jobs", type=click.IntRange(1), help="Worker processes. [default: one per core]")
@click.option("--at-once", type=click.IntRange(1), default=1, show_default=True, help="Trials in flight per process.")
@click.option("--shard", metavar="I/N", help="Only this part, in a store file of its own.")
@click.option(
    "--ray",
    metavar="HOST:PORT|auto|local",
    help="Run on a Ray cluster, on --jobs workers (default one per core of it); local starts one here.",
)
@click.option(
    "--ship",
    type=PATH,
    multiple=True,
    metavar="PATH",
    help="With --ray: files and folders that your own code reads; what the command names is sent anyway.",
)
@click.option("--retry-errors", is_flag=True, help="Run trials again that ended as errors.")
@click.option(
    "--record",
    type=click.Choice(["full", "failures", "none"]),
    default="failures",
    show_default=True,
    help="Trials that keep their run folder (record, pictures, page): all, those that did not succeed, or none.",
)
@click.option("--pages", type=click.Choice(["all", "failures", "none"]), hidden=True)
@click.option("--out", type=PATH, metavar="DIR", help="Where the run folders of trials go. [default: runs]")
@click.option("--prompts", type=PATH, metavar="DIR", help="Your own words for the roles.")
@click.option("--thorough", is_flag=True, help=THOROUGH)
@click.option("--concurrency", type=click.IntRange(1), help="Model calls at once, over all workers.")
@click.option("--max-calls", type=click.IntRange(1), help="Of the whole study.")
@click.option("--max-tokens", type=click.IntRange(1), help="Of the whole study.")
@click.option("--max-usd", type=click.FloatRange(0, min_open=True), help="Of the whole study, where prices are known.")
@click.option(
    "--max-seconds",
    type=click.FloatRange(0, min_open=True),
    help="Of this command; trials in flight are then cut and given back.",
)
@click.option("--trial-max-calls", type=click.IntRange(1), help="Of one trial: it then fails at stage budget.")
@click.option("--trial-max-tokens", type=click.IntRange(1), help="Of one trial.")
@click.option(
    "--trial-max-seconds",
    type=click.FloatRange(0, min_open=True),
    help="Of one trial: models, world, drawing and judging.",
)
@click.option("--trial-max-usd", type=click.FloatRange(0, min_open=True), help="Of one trial.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")
@click.option("--open", "open_page", is_flag=True, help="Write the report beside the store and open it when done.")
def command(**options: Any) -> int:
    """Run methods and models over suites with controls; what ended stays in the store, and the same command resumes."""
    with limited(options["max_seconds"]):
        return _bench(options)


def _bench(options: dict[str, Any]) -> int:
    from wonderful_team.api.study import Study

    words = shlex.join(["wonderful-team", *(click.get_current_context().obj or ())])
    study = Study.from_options(**by_new_names(options), command=words)
    if options["estimate"]:
        return tell_estimate("bench", study, options)
    ended, code = run_study(study, options)
    lines = [*study.lines(), *stopped_line(ended), study.kept_line(), f"report: wonderful-team report {study.store}"]
    if options["open_page"]:
        click.launch(study.report(Path(study.store).with_suffix(".html")).resolve().as_uri())
    return finish("bench", text="\n".join(lines), result=study.to_json(ended), as_json=options["as_json"], code=code)


def by_new_names(options: dict[str, Any]) -> dict[str, Any]:
    """The options with --pages, an old name, as --record."""
    pages = options.get("pages")
    if pages is None:
        return options
    click.echo("warning: --pages is called --record now (all: full); the old name goes with the next release", err=True)
    return {**options, "record": pages}


def tell_estimate(command: str, study: Study, options: dict[str, Any]) -> int:
    """What a study would take."""
    from wonderful_team.api.study import PILOT

    _tell_notes(study)
    click.echo("a few pilot trials are run where nothing is recorded, on development seeds", err=True)
    estimate = study.estimate(options["pilot"] or PILOT, paid_pilot=options["pilot"] is not None)
    return finish(command, text=estimate.text(), result=estimate.to_json(), as_json=options["as_json"], code=0)


def run_study(study: Study, options: dict[str, Any]) -> tuple[StudyResult, int]:
    """Run what is missing of a study; how it ended, and the exit code."""
    from wonderful_team.errors import ClusterLostError, FileNotWrittenError, WonderfulTeamError

    _tell_notes(study)
    try:
        with as_keyboard():
            ended = study.run(report=Teller())
    except (FileNotWrittenError, ClusterLostError) as error:
        # The trials that ended stand in the store: their figures are the result in hand.
        with contextlib.suppress(WonderfulTeamError, sqlite3.Error):
            say("\n".join(study.lines()), err=options["as_json"])
        raise error
    return ended, 0 if not ended.why else BUDGET if "cap" in ended.why else exit_code()


def stopped_line(ended: StudyResult) -> list[str]:
    """Why a study ended before its end."""
    return [f"stopped: {ended.why}"] if ended.why else []


def _tell_notes(study: Study) -> None:
    for note in study.notes:
        click.echo(f"note: {note}", err=True)


class Teller:
    """Progress on stderr: one line that renews itself on a terminal, and a line every ten seconds elsewhere."""

    def __init__(self) -> None:
        self._terminal = sys.stderr.isatty()
        self._last_s, self._last = -math.inf, ""

    def __call__(self, text: str, status: StudyStatus | None) -> None:
        if status is None:
            click.echo(("\n" if self._terminal and self._last else "") + text, err=True)
            return
        line = status.line()
        whole = status.done == status.total
        if self._terminal:
            # A line longer than the terminal would not be overwritten by the next.
            line = line[: shutil.get_terminal_size().columns - 1]
            click.echo(f"\r{line:<{len(self._last)}}", nl=whole, err=True)
        elif line != self._last and (whole or time.monotonic() - self._last_s >= QUIET_S):
            click.echo(line, err=True)
            self._last_s = time.monotonic()
        self._last = line
