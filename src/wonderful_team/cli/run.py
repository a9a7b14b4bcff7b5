"""`run`: plan, pass the gate, act in a world, look, replan."""

from __future__ import annotations

import getpass
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from wonderful_team.cli.options import PATH, Common, common
from wonderful_team.cli.output import say
from wonderful_team.runs import find_run
from wonderful_team.text import counted

if TYPE_CHECKING:
    from wonderful_team.runtime import Approver
    from wonderful_team.types import GateReport, Plan, PlannedAction


LOOKS = 16
"""More pushes than any sweep of the suite may take."""


@click.command(
    short_help="Plan, pass the gate, act in a world, look, replan.",
    epilog="\b\nwonderful-team run tabletop/rotate --seed 3\nwonderful-team run tabletop/rotate --seed 3 --approve\n"
    "wonderful-team run tabletop/rotate --seed 3 --plan latest",
)
@click.argument("world", metavar="WORLD/TASK")
@click.argument("instruction", required=False)
@click.option(
    "--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the scene; below 1000 for development."
)
@click.option("--plan", "plan_run", metavar="RUN", help="Run the plan of an earlier run, exactly as it was read.")
@click.option("--replans", type=click.IntRange(0), default=3, show_default=True, help="Plans after the first.")
@click.option(
    "--looks",
    type=click.IntRange(0),
    help=f"New pictures after a push, the rest planned anew; default {LOOKS}, none with --replans 0 or --plan.",
)
@click.option("--approve", is_flag=True, help="Ask before anything moves.")
@click.option("--keep-out", multiple=True, metavar="[NAME=]x0,y0,x1,y1[px|m]", help="A region nothing may enter.")
@click.option("--video", type=PATH, metavar="FILE", help="Write an animation of the run (.webp, .gif or .png).")
@common
def command(
    common: Common,
    world: str,
    instruction: str | None,
    seed: int,
    plan_run: str | None,
    replans: int,
    looks: int | None,
    approve: bool,
    keep_out: tuple[str, ...],
    video: Path | None,
) -> int:
    """Run a method in a world: WORLD/TASK such as tabletop/rotate, or FILE.py:NAME.

    An INSTRUCTION takes the place of the task's own; the task's scorer is then left out.
    """
    from wonderful_team.api import Team, make_world, rollout
    from wonderful_team.cli.progress import Progress
    from wonderful_team.cli.report import report_trial
    from wonderful_team.cli.video import FRAME_S, Film, check_video_name
    from wonderful_team.errors import reading
    from wonderful_team.interfaces import Filmed
    from wonderful_team.methods import Method
    from wonderful_team.photos import read_keep_out
    from wonderful_team.registry import scene_name, team_way
    from wonderful_team.runtime import read_plan
    from wonderful_team.runtime.user_code import close_world

    if video is not None:
        check_video_name(video)
    plan = read_plan(find_run(plan_run, common.out)) if plan_run is not None else None
    if looks is None:
        looks = LOOKS if replans and plan is None else 0
    kind = Method if team_way(common.method) is None else Team
    with reading("--keep-out", "[NAME=]x0,y0,x1,y1[px|m]"):
        regions = read_keep_out(keep_out)
    progress = Progress(live=not common.as_json)
    method = kind(**common.team_arguments(), subscribers=(progress,))
    place = make_world(world, seed, instruction, regions)
    try:
        film = Film() if video is not None else None
        if film is not None and isinstance(place, Filmed):
            place.film(film.motion, FRAME_S)
        progress.header(method)
        progress.task(scene_name(world, seed), place.instruction)
        trial = rollout(
            method,
            place,
            plan=plan,
            replans=replans,
            looks=looks,
            approval=ask_person() if approve else None,
            seed=seed,
            scene=scene_name(world, seed),
            subscribers=() if film is None else (film,),
        )
    finally:
        close_world(place, progress.note)
    if film is not None and video is not None:
        film.write(video)
        progress.note(f"video: {video} ({counted(len(film.frames), 'picture')})")
    return report_trial("run", trial, common, progress, {"video": None if video is None else str(video)})


def ask_person() -> Approver:
    """A function that shows a plan and asks for consent on the terminal; no answer is a no."""
    from wonderful_team.cli.wording import action_line, words_of
    from wonderful_team.runtime import Approval, actions_id

    def ask(plan: Plan | None, actions: Sequence[PlannedAction], gate: GateReport) -> Approval | None:
        admitted, checks = counted(len(actions), "action"), counted(len(gate.checks), "check")
        say(f"The gate admits {admitted} ({checks}):", err=True)
        for planned in actions:
            say(f"  {action_line(planned, words_of(plan))}", err=True)
        try:
            agreed = click.confirm("Run this plan?", default=False, err=True)
        except click.Abort as error:
            # click says the same for Ctrl-C and for the end of input; only the latter means that nobody is there.
            if isinstance(error.__context__, KeyboardInterrupt):
                raise KeyboardInterrupt from error
            return None
        return Approval(actions_id(actions) if plan is None else plan.id, getpass.getuser()) if agreed else None

    return ask
