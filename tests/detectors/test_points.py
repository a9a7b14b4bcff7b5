"""Where to act on what was found: on material, in the middle, or beside it."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from wonderful_team.core.geometry import Box
from wonderful_team.core.values import Detection
from wonderful_team.detectors import act_at, extent_of

YY, XX = np.mgrid[0:80, 0:100]
DISC = np.hypot(XX + 0.5 - 50, YY + 0.5 - 40) < 20
RING = DISC & (np.hypot(XX + 0.5 - 50, YY + 0.5 - 40) > 12)
BOX = Box(30, 20, 70, 60)


def on(mask: np.ndarray, point: tuple[float, float]) -> bool:
    return bool(mask[int(point[1]), int(point[0])])


def test_a_compact_thing_is_picked_in_the_middle_of_its_mask() -> None:
    assert act_at(Detection("disc", BOX, 1, DISC), "pick") == pytest.approx((50, 40), abs=0.1)


def test_a_ring_is_picked_on_its_material_and_placed_on_in_its_middle() -> None:
    ring = Detection("ring", BOX, 1, RING)
    for role in ("pick", "grasp"):
        assert on(RING, act_at(ring, role))  # type: ignore[arg-type]
    assert act_at(ring, "place") == (50, 40)


def test_an_l_is_picked_well_inside_it() -> None:
    mask = np.zeros((80, 100), bool)
    mask[10:60, 10:22] = mask[48:60, 10:60] = True
    x, y = act_at(Detection("L", Box(10, 10, 60, 60), 1, mask), "pick")
    assert mask[int(y) - 3 : int(y) + 4, int(x) - 3 : int(x) + 4].all()


def test_without_a_mask_the_middle_of_the_box() -> None:
    assert act_at(Detection("disc", BOX, 1), "pick") == (50, 40)


@pytest.mark.parametrize(
    ("towards", "side"),
    [
        ((500, 40), (-1, 0)),
        ((0, 40), (1, 0)),
        ((50, 300), (0, -1)),
        ((50, 0), (0, 1)),
        (None, (-1, 0)),
        ((50, 40), (-1, 0)),
    ],
)
def test_a_push_starts_beside_the_box_on_the_side_away_from_its_goal(
    towards: tuple[float, float] | None, side: tuple[int, int]
) -> None:
    x, y = act_at(Detection("disc", BOX, 1), "push_start", towards)
    assert not BOX.contains((x, y))
    assert (np.sign(x - 50), np.sign(y - 40)) == side
    assert act_at(Detection("disc", BOX, 1), "push_end") == (50, 40)


@pytest.mark.parametrize("angle", [0, 30, 90, 150])
def test_the_extent_of_a_turned_slab(angle: int) -> None:
    mask = np.zeros((240, 240), np.uint8)
    corners = cv2.boxPoints(((120, 120), (100, 40), float(angle))).astype(np.int32)
    cv2.fillPoly(mask, [corners], 1)
    found = extent_of(Detection("slab", Box(0, 0, 240, 240), 1.0, mask.astype(bool)))
    assert (found.length, found.width) == pytest.approx((100, 40), abs=3)
    assert min(abs(found.angle_deg - angle), 180 - abs(found.angle_deg - angle)) < 3


def test_the_extent_of_a_box_lies_along_the_picture() -> None:
    wide = extent_of(Detection("slab", Box(0, 0, 50, 20), 1.0))
    tall = extent_of(Detection("slab", Box(0, 0, 20, 50), 1.0))
    assert (wide.length, wide.width, wide.angle_deg) == (50, 20, 0)
    assert (tall.length, tall.width, tall.angle_deg) == (50, 20, 90)
