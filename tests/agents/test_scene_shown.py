"""How one observation and instruction are shown: sizes, ticks, cut-outs, regions to keep out of, and views that tell nothing."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from tests.images.test_stacked import BLUE, RED, Thing, table
from wonderful_team.agents import build_request
from wonderful_team.agents.rendering import caption
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import DraftPlan, ReadScene, ReviewPlan
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, Picture, RegionMark
from wonderful_team.core.values import Instruction, KeepOut, Limits, Observation, Slot, SlotKind, Target, View, Words
from wonderful_team.images.axes import Ticks, axis_ticks

SIZE = (320, 160)
LIMITS = Limits((-1.0, -1.0, 0.0), (1.0, 1.0, 1.0))
NOW: tuple[Thing, ...] = ((40, 40, RED), (200, 60, BLUE))


def look(view_id: str, *things: Thing, camera: str = "top", size: tuple[int, int] = SIZE) -> View:
    return View(view_id, camera, 0.0, table(*things, size=size).rgb)


def slot(name: str, kind: SlotKind, *things: Thing, index: int | None = None) -> Slot:
    views = {
        "top": look(f"slot:{name}:top", *things),
        "front": look(f"slot:{name}:front", *things[:1], camera="front"),
    }
    return Slot(name, kind, views, index)


def scene_of(*slots: Slot, limits: Limits = LIMITS, size: tuple[int, int] = SIZE) -> SceneShown:
    views = {"top": look("top", *NOW, size=size), "front": look("front", *NOW[:1], camera="front")}
    text = "do as shown: " + " ".join(f"{{{item.name}}}" for item in slots)
    return SceneShown(Observation(views), Instruction(text, {item.name: item for item in slots}), PICK_PLACE, limits)


def pictures(scene: SceneShown) -> Mapping[str, tuple[Picture, ...]]:
    return {item.name: item.pictures for item in scene.slots}


@pytest.mark.parametrize("size", [(320, 160), (640, 320), (256, 128), (600, 400), (2000, 1000)])
def test_the_main_view_is_large_and_the_others_as_they_are(size: tuple[int, int]) -> None:
    main, front = scene_of(size=size).views
    assert 1280 <= max(main.size_px) <= 1568
    assert front.size_px == (640, 320)
    assert main.frame.box_to_view(main.frame.whole_box).as_tuple == pytest.approx((0, 0, *size))


def test_a_goal_scene_is_shown_in_the_main_views_size_and_with_its_ticks() -> None:
    scene = scene_of(slot("goal", "scene", (120, 100, RED), (200, 60, BLUE)))
    target = Target("T1", "area", "where the red one lies in {goal}", like=("goal",), use=("place",))
    (example,) = scene.examples([target])
    (goal,) = example.pictures
    (axes,) = goal.mark(Axes)
    main = scene.labelled
    assert goal.size_px == main.size_px
    for axis in (0, 1):
        ticks = [axis_ticks(item.frame, mark, Ticks.PIXELS, axis, 100) for item, mark in ((goal, axes), (main, Axes()))]
        assert ticks[0] == ticks[1]
    assert "tick labels along the edges, in pixels of the main view's picture" in caption(goal)
    assert not scene.examples([target], ticks=False)[0].pictures[0].marks


@pytest.mark.parametrize(
    ("goal", "shown"),
    [
        (((120, 100, RED), (200, 60, BLUE)), 1),  # moved
        (((200, 60, RED), (40, 40, BLUE)), 1),  # swapped
        (((40, 40, RED), (45, 45, BLUE)), 2),  # one lies on the other
    ],
)
def test_the_front_view_of_a_goal_is_shown_where_something_lies_on_something(
    goal: tuple[Thing, ...], shown: int
) -> None:
    for kind in ("scene", "frame"):
        assert len(pictures(scene_of(slot("goal", kind, *goal)))["goal"]) == shown


def test_pairs_are_cut_to_what_differs_and_need_no_front_view() -> None:
    before, after = slot("was", "before", (40, 40, RED), index=1), slot("is", "after", (60, 60, RED), index=1)
    found = pictures(scene_of(before, after))
    assert [len(found[name]) for name in ("was", "is")] == [1, 1]
    first, second = found["was"][0], found["is"][0]
    assert first.size_px == second.size_px
    assert first.frame.box_to_view(first.frame.whole_box).width < 0.5 * SIZE[0]
    assert (first.frame.T_view_picture == second.frame.T_view_picture).all()


def test_regions_to_keep_out_of_are_drawn_and_named_for_supervisor_verification_and_manager() -> None:
    region = KeepOut("laptop", Box(100, 20, 180, 90))
    scene = scene_of(limits=Limits(LIMITS.low_m, LIMITS.high_m, (region,)))
    (mark,) = scene.views[0].mark(RegionMark)
    assert isinstance(mark, RegionMark)
    assert Box.bounding(mark.corners).as_tuple == pytest.approx(
        scene.views[0].frame.box_to_picture(region.box).as_tuple
    )
    target = Target("T1", "object", "the red one", use=("pick",))
    for question in (
        DraftPlan(scene.task, ("pick_place",), True),
        ReviewPlan(scene.task, ("pick_place",), (), ()),
        ReadScene((target,), (), scene.labelled, scene.views[1:]),
    ):
        request = build_request(question, id="q", stage="plan")
        assert any(mark in item.marks for item in request.pictures)
        text = "\n".join(part.text for part in request.parts if isinstance(part, Words))
        assert "a region that nothing may enter labelled laptop" in text


def test_single_things_are_cut_out_and_keep_their_exact_frames() -> None:
    thing = slot("thing", "object", (200, 60, BLUE))
    top, _ = pictures(scene_of(thing))["thing"]
    shown = top.frame.box_to_picture(Box(200, 60, 230, 90))
    middle = top.rgb[int(shown.centre[1]), int(shown.centre[0])]
    assert np.array_equal(middle, BLUE)
    assert min(top.size_px) >= 200


def test_to_find_a_place_the_other_views_of_a_scene_are_not_sent() -> None:
    stacked = scene_of(slot("goal", "scene", (200, 60, RED), (200, 60, BLUE)))
    (goal,) = stacked.slots
    target = Target("T1", "area", "where the red one lies in {goal}", like=("goal",), use=("place",))
    (example,) = stacked.examples([target])
    assert [picture.name for picture in goal.pictures][:1] == [picture.name for picture in example.pictures]
    assert example.pictures[0].size_px == stacked.views[0].size_px
    # A scene that another camera took is all there is.
    other = Slot("goal", "scene", {"phone": look("slot:goal:phone", *NOW, camera="phone", size=(200, 300))})
    (kept,) = scene_of(other).examples([target])
    assert [picture.name for picture in kept.pictures] == ["{goal} phone"]


def test_of_several_frames_that_define_a_place_the_last_one_is_compared() -> None:
    frames = [slot(f"frame_{number}", "frame", (40 * number, 100, RED), index=number) for number in (1, 2, 3)]
    scene = scene_of(*frames, slot("goal", "scene", (120, 100, RED)))
    for like, wanted in (
        (("frame_1", "frame_2"), "frame_2"),
        (("frame_3", "frame_1"), "frame_3"),
        (("goal",), "goal"),
    ):
        found = scene.arranged(Target("T1", "area", "where it ends", like=like, use=("place",)))
        assert found is not None
        assert found[0] == wanted
    assert scene.arranged(Target("T1", "object", "it", like=("frame_1",))) is None
