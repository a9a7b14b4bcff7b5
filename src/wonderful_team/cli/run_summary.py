"""The end of a command that planned or ran: result, cost, page."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from wonderful_team.api.results import PlanResult, TrialResult, cost_json
from wonderful_team.cli.options import Common
from wonderful_team.cli.output import finish
from wonderful_team.cli.progress import ProgressLine
from wonderful_team.cli.wording import plan_exit_code, plan_lines, trial_exit_code, trial_lines
from wonderful_team.core.jsonable import to_jsonable


def report_plan(
    command: str, made: PlanResult, common: Common, progress: ProgressLine, unwritten: Sequence[str] = ()
) -> int:
    """Print a plan; returns the exit code."""
    progress.end(made.usage)
    failed = (*made.unwritten, *unwritten)
    return end(command, plan_lines(made), made.to_json(), common, plan_exit_code(made), made.page, failed)


def report_trial(
    command: str,
    trial: TrialResult,
    common: Common,
    progress: ProgressLine,
    more: Mapping[str, Any],
    unwritten: Sequence[str] = (),
) -> int:
    """Print a trial; returns the exit code."""
    progress.end(trial.usage)
    result, code = {**trial_json(trial), **more}, trial_exit_code(trial)
    return end(command, trial_lines(trial), result, common, code, trial.page, (*trial.unwritten, *unwritten))


def trial_json(trial: TrialResult) -> dict[str, Any]:
    """A trial as JSON: the whole of it stands in record.json."""
    return {
        "scene": trial.scene,
        "seed": trial.seed,
        "method": trial.method,
        "model": trial.model,
        "status": trial.ending,
        "outcome": trial.outcome,
        "stage": trial.stage,
        "reason": trial.reason,
        "plan_ids": [plan.id for plan in trial.plans],
        "refusals": [reason for gate in trial.gates for reason in gate.reasons],
        "executed": sum(report.executed for report in trial.reports),
        "verdicts": to_jsonable(trial.verdicts),
        "warnings": list(trial.warnings),
        **cost_json(trial.usage, trial.usage_by_role, trial.folder),
    }


def end(
    command: str,
    lines: list[str],
    result: Mapping[str, Any],
    common: Common,
    code: int,
    page: Path | None,
    unwritten: Sequence[str] = (),
) -> int:
    """Result on stdout, the page on the last line, and the page in a browser when asked for.

    Args:
        command: Which one ends.
        lines: The result as text.
        result: The same for machines.
        common: Options.
        code: The exit code, if all was written.
        page: None where there is none.
        unwritten: Which files could not be written, and why: the result stands all the same.
    """
    page = page if page is not None and page.is_file() else None
    last = "" if page is None else f"page: {shown_path(page)}"
    if page is not None and common.open_page:
        click.launch(page.resolve().as_uri())
    text = "\n".join(lines)
    return finish(
        command, text=text, result=result, as_json=common.as_json, code=code, last_line=last, unwritten=unwritten
    )


def program() -> str:
    """How a person calls this program here: by its name, or where that is not found by its path or as a module of this Python."""
    if shutil.which("wonderful-team"):
        return "wonderful-team"
    called = Path(sys.argv[0])
    return (
        f"{shown_path(Path(sys.executable))} -m wonderful_team" if called.name == "__main__.py" else shown_path(called)
    )


def shown_path(path: Path) -> str:
    """A path as a person types it: relative to the working directory where that is shorter."""
    try:
        return str(path.absolute().relative_to(Path.cwd()))
    except ValueError:
        return str(path)
