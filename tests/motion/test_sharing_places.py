"""Several things that go to one place do not land on each other."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest

from tests.motion.block_scenes import LIMITS, Block, cameras, found, scene
from wonderful_team.core.actions import At, OriginOf, PickPlace, PickPlaceStep, Place
from wonderful_team.core.geometry import AffineCamera, Box
from wonderful_team.core.values import GroundedTarget, Target, View
from wonderful_team.motion import ground_actions, sharing
from wonderful_team.motion.deprojector import Deprojector

CAMERAS = cameras()
RED = Block(0.38, -0.30, 0.43, -0.25, 0.05)
BLUE = Block(0.38, -0.20, 0.43, -0.15, 0.05)
GREEN = Block(0.55, -0.30, 0.60, -0.25, 0.05)
TRAY = Block(0.45, 0.05, 0.65, 0.25, 0.01)
SMALL = Block(0.50, 0.05, 0.56, 0.11, 0.05)


def put(pick: str, place: Place) -> PickPlaceStep:
    return PickPlaceStep("G1", pick, place, 0.0)


def grounded(camera: Any, place: Block = TRAY) -> dict[str, GroundedTarget]:
    blocks = {"T1": RED, "T2": BLUE, "T4": GREEN}
    middle = {"T3": found(camera, "T3", place, {"place": (0.5, 0.5)})}
    return middle | {name: found(camera, name, block, {"pick": (0.5, 0.5)}) for name, block in blocks.items()}


def ends(steps: list[PickPlaceStep], camera: Any, place: Block = TRAY) -> list[np.ndarray]:
    view = scene(camera, RED, BLUE, GREEN, place)
    actions = [planned.action for planned in ground_actions(steps, grounded(camera, place), view, LIMITS)]
    assert all(isinstance(action, PickPlace) for action in actions)
    return [action.place_m for action in actions if isinstance(action, PickPlace)]


@pytest.mark.parametrize("name", ["affine", "pinhole", "tilted"])
@pytest.mark.parametrize("count", [2, 3])
def test_things_in_one_tray_lie_beside_each_other_and_inside(name: str, count: int) -> None:
    steps = [put(thing, At("T3")) for thing in ("T1", "T2", "T4")[:count]]
    places = ends(steps, CAMERAS[name])
    gaps = [np.hypot(*(one - other)[:2]) for k, one in enumerate(places) for other in places[:k]]
    assert min(gaps) > 0.05  # as wide as the blocks
    for place in places:
        assert TRAY.x0 + 0.02 < place[0] < TRAY.x1 - 0.02
        assert TRAY.y0 + 0.02 < place[1] < TRAY.y1 - 0.02
        assert place[2] == pytest.approx(TRAY.height, abs=0.004)


def test_one_thing_alone_and_one_after_another_go_to_the_middle() -> None:
    camera = CAMERAS["affine"]
    alone = ends([put("T1", At("T3"))], camera)[0]
    in_turn = ends([put("T1", At("T3")), put("T1", OriginOf("T1")), put("T2", At("T3"))], camera)
    for place in (alone, in_turn[0], in_turn[2]):
        assert place[:2] == pytest.approx((0.55, 0.15), abs=0.006)


def test_where_there_is_no_room_things_are_stacked_on_the_point_itself() -> None:
    first, second = ends([put("T1", At("T3")), put("T2", At("T3"))], CAMERAS["affine"], SMALL)
    assert first[:2] == pytest.approx((0.53, 0.08), abs=0.006)
    assert second[:2] == pytest.approx(first[:2], abs=1e-6)
    assert first[2] == pytest.approx(SMALL.height, abs=0.004)
    assert second[2] == pytest.approx(SMALL.height + RED.height, abs=0.004)


def test_the_source_of_the_number_says_that_a_place_is_shared() -> None:
    camera = CAMERAS["affine"]
    steps = [put("T1", At("T3")), put("T2", At("T3"))]
    planned = ground_actions(steps, grounded(camera), scene(camera, RED, BLUE, GREEN, TRAY), LIMITS)
    assert "part 2 of 2" in planned[1].sources[1].how


def test_the_parts_of_a_place_are_found_once_for_a_view(monkeypatch: pytest.MonkeyPatch) -> None:
    found_for = []
    find = sharing.parts_of

    def counted(place: GroundedTarget, *more: Any) -> Any:
        found_for.append(more[2].view)
        return find(place, *more)

    monkeypatch.setattr(sharing, "parts_of", counted)
    camera = CAMERAS["affine"]
    steps = [put(thing, At("T3")) for thing in ("T1", "T2", "T4")]
    targets = grounded(camera)
    views = [scene(camera, RED, BLUE, GREEN, TRAY) for _ in range(2)]
    first, again, other = (ground_actions(steps, targets, view, LIMITS) for view in (views[0], views[0], views[1]))
    assert found_for == views
    assert [planned.action.place_m.tolist() for planned in first] == [
        planned.action.place_m.tolist() for planned in again
    ]
    assert len(other) == 3


def seen(depth_m: np.ndarray) -> Deprojector:
    """What a camera 1 m over the table sees, shape (400, 640) [m]: 800 px a metre, the base under the middle of the upper edge."""
    camera = AffineCamera(np.array([[0, 800.0, 0, 320], [800.0, 0, 0, -200], [0, 0, -1.0, 1.0]]))
    return Deprojector(View("top", "top", 0.0, np.zeros((400, 640, 3), np.uint8), depth_m=depth_m, camera=camera))


def square_box(side_px: float) -> GroundedTarget:
    """A box as a place, round (300, 200)."""
    box = Box.around((300.0, 200.0), side_px, side_px)
    return GroundedTarget(Target("T1", "object", "box"), "found", "top", box, {})


def test_the_floor_of_a_place_that_lies_askew_is_what_most_of_it_shows() -> None:
    """Its box shows the table in the corners, an edge, and in the middle a handle: half of what it shows lies lower than its floor."""
    depth = np.full((400, 640), 1.0, np.float32)
    for sides_px, height_m in (((150, 150), 0.055), ((108, 108), 0.063), ((44, 12), 0.094)):
        corners = cv2.boxPoints(((300.0, 200.0), sides_px, 8.0))
        cv2.fillPoly(depth, [np.round(corners).astype(np.int32)], 1.0 - height_m)
    place = square_box(170.0)
    parts = sharing.parts_of(place, (300.0, 200.0), [(19.0, 19.0), (18.0, 18.0)], seen(depth))
    assert np.hypot(*np.subtract(*parts)) > 37


@pytest.mark.parametrize("handle_px", [(64, 20), (130, 44)])
def test_under_a_lid_that_will_be_gone_things_lie_side_by_side_near_the_middle(handle_px: tuple[int, int]) -> None:
    """The lid's plate is wider than the opening, and nothing shows how wide that is: the handle must not drive them apart."""
    depth = np.full((400, 640), 1.0, np.float32)
    for (width, height), height_m in (((150, 150), 0.06), (handle_px, 0.09)):
        depth[200 - height // 2 : 200 + height // 2, 300 - width // 2 : 300 + width // 2] = 1.0 - height_m
    place = square_box(150.0)
    parts = sharing.parts_of(place, (300.0, 200.0), [(22.0, 22.0), (22.0, 22.0)], seen(depth), True)
    assert 44 <= np.hypot(*np.subtract(*parts)) <= 62
    stays = sharing.parts_of(place, (300.0, 200.0), [(22.0, 22.0), (22.0, 22.0)], seen(depth))
    assert stays != parts, "a handle that stays is in the way"


def test_a_place_that_is_too_small_for_both_takes_them_one_upon_the_other() -> None:
    depth = np.full((400, 640), 1.0, np.float32)
    depth[170:230, 270:330] = 1.0 - 0.06
    place = square_box(60.0)
    parts = sharing.parts_of(place, (300.0, 200.0), [(25.0, 25.0), (25.0, 25.0)], seen(depth))
    assert parts == [(300.0, 200.0), (300.0, 200.0)]


@pytest.mark.parametrize(("point", "room"), [((300.0, 200.0), True), ((270.0, 228.0), True), ((520.0, 200.0), False)])
def test_things_in_one_free_area_of_a_box_lie_side_by_side_on_its_floor(point: tuple[float, float], room: bool) -> None:
    """An area has a point and no outline: its floor is seen round the point, in the middle of a box or beside its wall."""
    depth = np.full((400, 640), 1.0, np.float32)
    for middle, outer, inner in ((300, 130, 118), (520, 64, 52)):
        for side, height_m in ((outer, 0.06), (inner, 0.005)):
            depth[200 - side // 2 : 200 + side // 2, middle - side // 2 : middle + side // 2] = 1.0 - height_m
    area = GroundedTarget(Target("T1", "area", "free space in the box"), "found", "top", None, {"place": point})
    parts = sharing.parts_of(area, point, [(20.0, 20.0), (20.0, 20.0)], seen(depth))
    if not room:
        assert parts == [point, point]
        return
    assert np.hypot(*np.subtract(*parts)) > 24
    for part in parts:
        assert np.max(np.abs(np.subtract(part, (300.0, 200.0)))) <= 59 - 20  # not on the wall


def test_things_on_a_square_stay_as_far_from_its_edge_as_they_can() -> None:
    """Side by side along its diagonal: what shows as the floor of a closed box is as wide as its walls."""
    depth = np.full((400, 640), 1.0, np.float32)
    depth[140:260, 240:360] = 1.0 - 0.06
    place = square_box(120.0)
    parts = sharing.parts_of(place, (300.0, 200.0), [(20.0, 20.0), (20.0, 20.0)], seen(depth))
    (dx, dy) = np.abs(np.subtract(*parts))
    assert np.hypot(dx, dy) > 40
    assert dx == pytest.approx(dy, rel=0.05)
