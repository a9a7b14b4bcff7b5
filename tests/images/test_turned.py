"""Cut-outs turned by numbered angles beside the goal, and what their pixels say."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from wonderful_team.core.geometry import AffineCamera, Box, Frame
from wonderful_team.core.pictures import BoxMark, Picture, Tiles, TurnMark
from wonderful_team.core.values import View
from wonderful_team.images import draw, overview, resampled, seen_from_above
from wonderful_team.images.turn_marks import arc_points
from wonderful_team.images.turned import Shown, misfit, reach_px, thing_alone, turn_misfits, turn_strip

GROUND = (222, 219, 211)


def letter(clockwise_deg, at=(150.0, 120.0), size=(320, 240), name="top"):
    """An L with a red foot: it looks different in every turn."""
    rgb = np.full((size[1], size[0], 3), GROUND, np.uint8)
    parts = (((-20, -32), (-4, 32), (40, 90, 180)), ((-20, 14), (24, 32), (190, 50, 40)))
    c, s = math.cos(math.radians(clockwise_deg)), math.sin(math.radians(clockwise_deg))
    for (x0, y0), (x1, y1), colour in parts:
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        turned = [(at[0] + c * x - s * y, at[1] + s * x + c * y) for x, y in corners]
        cv2.fillPoly(rgb, [np.round(np.array(turned) * 16).astype(np.int32)], colour, cv2.LINE_AA, 4)
    return View(name, "top", 0.0, rgb)


def shown(clockwise_deg, **where):
    view = letter(clockwise_deg, **where)
    box = thing_alone(view)
    return Shown(view, box.centre), reach_px(box)


@pytest.mark.parametrize("turn", [30, 150, 255, -70])
def test_the_cut_out_with_the_right_number_lies_as_the_goal_does(turn):
    thing, reach = shown(20)
    goal, _ = shown(20 + turn, at=(90.0, 150.0), name="goal")
    turns = [*range(0, 360, 30), turn % 360]
    strip = turn_strip(thing, goal, reach, turns, "turns")
    tiles = next(mark for mark in strip.marks if isinstance(mark, Tiles))
    at = next(mark.box for mark in strip.marks if isinstance(mark, BoxMark))
    cut = lambda box: strip.rgb[round(box.y0) : round(box.y1), round(box.x0) : round(box.x1)].astype(np.float32)  # noqa: E731
    inner = [misfit(cut(tile.scaled(0.7)), cut(at)) for tile in tiles.boxes]
    assert int(np.argmin(inner)) in (len(turns) - 1, turns.index(turn % 360))
    assert sorted(inner)[2] > 1.5 * min(inner), "no other turn looks like it"
    off = turn_misfits(thing, goal, reach, turns)
    assert turns[int(off.argmin())] == turn % 360


def test_the_strips_frame_shows_the_goals_own_pixels():
    """A model that knows the truth sees by this which view the goal was cut from."""
    thing, reach = shown(0)
    goal, _ = shown(90, at=(100.0, 100.0), name="goal")
    strip = turn_strip(thing, goal, reach, range(0, 360, 30), "turns")
    frame, valid = strip.frame, strip.frame.valid
    assert frame.view_id == "goal"
    x0, y0, x1, y1 = (round(value) for value in valid.as_tuple)
    assert (x0, y0, x1, y1) == pytest.approx(valid.as_tuple)
    window = frame.box_to_view(valid)
    right = resampled(goal.view.rgb, Frame.window("goal", goal.view.size_px, window, (x1 - x0, y1 - y0)))
    apart = np.abs(strip.rgb[y0:y1, x0:x1].astype(int) - right)
    assert apart.mean() < 1.0
    assert max(strip.size_px) <= 1568
    assert all(frame.whole_box.contains(corner) for mark in strip.marks for corner in corners_of(mark))


def corners_of(mark):
    return [corner for box in (mark.boxes if isinstance(mark, Tiles) else (mark.box,)) for corner in box.corners]


def test_a_large_thing_still_makes_a_strip_that_is_not_shrunk():
    thing = Shown(letter(0, at=(640.0, 480.0), size=(1280, 960)), (640.0, 480.0))
    strip = turn_strip(thing, thing, reach_px(Box(400, 300, 900, 700)), range(0, 360, 30), "turns")
    assert max(strip.size_px) <= 1568


def test_one_thing_alone_is_found_and_two_are_not():
    assert thing_alone(letter(40)).centre == pytest.approx((150, 120), abs=12)
    two = letter(0).rgb.copy()
    two[180:230, 240:300] = (20, 120, 60)
    assert thing_alone(View("top", "top", 0.0, two)) is None
    assert thing_alone(View("top", "top", 0.0, np.full((240, 320, 3), 200, np.uint8))) is None
    # What reaches the picture's edge is the ground, such as the rim of a table.
    rim = letter(0).rgb.copy()
    rim[:20] = (100, 100, 110)
    assert thing_alone(View("top", "top", 0.0, rim)) is not None


def camera(rows):
    return AffineCamera(np.array([*rows, [0, 0, -1.0, 1.0]]))


@pytest.mark.parametrize(
    ("rows", "above"),
    [
        ([[0, -500, 0, 160], [-500, 0, 0, 120]], True),
        ([[0, 500, 0, 160], [-500, 0, 0, 120]], False),
        ([[0, -500, 0, 160], [-200, 0, 0, 120]], False),
    ],
    ids=["from above", "mirrored", "at a slant"],
)
def test_a_turn_on_the_table_is_a_turn_in_a_picture_from_above(rows, above):
    view = letter(0)
    assert seen_from_above(view)
    assert seen_from_above(View("top", "top", 0.0, view.rgb, camera=camera(rows))) is above


@pytest.mark.parametrize("turn", [90, -90, 150])
def test_a_turn_is_drawn_as_an_arc_through_its_whole_angle(turn):
    arc = arc_points((100, 100), 40, turn)
    assert all(math.dist(point, (100, 100)) == pytest.approx(40) for point in arc)
    assert arc[0] == pytest.approx((100, 60)), "it begins above"
    last = math.degrees(math.atan2(arc[-1][0] - 100, -(arc[-1][1] - 100)))
    assert last == pytest.approx(turn)
    clean = Picture("p", np.full((300, 300, 3), 200, np.uint8), Frame.whole("v", (300, 300)))
    corners = ((100, 100), (200, 100), (200, 180), (100, 180))
    rgb = draw(clean.marked(TurnMark((150, 140), corners, turn, "2")))
    changed = (rgb != 200).any(axis=2)
    assert changed[100, 110:190].mean() > 0.5, "the outline"
    # The plate with the degrees stands beside the thing, not on it.
    assert not changed[171:177, 104:196].any()
    assert changed[:95].any() or changed[185:].any() or changed[:, :95].any() or changed[:, 205:].any()


def test_the_picture_of_a_plan_shows_no_arrow_for_what_is_turned_where_it_lies():
    view = letter(0)
    centre = (150.0, 120.0)
    mark = TurnMark(centre, Box(125, 88, 175, 152).corners, 90, "1")
    green = (0, 158, 115)

    def arrows(turns, end):
        drawn = overview(view, arrows=[(centre, end)], turns=turns)
        return bool((drawn == green).all(axis=2).any())

    near, far = (158.0, 123.0), (250.0, 60.0)
    assert arrows((), near)
    assert not arrows((mark,), near)
    assert arrows((mark,), far), "what is carried and turned has both"
