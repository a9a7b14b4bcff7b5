"""Drawn pictures as they were when someone looked at them and found them right.

To draw them anew after a wanted change, and then look at each before committing:

    WONDERFUL_TEAM_REGENERATE_GOLDEN=1 pytest tests/images/test_golden_pictures.py
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.images.scenes import crop_pair, view
from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Axes, BoxMark, Candidates, PathMark, PointMark
from wonderful_team.core.values import GroundedTarget, KeepOut, Target
from wonderful_team.images import (
    Ticks,
    beside_points,
    crop,
    draw,
    edge_strips,
    inside_points,
    load_picture,
    overview,
    to_png,
    whole,
)

GOLDEN = Path(__file__).parents[1] / "golden"
BLOCK, BOWL = Box(122, 226, 198, 302), Box(378, 131, 518, 271)


def boxes_and_border() -> Array:
    picture = whole(view(), "top").marked(
        Axes(),
        BoxMark(Box(40, 40, 600, 440), "workspace", "workspace"),
        BoxMark(Box(520, 340, 700, 500), "keep_out", "keep out"),
        BoxMark(BLOCK, "target", "T1 red block"),
        BoxMark(BOWL, "before", "before"),
        BoxMark(BOWL.shifted(12, -9), "after", "after"),
        BoxMark(Box(560, -10, 660, 60), "target", "T9 past the corner"),
        PointMark((0.0, 470.0), "corner"),
    )
    return draw(picture)


def candidates_beside_and_inside() -> Array:
    small = whole(view(256, 128), "top")
    box = small.frame.box_to_picture(Box(53, 59, 75, 82))
    return draw(small.marked(Axes(), Candidates(beside_points(box, 40) + inside_points(box, 3, 3))), Ticks.THOUSANDTHS)


def crowded_candidates() -> Array:
    return draw(whole(view(), "top").marked(Candidates(inside_points(Box(400, 150, 500, 250), 5, 5))))


def crop_with_reference_axes() -> Array:
    source = view()
    sent = whole(source, "top")
    part = crop(source, Box(596, 400, 640, 470), "crop")
    box = part.frame.box_to_picture(Box(596, 400, 640, 470))
    return draw(part.marked(Axes(reference=sent.frame), BoxMark(box, "target", "T2")))


def before_and_after() -> Array:
    pair = crop_pair(view(256, 128), Box(50, 55, 80, 85), Box(53, 60, 75, 81))
    return np.hstack([draw(picture.marked(Axes())) for picture in pair])


def strips() -> Array:
    found = edge_strips(view(), Box(118.5, 222, 201, 306))
    return np.hstack([draw(found["left", "outside"]), draw(found["left", "inside"]), draw(found["right", "outside"])])


def path_and_points() -> Array:
    picture = whole(view(), "top").marked(
        PathMark(((160, 264), (230, 180), (330, 140), (430, 190)), "path"),
        PointMark((308.0, 380.0), "grasp"),
        PointMark((160.0, 264.0)),
    )
    return draw(picture)


def plan_overview() -> Array:
    grounded = [
        GroundedTarget(Target("T1", "object", "red block"), "found", "top", BLOCK, {"pick": (160, 264)}),
        GroundedTarget(Target("T2", "object", "blue bowl"), "found", "top", BOWL, {"place": (448, 201)}),
        GroundedTarget(Target("T3", "area", "free space"), "found", "top", None, {"place": (420, 390)}),
    ]
    return overview(
        view(),
        grounded,
        arrows=[((160, 264), (448, 201)), ((448, 201), (420, 390))],
        keep_out=[KeepOut("laptop", Box(520, 330, 700, 500))],
        workspace=Box(40, 40, 600, 440),
    )


DRAWINGS: tuple[Callable[[], Array], ...] = (
    boxes_and_border,
    candidates_beside_and_inside,
    crowded_candidates,
    crop_with_reference_axes,
    before_and_after,
    strips,
    path_and_points,
    plan_overview,
)


@pytest.mark.parametrize("drawing", DRAWINGS, ids=lambda drawing: drawing.__name__)
def test_drawings_look_as_they_did(drawing: Callable[[], Array]) -> None:
    file = GOLDEN / f"{drawing.__name__}.png"
    drawn = drawing()
    if os.environ.get("WONDERFUL_TEAM_REGENERATE_GOLDEN"):
        file.write_bytes(to_png(drawn, compression=9))
    golden = load_picture(file)
    assert drawn.shape == golden.shape
    # Other builds of FreeType and OpenCV shade the rims of strokes a little differently.
    off = np.abs(drawn.astype(int) - golden).max(axis=2) > 48
    assert off.mean() < 0.002, f"{off.sum()} pixels differ from {file.name}"
