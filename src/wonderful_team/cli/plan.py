"""`plan`: pictures and an instruction to a plan; nothing moves."""

from __future__ import annotations

from pathlib import Path

import click

from wonderful_team.cli.options import PATH, Common, common, read_pairs


@click.command(
    short_help="Plan from pictures and an instruction; nothing moves.",
    epilog='\b\nwonderful-team plan desk.jpg "put the red cube to the left of the blue bowl"'
    '\nwonderful-team plan desk.jpg "put {this} into the bowl" --picture this=cube.png',
)
@click.argument("words", nargs=-1, metavar="IMAGE... INSTRUCTION")
@click.option(
    "--picture",
    multiple=True,
    metavar="NAME=FILE",
    help="A picture for {NAME} in the instruction (NAME:scene=FILE for a scene).",
)
@click.option(
    "--depth", type=PATH, metavar="FILE", help="Depth of the first image: 16-bit PNG in mm, or .npy in metres."
)
@click.option("--camera", type=PATH, metavar="FILE", help="Camera file (JSON) of the first image: gives metres.")
@click.option(
    "--corners",
    metavar='"x,y x,y x,y x,y=WxH"',
    help="The table's corners in the first image, clockwise from the top left, and its size in metres.",
)
@click.option(
    "--vocabulary",
    type=click.Choice(["pick_place", "push", "arm"]),
    default="pick_place",
    show_default=True,
    help="Kinds of action.",
)
@click.option(
    "--until",
    type=click.Choice(["draft", "checked", "grounded", "actions"]),
    default="actions",
    show_default=True,
    help="Stop early.",
)
@click.option(
    "--facts",
    metavar="TEXT",
    help="What planners are told of the robot: tool, reach, viewpoint, north, turns. Default: that it is not known.",
)
@click.option("--keep-out", multiple=True, metavar="[NAME=]x0,y0,x1,y1[px|m]", help="A region nothing may enter.")
@common
def command(
    common: Common,
    words: tuple[str, ...],
    picture: tuple[str, ...],
    depth: Path | None,
    camera: Path | None,
    corners: str | None,
    vocabulary: str,
    until: str,
    facts: str | None,
    keep_out: tuple[str, ...],
) -> int:
    """Plan for photos of a workspace: subgoals, targets, boxes and points, actions.

    Without --camera or --corners the plan is in pixels; with one of them also in metres. On a terminal, and without --json, you
    are asked what neither picture nor instruction settles, and planning goes on with your answer.
    """
    if len(words) < 2:
        raise click.UsageError("at least one IMAGE and then the INSTRUCTION are needed")
    from wonderful_team.api.observation import Observation
    from wonderful_team.api.photos import instruction_with_pictures, read_keep_out
    from wonderful_team.api.team import Team
    from wonderful_team.cli.asking import user_to_ask
    from wonderful_team.cli.progress import ProgressLine
    from wonderful_team.cli.run_summary import report_plan
    from wonderful_team.errors import reading
    from wonderful_team.registry import load_ahead

    load_ahead(common.model)
    *files, text = words
    observation = Observation.from_files(*files, depth=depth, camera=camera, corners=corners)
    with reading("the instruction with its pictures"):
        instruction = instruction_with_pictures(text, read_pairs(picture, "--picture"))
    with reading("--keep-out", "[NAME=]x0,y0,x1,y1[px|m]"):
        regions = read_keep_out(keep_out)
    progress = ProgressLine(live=not common.as_json)
    team = Team(**common.team_arguments(), subscribers=(progress,), ask=user_to_ask(common.as_json))
    progress.header(team)
    made = team.plan(
        observation,
        instruction,
        vocabulary=vocabulary,
        until=until,  # type: ignore[arg-type]  # click has checked the choice
        keep_out=regions,
        facts=facts,
    )
    return report_plan("plan", made, common, progress)
