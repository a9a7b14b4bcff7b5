"""`tg`: no picture for its planner, a detector by name, programs in the sandbox, and success judged from boxes."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import wonderful_team as wt
from tests.desk import read_record
from tests.planning.baselines.runs import Listening, contracts, decided, photo, pictures, requests, run, words
from wonderful_team.core.protocols import Act, GaveUp
from wonderful_team.core.values import Instruction, Request
from wonderful_team.planning.baselines.tg import ROUNDS


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """One trial of one attempt."""
    return run("tg", "visual_manipulation", tmp_path_factory.mktemp("tg"))


def stages(trial: Any, name: str) -> list[str]:
    return [entry["text"] for entry in read_record(trial.folder)["planner"]["stages"] if entry["name"] == name]


def test_it_looks_first_and_writes_the_motions_in_a_second_program(trial: Any) -> None:
    assert trial.outcome == "success"
    assert contracts(trial) == ["DescribePictures", "WriteProgram", "WriteProgram"]
    first, second = (request["answer"]["parsed"]["code"] for request in requests(trial)[1:])
    assert "detect_object(name)" in first
    assert "execute_trajectory" not in first
    for function in ("execute_trajectory", "close_gripper()", "open_gripper()", "task_completed()"):
        assert function in second


def test_its_planner_is_shown_no_picture_and_the_describer_never_the_scene(trial: Any) -> None:
    asked = requests(trial)
    assert [bool(pictures(request)) for request in asked] == [True, False, False]
    assert all("view" not in part["picture"] for request in asked for part in pictures(request))


def test_programs_ran_in_the_sandbox_and_what_they_printed_came_back(trial: Any) -> None:
    assert stages(trial, "program") == [
        "program 1 ran in the sandbox: 0 motions",
        "program 2 ran in the sandbox: 7 motions, task completed",
    ]
    looks = read_record(trial.folder)["planner"]["detections"]
    assert [entry["words"] for entry in looks] == [["pink letter R"], ["red paisley pan"]]
    told = words(requests(trial)[2])
    assert "1 found: pink letter R [{'x': 997" in told
    assert "'height_cm': 3.4" in told


def test_the_points_of_the_plan_are_the_middles_of_the_boxes(trial: Any) -> None:
    looks = read_record(trial.folder)["planner"]["detections"]
    for entry, target, role in zip(looks, ("T1", "T2"), ("pick", "place"), strict=True):
        x0, y0, x1, y1 = entry["found"][0]["box"]
        point = trial.plans[0].grounded[target].points[role]
        # The program was told whole pixels of a picture of twice the view's size.
        assert math.dist(point, ((x0 + x1) / 2, (y0 + y1) / 2)) < 1.0


@pytest.mark.parametrize("model", ["simulated:perfect", "offline"])
def test_with_replans_it_judges_from_boxes_before_and_after(model: str, tmp_path: Path) -> None:
    world = wt.make_world("tabletop/rotate", seed=501)
    trial = wt.rollout(wt.Method(method="tg", model=model), world, out=tmp_path, seed=501, replans=1)
    world.close()
    assert trial.outcome == "success"
    assert contracts(trial) == ["DescribePictures", "WriteProgram", "WriteProgram", "JudgeFromBoxes"]
    judged = requests(trial)[-1]
    assert pictures(judged) == []
    assert "Found before the motions" in words(judged)
    assert stages(trial, "judge") == ["task completed"]


def test_a_failed_task_is_tried_anew_with_a_summary_and_no_more_often_than_allowed(tmp_path: Path) -> None:
    class Unhappy:
        name = "unhappy"

        def __init__(self, world: Any) -> None:
            self.model = wt.make_model("simulated:perfect", world=world)

        async def answer(self, request: Request) -> Any:
            if request.contract != "JudgeFromBoxes":
                return await self.model.answer(request)  # type: ignore[misc]
            return {"reasoning": "", "completed": False, "summary": "the letter slid off"}

    world = wt.make_world("tabletop/visual_manipulation", seed=500)
    model = Listening(Unhappy(world))
    trial = wt.rollout(wt.Method(method="tg", model=model), world, out=tmp_path, seed=500, replans=1)
    world.close()
    asked = [request.contract for request in model.heard]
    # The second program finds the task done already; nothing moves, and nothing is judged again.
    assert asked.count("JudgeFromBoxes") == 1
    again = next(request for request in model.heard if request.id.startswith("1/"))
    said = "\n".join(getattr(part, "text", "") for part in again.parts)
    assert "The last attempt failed: the letter slid off" in said
    assert trial.plans


class Coder:
    """Writes the same programs over and over."""

    name = "coder"

    def __init__(self, *codes: str) -> None:
        self.codes, self.asked = list(codes), 0

    def answer(self, request: Request) -> Any:
        self.asked += 1
        return {"reasoning": "", "code": self.codes[min(self.asked, len(self.codes)) - 1]}


PICK = (
    "t = detect_object('red circle')[0]\np = (t['x'], t['y'])\n"
    "execute_trajectory([(*p, 20, 0), (*p, 0, 0)])\nclose_gripper()\n"
)
PLACE = "execute_trajectory([(*p, 20, 0), (p[0] + 60, p[1], 20, 45), (p[0] + 60, p[1], 1, 45)])\nopen_gripper()\n"


def test_a_program_that_fails_moves_nothing_and_its_error_goes_back(tmp_path: Path) -> None:
    model = Listening(Coder("execute_trajectory([(1, 2)])", f"{PICK}1 / 0", f"{PICK}{PLACE}task_completed()"))
    made = decided("tg", photo(tmp_path), model)
    assert isinstance(made, Act)
    assert [type(action.step).__name__ for action in made.actions] == ["PickPlaceStep"]
    assert made.actions[0].step.rotate_deg == 45
    said = "\n".join(getattr(part, "text", "") for part in model.heard[-1].parts)
    assert "error: execute_trajectory: pose 1 must be (x, y, z, angle)" in said
    assert "ZeroDivisionError" in said


@pytest.mark.parametrize(
    ("code", "stage", "reason"),
    [
        ("1 / 0", "crash", "ZeroDivisionError"),
        ("print('hm')", "plan", f"no program completed the task in {ROUNDS} turns"),
        ("print('error: hm')", "plan", f"no program completed the task in {ROUNDS} turns"),
        ("print('\\x1d[\"execute_trajectory\", []]')", "crash", "gives execute_trajectory(points) 0 values"),
        ("print('\\x1d[\"detect_object\", [1, 2]]')", "crash", "gives detect_object(name) 2 values"),
        (f"{PICK}task_completed()", "plan", "closes on something and never opens again"),
        ("task_completed()", "", "nothing to do"),
        ("execute_trajectory([(9, 9, 0, 0)])\ntask_completed()", "plan", "the motions never close the gripper"),
        ("execute_trajectory([(9000, 9, 0, 0)])\ntask_completed()", "crash", "outside of the view, which spans x 0 to"),
        ("detect_object('zorkmid')", "crash", "I do not know: zorkmid"),
    ],
)
def test_what_comes_to_no_plan_ends_at_its_stage(code: str, stage: str, reason: str, tmp_path: Path) -> None:
    model = Listening(Coder(code))
    made = decided("tg", photo(tmp_path), model)
    if not stage:
        assert not isinstance(made, GaveUp)
        return
    assert isinstance(made, GaveUp)
    assert made.stage == stage
    assert reason in made.reason
    assert len(model.heard) == (ROUNDS if "turns" in made.reason else 1)


def test_an_arm_goes_through_every_pose_and_a_tool_that_pushes_along_the_surface(tmp_path: Path) -> None:
    from wonderful_team.core.actions import ARM, VOCABULARIES

    code = f"{PICK}{PLACE}task_completed()"
    seen = photo(tmp_path)
    made = decided("tg", replace(seen, vocabulary=ARM), Coder(code))
    assert isinstance(made, Act)
    kinds = [action.step.kind for action in made.actions]
    assert kinds == ["move", "move", "close", "move", "rotate_gripper", "move", "move", "open"]
    sweep = "execute_trajectory([(100, 100, 20, 0), (100, 100, 0, 0), (300, 100, 0, 0), (300, 100, 20, 0)])\ntask_completed()"
    pushed = decided("tg", replace(seen, vocabulary=VOCABULARIES["push"]), Coder(sweep))
    assert isinstance(pushed, Act)
    assert [action.step.kind for action in pushed.actions] == ["push"]


def test_offline_refuses_by_name_what_needs_eyes(tmp_path: Path) -> None:
    words = "put the red circle to the left of the blue square"
    made = decided("tg", replace(photo(tmp_path), instruction=Instruction(words)))
    assert isinstance(made, GaveUp)
    assert (
        "writes programs for things that are put into or onto others, put back, or turned; not for this" in made.reason
    )


def test_what_the_detector_does_not_find_ends_it_at_grounding(tmp_path: Path) -> None:
    made = decided("tg", replace(photo(tmp_path), instruction=Instruction("put the green star onto the blue square")))
    assert isinstance(made, GaveUp)
    assert (made.stage, made.reason) == ("grounding", "the detector finds no green star")


@pytest.mark.parametrize("name", ["tg", "moka", "instruct2act"])
def test_several_things_that_are_put_on_one_lie_on_each_other(name: str, tmp_path: Path) -> None:
    trial = run(name, "manipulate_old_neighbor", tmp_path, seed=1000)
    assert trial.outcome == "success"
    first, second = (action.step.place.target for action in trial.plans[0].actions[:2])
    assert first == second
