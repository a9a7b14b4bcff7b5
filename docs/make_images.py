"""Make the pictures of the README from real runs: `make images`."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

import wonderful_team as wt
from wonderful_team.cli.app import run

HERE = Path(__file__).parent
HEIGHT_PX = 300
CAPTION_PX = 30
GAP_PX = 6


def main() -> None:
    """Run the demo and put four of its pictures together."""
    with tempfile.TemporaryDirectory() as out:
        code = run(["demo", "--out", out])
        if code != 0:
            raise SystemExit(f"the demo ended with exit code {code}; the picture is left as it was")
        folder = Path(out) / "latest"
        record = json.loads((folder / "record.json").read_text(encoding="utf-8"))
        rows = (
            (
                ("a planted wrong first box, as the Checker is shown it", _sent(record, folder, "before")),
                ("after the Mover: the Checker takes it and stops", _sent(record, folder, "after")),
            ),
            (
                ("the plan: targets, boxes, points, the actions", folder / "final.png"),
                ("after the robot ran it", folder / record["files"][_last_view(record)]),
            ),
        )
        lines = [_side_by_side([_captioned(Image.open(path), text) for text, path in row]) for row in rows]
        width = max(line.width for line in lines)
        lines = [line.resize((width, round(line.height * width / line.width))) for line in lines]
        _stacked(lines).save(HERE / "images" / "demo.png", optimize=True)


def example_photo() -> None:
    """A rendered desk that stands in for a photo in the README's commands."""
    world = wt.make_world(f"{HERE.parent / 'examples' / 'own_task.py'}:blocks", seed=3)
    Image.fromarray(world.observe().main.rgb).save(HERE.parent / "examples" / "desk.png", optimize=True)
    world.close()


def _sent(record: dict, folder: Path, name: str) -> Path:
    """The first picture of that name that was sent with a question about a revised box."""
    for request in record["planner"]["requests"]:
        if request["contract"] == "JudgeRevision":
            for part in request["parts"]:
                if name in part.get("picture", ""):
                    return folder / record["files"][part["drawn"]]
    raise SystemExit(f"the run has no picture {name!r} of a revised box")


def _last_view(record: dict) -> str:
    subgoal = record["planner"]["subgoals"][-1]
    return subgoal["after"][subgoal["main"]]


def _captioned(picture: Image.Image, text: str) -> Image.Image:
    picture = picture.convert("RGB").resize((round(picture.width * HEIGHT_PX / picture.height), HEIGHT_PX))
    whole = Image.new("RGB", (picture.width, HEIGHT_PX + CAPTION_PX), "white")
    whole.paste(picture, (0, CAPTION_PX))
    ImageDraw.Draw(whole).text((4, 5), text, fill="black", font=ImageFont.load_default(17))
    return whole


def _side_by_side(pictures: list[Image.Image]) -> Image.Image:
    line = Image.new(
        "RGB", (sum(p.width for p in pictures) + GAP_PX * (len(pictures) - 1), pictures[0].height), "white"
    )
    x = 0
    for picture in pictures:
        line.paste(picture, (x, 0))
        x += picture.width + GAP_PX
    return line


def _stacked(lines: list[Image.Image]) -> Image.Image:
    whole = Image.new("RGB", (lines[0].width, sum(line.height for line in lines) + GAP_PX * (len(lines) - 1)), "white")
    y = 0
    for line in lines:
        whole.paste(line, (0, y))
        y += line.height + GAP_PX
    return whole


if __name__ == "__main__":
    example_photo()
    main()
