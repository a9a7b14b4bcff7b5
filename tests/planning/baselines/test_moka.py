"""`moka`: two questions for a plain task, six keypoints a thing and 5 x 5 tiles as marks, and its crashes apart from other failures."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wonderful_team as wt
from tests.desk import read_record
from tests.planning.baselines.runs import Listening, contracts, decided, photo, pictures, requests, run, words
from wonderful_team.core.actions import ARM, VOCABULARIES
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Candidates, Grid
from wonderful_team.core.protocols import Act, GaveUp
from wonderful_team.core.values import Detection, Instruction, Request
from wonderful_team.planning.baselines.moka import keypoints


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """One trial with one subtask."""
    return run("moka", "visual_manipulation", tmp_path_factory.mktemp("moka"))


def marked(trial: Any) -> dict[str, Any]:
    (found,) = [request for request in requests(trial) if request["contract"] == "ChooseMotion"]
    return found


def test_names_first_then_one_question_for_each_subtask(trial: Any) -> None:
    assert trial.outcome == "success"
    assert sorted(contracts(trial)) == ["ChooseMotion", "ListSubtasks"]
    looks = read_record(trial.folder)["planner"]["detections"]
    assert [entry["words"] for entry in looks] == [["pink letter R"], ["red paisley pan"]]


def test_six_keypoints_of_each_thing_and_a_grid_of_25_tiles_are_drawn(trial: Any) -> None:
    (shown,) = pictures(marked(trial))
    points = {mark["prefix"]: mark["points"] for mark in shown["marks"] if mark["type"] == "Candidates"}
    assert {prefix: len(found) for prefix, found in points.items()} == {"P": 6, "Q": 6}
    assert [(mark["columns"], mark["rows"]) for mark in shown["marks"] if mark["type"] == "Grid"] == [(5, 5)]
    assert "a grid of tiles a1 to e5" in words(marked(trial))
    assert "points P1 to P6, points Q1 to Q6" in words(marked(trial))
    looks = read_record(trial.folder)["planner"]["detections"]
    for entry, prefix in zip(looks, ("P", "Q"), strict=True):
        box = Box(*entry["found"][0]["box"]).grown(1, 1, 1, 1)
        # The picture is twice as large as the view.
        assert all(box.contains((x / 2, y / 2)) for x, y in points[prefix])


def test_what_runs_goes_from_the_chosen_grasp_to_the_chosen_target(trial: Any) -> None:
    (shown,), said = pictures(marked(trial)), marked(trial)["answer"]["parsed"]
    points = {mark["prefix"]: mark["points"] for mark in shown["marks"] if mark["type"] == "Candidates"}
    for target, role, name, prefix in (("T1", "pick", "grasp_keypoint", "P"), ("T2", "place", "target_keypoint", "Q")):
        x, y = points[prefix][int(said[name][1:]) - 1]
        assert trial.plans[0].grounded[target].points[role] == pytest.approx((x / 2, y / 2))
    assert trial.plans[0].subgoals[0].text == "put the pink letter R into or onto the red paisley pan"


def test_keypoints_are_the_middle_and_points_of_the_boundary_as_far_apart_as_they_can_be() -> None:
    mask = np.zeros((100, 200), bool)
    mask[20:80, 40:160] = True
    middle, *around = keypoints(Detection("slab", Box(40, 20, 160, 80), 1.0, mask), (200, 100))
    assert middle == pytest.approx((100, 50), abs=1)
    assert len(around) == 5
    # All lie on the edge, the farthest corner among them, and none near another.
    assert all(min(x - 40, 160 - x, y - 20, 80 - y) == pytest.approx(0.5) for x, y in around)
    corners = [(40.5, 20.5), (159.5, 20.5), (40.5, 79.5), (159.5, 79.5)]
    assert sum(min(math.dist(corner, point) for point in around) < 1 for corner in corners) >= 2
    assert min(math.dist(one, two) for k, one in enumerate(around) for two in around[:k]) > 30
    assert [y for _, y in around] == sorted(y for _, y in around)
    # A handle has much boundary and is little of the thing: the middle stays in the pan.
    mask[47:53, 160:200] = True
    assert keypoints(Detection("pan", Box(40, 20, 200, 80), 1.0, mask), (200, 100))[0][0] < 104
    # A detector of boxes alone: the box is the mask.
    assert len(keypoints(Detection("slab", Box(40, 20, 160, 80), 1.0), (200, 100))) == 6


def test_tiles_are_lettered_from_the_left_and_numbered_from_the_bottom() -> None:
    grid = Grid(5, 5)
    assert grid.tile("a1", (500, 250)).as_tuple == (0, 200, 100, 250)
    assert grid.tile("e5", (500, 250)).as_tuple == (400, 0, 500, 50)
    with pytest.raises(ValueError, match="tile 'f1' does not exist; valid: a1 to e5"):
        grid.tile("f1", (500, 250))


SUBTASK = {
    "instruction": "put the red circle onto the blue square",
    "object_grasped": "red circle",
    "object_unattached": "blue square",
    "motion_direction": "",
}
MARKS = {
    "reasoning": "", "grasp_keypoint": "P1", "function_keypoint": "", "target_keypoint": "Q1", "pre_contact_tile": "",
    "post_contact_tile": "", "pre_contact_height": "", "post_contact_height": "", "target_angle": 0,
}  # fmt: skip


class Chooser:
    """One subtask, and the marks that a test wants."""

    name = "chooser"

    def __init__(self, marks: Any, subtask: dict[str, Any] = SUBTASK) -> None:
        self.marks, self.subtask = marks, subtask

    def answer(self, request: Request) -> Any:
        if request.contract == "ListSubtasks":
            return {"reasoning": "", "subtasks": [self.subtask]}
        return self.marks


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"grasp_keypoint": "P9"}, "mark 'P9' does not exist; valid: P1 to P6"),
        ({"grasp_keypoint": "P"}, "mark 'P' does not exist"),
        ({"target_keypoint": "the middle"}, "mark 'the middle' does not exist; valid: Q1 to Q6"),
        ({"post_contact_tile": "f7", "post_contact_height": "same"}, "after contact: tile 'f7' does not exist"),
        (
            {"pre_contact_tile": "b2", "pre_contact_height": "low"},
            "height 'low' before contact does not exist; valid: same",
        ),
    ],
)
def test_a_mark_that_is_not_there_is_a_crash_and_is_not_asked_again(
    change: dict[str, Any], said: str, tmp_path: Path
) -> None:
    model = Listening(Chooser({**MARKS, **change}))
    made = decided("moka", photo(tmp_path), model)
    assert isinstance(made, GaveUp)
    assert (made.stage, said in made.reason) == ("crash", True), made.reason
    assert [request.contract for request in model.heard] == ["ListSubtasks", "ChooseMotion"]


def test_an_answer_that_is_none_is_a_crash_and_what_is_not_found_is_none(tmp_path: Path) -> None:
    unreadable = decided("moka", photo(tmp_path), Chooser("P1, I think"))
    assert isinstance(unreadable, GaveUp)
    assert unreadable.stage == "crash"
    assert "the answer to ChooseMotion cannot be read" in unreadable.reason
    absent = decided("moka", photo(tmp_path), Chooser(MARKS, {**SUBTASK, "object_grasped": "green star"}))
    assert isinstance(absent, GaveUp)
    assert (absent.stage, absent.reason) == ("grounding", "the detector finds no green star")


def test_a_crash_is_counted_at_a_stage_of_its_own_in_record_and_page(tmp_path: Path) -> None:
    class Wrong:
        name = "wrong"

        def __init__(self, world: Any) -> None:
            self.model = wt.make_model("simulated:perfect", world=world)

        async def answer(self, request: Request) -> Any:
            made = await self.model.answer(request)  # type: ignore[misc]
            return {**MARKS, "grasp_keypoint": "P77"} if request.contract == "ChooseMotion" else made

    world = wt.make_world("tabletop/visual_manipulation", seed=500)
    trial = wt.rollout(wt.Method(method="moka", model=Wrong(world)), world, out=tmp_path, seed=500)
    world.close()
    assert (trial.outcome, trial.stage) == ("failure", "crash")
    assert read_record(trial.folder)["outcome"]["stage"] == "crash"
    assert trial.page is not None
    assert "P77" in trial.page.read_text(encoding="utf-8")


def test_the_function_keypoint_reaches_the_target_and_the_tool_stands_beside_it_turned(tmp_path: Path) -> None:
    seen = photo(tmp_path)
    model = Listening(Chooser({**MARKS, "function_keypoint": "P2", "target_angle": 90}))
    made = decided("moka", seen, model)
    assert isinstance(made, Act)
    assert made.plan is not None
    view = model.heard[1].pictures[0]
    held, other = view.mark(Candidates)
    points = [view.frame.point_to_view(point) for point in (held.at(1), held.at(2), other.at(1))]
    (gx, gy), (fx, fy), (tx, ty) = points
    # A quarter clockwise turns right into down.
    want = (tx - (gy - fy), ty + (gx - fx))
    assert made.plan.grounded["T2"].points["place"] == pytest.approx(want)
    assert made.actions[0].step.rotate_deg == 90


def test_waypoints_lie_in_their_tiles_off_things_and_are_drawn_alike_for_the_same_scene(tmp_path: Path) -> None:
    seen = photo(tmp_path)
    marks = {**MARKS, "target_keypoint": "", "post_contact_tile": "b2", "post_contact_height": "same"}
    first, second = (decided("moka", seen, Chooser(marks)) for _ in range(2))
    assert isinstance(first, Act)
    assert isinstance(second, Act)
    point = first.actions[0].sources[1].point_px
    assert point == second.actions[0].sources[1].point_px
    assert Grid(5, 5).tile("b2", seen.observation.main.size_px).contains(point)


def test_an_arm_passes_the_tiles_and_a_tool_without_a_grasp_sweeps(tmp_path: Path) -> None:
    seen = photo(tmp_path)
    tiles = {
        "pre_contact_tile": "a4",
        "post_contact_tile": "d2",
        "pre_contact_height": "above",
        "post_contact_height": "same",
    }
    armed = decided("moka", replace(seen, vocabulary=ARM), Chooser({**MARKS, **tiles, "function_keypoint": "P1"}))
    assert isinstance(armed, Act)
    assert [action.step.kind for action in armed.actions][:3] == ["move", "move", "close"]
    assert [action.step.kind for action in armed.actions][-2:] == ["open", "move"]
    swept = {**MARKS, **tiles, "grasp_keypoint": "", "pre_contact_height": "same"}
    pushed = decided("moka", replace(seen, vocabulary=VOCABULARIES["push"]), Chooser(swept))
    assert isinstance(pushed, Act)
    assert [action.step.kind for action in pushed.actions] == ["push", "push"]


@pytest.mark.parametrize("model", ["simulated:perfect", "offline"])
def test_a_turn_where_a_thing_stands(model: str, tmp_path: Path) -> None:
    trial = run("moka", "rotate", tmp_path, model=model, seed=501)
    assert trial.outcome == "success"
    assert marked(trial)["answer"]["parsed"]["target_angle"] == 90
    assert marked(trial)["answer"]["parsed"]["target_keypoint"] == ""


def test_what_an_earlier_subtask_does_is_told_where_the_picture_does_not_show_it(tmp_path: Path) -> None:
    trial = run("moka", "same_shape", tmp_path, seed=911)
    first, second = (words(one) for one in requests(trial) if one["contract"] == "ChooseMotion")
    assert "Done before it" not in first
    assert "Done before it, which the picture does not show yet:" in second
    assert "(ends at Q1 of yellow and blue polka dot frame)" in second


def test_offline_refuses_by_name_what_is_no_thing(tmp_path: Path) -> None:
    said = "put the red circle to the left of the blue square"
    made = decided("moka", replace(photo(tmp_path), instruction=Instruction(said)))
    assert isinstance(made, GaveUp)
    assert "model 'offline' chooses marks for what is carried onto another thing" in made.reason
