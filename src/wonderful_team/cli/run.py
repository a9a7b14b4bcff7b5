"""`run`: plan, pass the gate, act in a world, look, replan."""

from __future__ import annotations

from pathlib import Path

import click

from wonderful_team.cli.options import PATH, Common, common
from wonderful_team.core.deadline import to_end
from wonderful_team.core.text import counted
from wonderful_team.record.run_folders import find_run

REOBSERVE = 16
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
@click.option(
    "--plan",
    "plan_run",
    metavar="RUN",
    help="Run the plan of an earlier run exactly as it was read, or move nothing (exit 4).",
)
@click.option(
    "--replans",
    type=click.IntRange(0),
    default=3,
    show_default=True,
    help="Most new plans after the first one ran or was refused; 0 with --plan: that plan and no other.",
)
@click.option(
    "--reobserve",
    type=click.IntRange(0),
    help=f"New pictures after a push, the rest planned anew; default {REOBSERVE}, none with --replans 0 or --plan.",
)
@click.option(
    "--approve",
    is_flag=True,
    help='Ask before anything moves: y runs it, n ends with exit 4, "n, because ..." is advice for one new plan.',
)
@click.option("--keep-out", multiple=True, metavar="[NAME=]x0,y0,x1,y1[px|m]", help="A region nothing may enter.")
@click.option("--video", type=PATH, metavar="FILE", help="Write an animation of the run (.webp, .gif or .png).")
@click.option(
    "--rerun",
    is_flag=False,
    flag_value="",
    metavar="[FILE.rrd]",
    help="Write a recording for Rerun's viewer; without a FILE, recording.rrd in the run folder.",
)
@common
def command(
    common: Common,
    world: str,
    instruction: str | None,
    seed: int,
    plan_run: str | None,
    replans: int,
    reobserve: int | None,
    approve: bool,
    keep_out: tuple[str, ...],
    video: Path | None,
    rerun: str | None,
) -> int:
    """Run a method in a world: WORLD/TASK such as tabletop/rotate, or FILE.py:NAME.

    An INSTRUCTION takes the place of the task's own; the task's scorer is then left out. On a terminal, and without --json, you
    are asked what neither picture nor instruction settles, and planning goes on with your answer.
    """
    from wonderful_team.api.method import Method
    from wonderful_team.api.photos import read_keep_out
    from wonderful_team.api.rollout import make_world, rollout
    from wonderful_team.api.team import Team
    from wonderful_team.cli.asking import ask, user_to_ask
    from wonderful_team.cli.progress import ProgressLine
    from wonderful_team.cli.run_summary import report_trial
    from wonderful_team.cli.video import FRAME_S, Film, check_video_name
    from wonderful_team.core.protocols import Filmed, offers
    from wonderful_team.errors import BudgetReached, FileNotWrittenError, reading
    from wonderful_team.record import read_run_plan
    from wonderful_team.record.rerun_recording import RERUN_NAME, check_rerun
    from wonderful_team.registry.methods import team_mode
    from wonderful_team.registry.worlds import scene_name
    from wonderful_team.runtime.user_code import close_world

    if video is not None:
        check_video_name(video)
    if rerun is not None:
        check_rerun(Path(rerun) if rerun else None)
    plan = read_run_plan(find_run(plan_run, common.out)) if plan_run is not None else None
    if reobserve is None:
        reobserve = REOBSERVE if replans and plan is None else 0
    kind = Method if team_mode(common.method) is None else Team
    with reading("--keep-out", "[NAME=]x0,y0,x1,y1[px|m]"):
        regions = read_keep_out(keep_out)
    progress = ProgressLine(live=not common.as_json)
    method = kind(**common.team_arguments(), subscribers=(progress,), ask=user_to_ask(common.as_json))
    place = make_world(world, seed, instruction, regions)
    try:
        film = Film() if video is not None else None
        if film is not None and offers(place, Filmed):
            place.film(film.motion, FRAME_S)
        progress.header(method)
        progress.task(scene_name(world, seed), place.instruction)
        trial = rollout(
            method,
            place,
            plan=plan,
            replans=replans,
            reobserve=reobserve,
            approval=ask if approve else None,
            seed=seed,
            scene=scene_name(world, seed),
            subscribers=() if film is None else (film,),
            rerun=False if rerun is None else rerun or True,
        )
    finally:
        close_world(place, progress.note)
    unwritten = []
    if film is not None and video is not None:
        try:
            to_end("making the video", film.write, video)
            progress.note(f"video: {video} ({counted(len(film.frames), 'picture')})")
        except (FileNotWrittenError, BudgetReached) as error:
            unwritten.append(f"--video {error}")
    written = None if rerun is None else Path(rerun) if rerun or trial.folder is None else trial.folder / RERUN_NAME
    if written is not None and written.is_file():
        progress.note(f"recording: {written} (`rerun FILE` shows it)")
    files = {"video": video, "rerun": written}
    told = {name: None if file is None else str(file) for name, file in files.items()}
    return report_trial("run", trial, common, progress, told, unwritten)
