"""What a tool of a known width sweeps is drawn as a strip of that width, not as a thin arrow."""

from __future__ import annotations

import numpy as np
import pytest

from wonderful_team.agents.rendering import mark_words
from wonderful_team.core.actions import At, PickPlace, PickPlaceStep, Push, PushStep
from wonderful_team.core.geometry import AffineCamera, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import PathMark, Picture
from wonderful_team.core.values import NumberSource, PlannedAction, View
from wonderful_team.images import action_arrows, draw, overview, swept_widths

CAMERA = AffineCamera(np.array([[0, 500.0, 0, 0], [500.0, 0, 0, 0], [0, 0, -1, 1.0]]))
GREY = np.full((200, 400, 3), 150, np.uint8)


def changed_rows(before: Array, after: Array, column: int) -> int:
    """How many pixels of a column differ."""
    return int((before[:, column] != after[:, column]).any(axis=1).sum())


def push(z_m: float = 0.0) -> PlannedAction:
    action = Push(np.array([0.2, 0.1, z_m]), np.array([0.2, 0.7, z_m]))
    sources = (
        NumberSource("push_start", "T1", (50, 100), (0.2, 0.1, z_m), ""),
        NumberSource("push_end", "T2", (350, 100), (0.2, 0.7, z_m), ""),
    )
    return PlannedAction(PushStep("G1", At("T1"), At("T2")), action, sources)


def carry() -> PlannedAction:
    action = PickPlace(np.array([0.1, 0.1, 0.0]), np.array([0.1, 0.7, 0.0]))
    sources = (
        NumberSource("pick", "T1", (50, 50), (0.1, 0.1, 0.0), ""),
        NumberSource("place", "T2", (350, 50), (0.1, 0.7, 0.0), ""),
    )
    return PlannedAction(PickPlaceStep("G1", "T1", At("T2")), action, sources)


def test_widths_follow_from_blade_and_camera() -> None:
    assert swept_widths([push(), carry()], 0.06, CAMERA) == pytest.approx((30.0, 0.0))
    assert swept_widths([push(), carry()], None, CAMERA) == (0.0, 0.0)
    assert swept_widths([push(), carry()], 0.06, None) == (0.0, 0.0)


def test_a_path_with_a_width_is_as_wide_as_its_strip() -> None:
    shown = Picture("view", GREY, Frame.whole("top", (400, 200)))
    thin = draw(shown.marked(PathMark(((50, 100), (350, 100)), "1")))
    wide = draw(shown.marked(PathMark(((50, 100), (350, 100)), "1", 60.0)))
    assert changed_rows(GREY, thin, 120) < 15
    assert 58 <= changed_rows(GREY, wide, 120) <= 66


def test_the_picture_of_a_plan_shows_the_strip() -> None:
    view = View("top", "top", 0.0, GREY, None, CAMERA)
    actions = [push()]
    plain = overview(view, arrows=action_arrows(actions))
    swept = overview(view, arrows=action_arrows(actions), widths=swept_widths(actions, 0.06, CAMERA))
    scale = swept.shape[1] / 400
    column = round(120 * scale)
    rows = changed_rows(overview(view), swept, column)
    assert 28 * scale <= rows <= 36 * scale
    assert changed_rows(overview(view), plain, column) < rows / 2


def test_the_words_say_that_it_is_a_strip() -> None:
    assert mark_words(PathMark(((0, 0), (1, 1)), "2", 8.0)) == "a path labelled 2 with the strip that the tool sweeps"
    assert mark_words(PathMark(((0, 0), (1, 1)), "2")) == "a path labelled 2"
