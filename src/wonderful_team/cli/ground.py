"""`ground`: find described things in a picture."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from wonderful_team.cli.options import PATH, Common, common
from wonderful_team.core.filesystem import write_redacted
from wonderful_team.errors import FileNotWrittenError
from wonderful_team.redaction import redact_all


@click.command(
    short_help="Find things in a picture: boxes and points.",
    epilog='\b\nwonderful-team ground desk.jpg "red cube" "the largest bowl" --area "free area left of the bowl"\n'
    'wonderful-team ground desk.jpg "red cube" "bowl" --detector classical',
)
@click.argument("image", type=PATH)
@click.argument("descriptions", nargs=-1, metavar="DESCRIPTION...")
@click.option("--area", multiple=True, metavar="DESCRIPTION", help="A free area instead of an object; may be repeated.")
@click.option("--coco", type=PATH, metavar="OUT.json", help="Write the boxes in COCO format.")
@common
def command(
    common: Common, image: Path, descriptions: tuple[str, ...], area: tuple[str, ...], coco: Path | None
) -> int:
    """Find each described thing: a box and points, or that it is not there.

    With --detector a detector looks instead of the team, and the run folder holds a picture with all its boxes and scores.
    """
    if not (descriptions or area):
        raise click.UsageError("say what to look for: at least one DESCRIPTION or --area DESCRIPTION")
    from wonderful_team.api.observation import Observation
    from wonderful_team.api.team import Team
    from wonderful_team.cli.progress import ProgressLine
    from wonderful_team.cli.run_summary import report_plan
    from wonderful_team.registry import load_ahead

    load_ahead(common.model)
    observation = Observation.from_files(image)
    progress = ProgressLine(live=not common.as_json)
    looks = {"method": "detector-grounding"} if common.detector is not None and common.method == "team" else {}
    team = Team(**{**common.team_arguments(), **looks}, subscribers=(progress,))
    progress.header(team)
    made = team.ground(observation, descriptions, area)
    unwritten = []
    if coco is not None:
        document = coco_document(image, observation.main.size_px, made.targets)
        try:
            write_redacted(coco, json.dumps(redact_all(document), indent=1))
        except FileNotWrittenError as error:
            unwritten.append(f"--coco {error}")
    return report_plan("ground", made, common, progress, unwritten)


def coco_document(image: Path, size_px: tuple[int, int], targets: Any) -> dict[str, Any]:
    """Found boxes in COCO format: [x, y, width, height] [px], one category for each description."""
    boxed = [target for target in targets if target.box_px is not None and target.status == "found"]
    names = list(dict.fromkeys(target.words for target in boxed))
    return {
        "images": [{"id": 1, "file_name": image.name, "width": size_px[0], "height": size_px[1]}],
        "categories": [{"id": number, "name": name} for number, name in enumerate(names, start=1)],
        "annotations": [
            {
                "id": number,
                "image_id": 1,
                "category_id": names.index(target.words) + 1,
                "bbox": [x0, y0, x1 - x0, y1 - y0],
                "area": (x1 - x0) * (y1 - y0),
                "iscrowd": 0,
            }
            for number, target in enumerate(boxed, start=1)
            for x0, y0, x1, y1 in [target.box_px]
        ],
    }
