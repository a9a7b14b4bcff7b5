"""For services that count pictures in tiles, enlarged pictures are fitted to them; numbers keep meaning what they say."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.agents.question_samples import RIVALS, SAMPLES
from tests.models.wire.scenes import answer_px, picture, reading
from wonderful_team import contracts as c
from wonderful_team.agents import build_request
from wonderful_team.contracts import Question, ReadScene
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, BoxMark
from wonderful_team.core.values import Target, View, Words
from wonderful_team.images import crop, whole
from wonderful_team.models.conventions import CONVENTIONS, PIXELS
from wonderful_team.models.families import guess_family
from wonderful_team.models.wire import compose
from wonderful_team.models.wire.composing import Composed
from wonderful_team.models.wire.showing import LEAST_OF_ENLARGED, fewer_tiles

TILE = 512
VIEW = View("top", "top", 0.0, np.random.default_rng(3).integers(0, 256, (400, 640, 3), np.uint8))
GPT = CONVENTIONS["gpt-tiles"]


def tiles(size: tuple[int, int]) -> int:
    return -(-size[0] // TILE) * -(-size[1] // TILE)


def sizes(composed: Composed) -> tuple[tuple[int, int], ...]:
    return composed.sizes_px


def words(composed: Composed) -> str:
    return "\n".join(piece for piece in composed.pieces if isinstance(piece, str))


@given(st.integers(1, 2000), st.integers(1, 2000), st.floats(0.3, 1.0))
def test_a_smaller_size_has_the_shape_is_not_too_small_and_fills_no_more_tiles(
    width: int, height: int, least: float
) -> None:
    across, down = fewer_tiles((width, height), TILE, least)
    assert tiles((across, down)) <= tiles((width, height))
    assert (across, down) == (width, height) or tiles((across, down)) < tiles((width, height))
    assert least * width - 1 <= across <= width
    assert abs(across / width - down / height) <= 1 / min(width, height)


def test_the_enlarged_main_view_is_sent_as_four_tiles_and_a_crop_as_one() -> None:
    main = whole(VIEW, "top view", long_side_px=1280)
    near = crop(VIEW, Box(300, 200, 340, 240), "crop").marked(BoxMark(Box(10, 10, 200, 200)))
    assert (tiles(GPT.seen_size(main.size_px)), tiles(near.size_px)) == (6, 4 if min(near.size_px) > TILE else 1)
    sent = sizes(compose(reading(main), GPT, tile_px=TILE))
    assert [tiles(size) for size in sent] == [4]
    assert sent[0][0] >= LEAST_OF_ENLARGED * 1229 - 1
    assert sizes(compose(reading(main), GPT)) == (GPT.seen_size(main.size_px),)


def test_a_photo_is_never_sent_with_fewer_pixels_than_it_has() -> None:
    for size in ((1000, 700), (600, 500), (1300, 500)):
        shown = picture(size)
        assert sizes(compose(reading(shown), GPT, tile_px=TILE)) == (GPT.seen_size(size),)
    slightly = whole(View("v", "v", 0.0, np.zeros((600, 1000, 3), np.uint8)), "v", long_side_px=1100)
    assert sizes(compose(reading(slightly), PIXELS, tile_px=TILE))[0][0] >= 1000


def test_answers_come_back_in_pixels_of_our_own_picture() -> None:
    main = whole(VIEW, "top view", long_side_px=1280)
    right: Any = answer_px(main)
    composed = compose(reading(main), GPT, tile_px=TILE)
    (across, down), (width, height) = sizes(composed)[0], main.size_px
    said = json.loads(json.dumps(right))
    box, point = said["targets"][0]["box"], said["targets"][0]["points"][0]["point"]
    said["targets"][0]["box"] = [box["x0"] * across / width, box["y0"] * down / height, box["x1"] * across / width, box["y1"] * down / height]  # fmt: skip
    said["targets"][0]["points"][0]["point"] = [point["x"] * across / width, point["y"] * down / height]
    read = composed.read(json.dumps(said)).value
    assert read["targets"][0]["box"] == pytest.approx(box)
    assert read["targets"][0]["points"][0]["point"] == pytest.approx(point)
    assert f"x from 0 to {across}, y from 0 to {down}" in words(composed)


@pytest.mark.parametrize("tile_px", [None, TILE])
def test_ticks_that_name_another_pictures_pixels_name_those_that_are_sent(tile_px: int | None) -> None:
    """A goal scene is labelled in pixels of the main view: a model copies a number from one to the other."""
    main, goal = (
        whole(View(name, name, 0.0, np.full((400, 640, 3), grey, np.uint8)), name, long_side_px=1280)
        for name, grey in (("top view", 200), ("scene", 210))
    )
    goal = goal.marked(Axes(main.frame))
    slot = c.ShownSlot("scene", "frame", (goal,))
    question = ReadScene((Target("T1", "area", "place", like=("scene",)),), (), main.marked(Axes()), (), (slot,))
    sent = compose(build_request(question, id="x", stage="ground"), GPT, tile_px=tile_px).sent
    assert tile_px is None or tiles(sent[0].size_px) == 4
    bare = [np.asarray(one.rgb == grey).all(axis=-1) for one, grey in zip(sent, (200, 210), strict=True)]
    # The same numbers stand at the same places, but for the 0 in the corner of the main view.
    assert (bare[0] != bare[1]).mean() < 0.002
    assert 0.9 < bare[0].mean() < 0.99


def test_the_checkers_tolerance_is_told_in_pixels_of_the_crop_that_is_sent() -> None:
    box = Box(300, 200, 380, 260)
    shown = crop(VIEW, box, "crop", min_side_px=640)
    shown = shown.marked(BoxMark(shown.frame.box_to_picture(box)))
    request = build_request(c.JudgeBox(Target("T1", "object", "mug"), shown), id="x", stage="ground")
    plain, fitted = compose(request, PIXELS), compose(request, PIXELS, tile_px=TILE)
    assert sizes(fitted)[0][0] < sizes(plain)[0][0]
    share = sizes(fitted)[0][0] / sizes(plain)[0][0]
    (before,), (after,) = (
        [int(text.split("stands at most ")[1].split(" px")[0])] for text in map(words, (plain, fitted))
    )
    assert after == pytest.approx(before * share, abs=1)


@pytest.mark.parametrize("question", SAMPLES, ids=lambda question: question.contract)
def test_what_counts_pixels_keeps_its_size(question: Question) -> None:
    """Nothing but captions, positions and tolerance speaks of pixels where pictures may be sent in another size."""
    request = build_request(question, id="q", stage="plan", role=RIVALS.get(question.contract))
    if not question.any_size:
        assert question.contract in RIVALS or question.contract in (
            "LocatePoints", "GiveBox", "ReadScene", "MoveBox", "WriteFunction", "ReadTurn", "Remember",
        )  # fmt: skip
        return
    said = [part.text for part in request.parts if isinstance(part, Words) and not part.says]
    assert not [
        text for text in (request.system, *said) if " px" in text or "pixels of" in text.replace("a few pixels", "")
    ]


def test_only_families_that_count_tiles_have_them() -> None:
    assert [guess_family(name).tile_px for name in ("gpt-4o", "gpt-5", "gpt-5.4", "gpt-4.1-mini", "claude-sonnet-4-6", "?")] == [
        TILE, TILE, None, None, None, None,
    ]  # fmt: skip
