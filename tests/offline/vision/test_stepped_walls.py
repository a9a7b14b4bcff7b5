"""A wall that rises in steps, as a bowl's with a rim, is one container; what stands in it is not part of it."""

from __future__ import annotations

import numpy as np
import pytest

from wonderful_team.core.values import View
from wonderful_team.images import whole
from wonderful_team.offline.vision import see

TABLE, BLUE, RED = (224, 219, 208), (58, 110, 196), (216, 48, 48)


def view_of(*parts: tuple[float, float, float, tuple[int, int, int], tuple[float, float]]) -> View:
    """Rings and discs: inner and outer radius [px], height [m], colour, middle [px]."""
    rgb, height = np.full((400, 640, 3), TABLE, np.uint8), np.zeros((400, 640))
    rows, columns = np.mgrid[:400, :640]
    for inner, outer, high, colour, (x, y) in parts:
        away = np.hypot(columns - x, rows - y)
        here = (away >= inner) & (away <= outer)
        rgb[here], height[here] = colour, high
    noise = np.random.default_rng(0).normal(0, 1.0, rgb.shape)
    return View("top", "top", 0.0, np.clip(rgb + noise, 0, 255).astype(np.uint8), 1.15 - height)


BOWL = (
    (66.0, 78.0, 0.045, BLUE, (290, 200)),
    (58.0, 66.0, 0.03, BLUE, (290, 200)),
    (0.0, 58.0, 0.005, (46, 90, 160), (290, 200)),
)


def test_a_bowl_with_a_rim_is_one_thing() -> None:
    (bowl,) = see(whole(view_of(*BOWL), "table")).objects
    assert abs(bowl.box.width - 156) < 6


def test_a_ring_that_stands_in_a_bowl_is_a_thing_of_its_own() -> None:
    ring = (12.0, 24.0, 0.03, RED, (290, 200))
    things = see(whole(view_of(*BOWL, ring), "table")).objects
    assert sorted(round(thing.box.width / 10) for thing in things) == [5, 16]


@pytest.mark.parametrize(("radius_px", "aside_px"), [(58.0, 5.0), (60.0, 3.0), (62.0, 1.0)])
def test_a_step_that_is_hidden_on_one_side_still_belongs_to_the_wall(radius_px: float, aside_px: float) -> None:
    """From a camera that does not stand over the bowl, the step is seen as a ring with a gap."""
    step = (0.0, 66.0, 0.03, BLUE, (290, 200))
    floor = (0.0, radius_px, 0.005, (46, 90, 160), (290 + aside_px, 200))
    (bowl,) = see(whole(view_of(BOWL[0], step, floor), "table")).objects
    assert abs(bowl.box.width - 156) < 6
