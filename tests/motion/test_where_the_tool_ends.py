"""A place is where the middle of a thing lands; where the tool ends is said beside it, everywhere a plan is read."""

from __future__ import annotations

import json

import numpy as np
import pytest

from tests.motion.block_scenes import LIMITS, Block, cameras, found, scene
from wonderful_team.cli.wording import action_line, numbers_line
from wonderful_team.core.actions import At, Beside, PickPlace, PickPlaceStep, Place
from wonderful_team.core.geometry import Box
from wonderful_team.core.values import GroundedTarget, Instruction, NumberSource, Plan, PlannedAction, Target, View
from wonderful_team.motion import ground_actions
from wonderful_team.pages.running import actions as page_actions
from wonderful_team.record.plan_file import plan_from_json, plan_to_json

PHOTO = View("photo", "photo", 0.0, np.zeros((400, 600, 3), np.uint8))
SPOON = GroundedTarget(
    Target("T1", "object", "spoon"), "found", "photo", Box(320, 150, 420, 250), {"pick": (368.0, 230.0)}
)
SAUCER = GroundedTarget(
    Target("T2", "object", "saucer"), "found", "photo", Box(100, 150, 300, 350), {"place": (200.0, 250.0)}
)


def in_pixels(place: Place, rotate_deg: float = 0.0) -> PlannedAction:
    grounded = {"T1": SPOON, "T2": SAUCER}
    (planned,) = ground_actions([PickPlaceStep("G1", "T1", place, rotate_deg)], grounded, PHOTO, LIMITS)
    return planned


def place_of(planned: PlannedAction) -> NumberSource:
    return planned.sources[1]


@pytest.mark.parametrize("place", [At("T2"), Beside("T2", "right")])
def test_the_tool_ends_where_it_holds_the_thing(place: Place) -> None:
    source = place_of(in_pixels(place))
    assert source.tool_px is not None
    # Picked 2 px left of and 30 px below the middle of its box, the thing is held there at the end, too.
    assert source.tool_px == pytest.approx((source.point_px[0] - 2, source.point_px[1] + 30))


def test_beside_counts_from_the_middle_of_the_thing() -> None:
    source = place_of(in_pixels(Beside("T2", "right")))
    assert source.point_px[0] - 50 == pytest.approx(300 + 0.15 * 200)


def test_a_turn_takes_the_tool_along() -> None:
    source = place_of(in_pixels(At("T2"), 90.0))
    assert source.tool_px == pytest.approx((200 - 30, 250 - 2))


def test_a_thing_that_is_held_at_its_middle_needs_no_second_point() -> None:
    camera = cameras()["affine"] if "affine" in cameras() else next(iter(cameras().values()))
    red, pan = Block(0.38, -0.2, 0.44, -0.1, 0.05), Block(0.5, 0.05, 0.62, 0.2, 0.01)
    grounded = {
        "T1": found(camera, "T1", red, {"pick": (0.5, 0.5)}),
        "T2": found(camera, "T2", pan, {"place": (0.5, 0.5)}),
    }
    (planned,) = ground_actions([PickPlaceStep("G1", "T1", At("T2"))], grounded, scene(camera, red, pan), LIMITS)
    assert place_of(planned).tool_px is None


def test_terminal_page_and_plan_file_say_where_the_tool_ends() -> None:
    planned = in_pixels(At("T2"))
    assert action_line(planned, {}).endswith("T2 @ (200, 250) px, tool at (198, 280) px")
    assert "place (200.0, 250.0) px, tool at (198.0, 280.0) px" in numbers_line(planned)
    plan = Plan(Instruction("put it there"), "planned", actions=(planned,), steps=(planned.step,))
    data = json.loads(json.dumps(plan_to_json(plan)))
    assert data["plan"]["actions"][0]["sources"][1]["tool_px"] == [198.0, 280.0]
    assert plan_from_json(data).id == plan.id
    data["plan"]["actions"][0]["sources"][1]["tool_px"] = [300.0, 280.0]
    with pytest.raises(Exception, match="it was changed after it"):
        plan_from_json(data)


def test_the_page_says_where_the_tool_ends() -> None:
    plan = Plan(Instruction("put it there"), "planned", actions=(in_pixels(At("T2")),))
    record = {"planner": {"plans": [plan_to_json(plan)], "gates": []}}
    (chapter,) = page_actions(record)
    assert [source["tool"] for source in chapter["rows"][0]["sources"]] == ["", "(198.0, 280.0)"]


@pytest.mark.parametrize("name", ["pinhole", "tilted", "panned"])
def test_the_pixel_where_the_tool_ends_is_that_of_its_metres_for_cameras_in_perspective(name: str) -> None:
    """A tall thing that is picked far from its middle: its top shows larger than the ground where it is put."""
    camera = cameras()[name]
    tall, pan = Block(0.40, -0.22, 0.48, -0.06, 0.2), Block(0.5, 0.05, 0.62, 0.2, 0.01)
    grounded = {
        "T1": found(camera, "T1", tall, {"pick": (0.15, 0.9)}),
        "T2": found(camera, "T2", pan, {"place": (0.5, 0.5)}),
    }
    view = scene(camera, tall, pan)
    (planned,) = ground_actions([PickPlaceStep("G1", "T1", At("T2"), 0.0)], grounded, view, LIMITS)
    source = place_of(planned)
    assert isinstance(planned.action, PickPlace)
    assert source.tool_px is not None
    seen = camera.project([planned.action.place_m])[0]
    assert source.tool_px == pytest.approx((float(seen[0]), float(seen[1])), abs=0.5)
