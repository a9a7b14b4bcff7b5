"""Grounding by something else than the team: one model call, or a detector. Nothing is asked of Checker and Mover; the record says who."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from tests.planning.helpers import APPROVED, Tape, asked, draft, one_step_each, scripted, subgoal
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.caps import Caps
from wonderful_team.core.geometry import Box
from wonderful_team.core.values import Detection, DetectorRun, Instruction, Observation, Plan, Target, View
from wonderful_team.errors import ConfigError, DetectorCodeError, NotUnderstoodError, UnknownNameError
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.planning.replaced import phrase_of

RGB = np.full((480, 640, 3), 120, np.uint8)
FIRST, SECOND = "the first thing", "the second thing"
GROUNDING_TEAM = {
    "JudgeBox",
    "JudgeBoxes",
    "JudgeRevision",
    "Presence",
    "MoveBox",
    "ChooseMark",
    "ChoosePoint",
    "GiveBox",
}


class Finding:
    """A detector that finds what it is told to, and keeps what it was asked for."""

    name = "finding"

    def __init__(self, *found: Detection) -> None:
        self.found, self.asked = found, list[tuple[str, ...]]()

    def detect(self, rgb: np.ndarray, words: Sequence[str]) -> list[Detection]:
        assert np.array_equal(rgb, RGB), "the clean main view, in its own pixels"
        self.asked.append(tuple(words))
        return [one for one in self.found if one.words in words]


def box(words: str, x0: float, y0: float, score: float = 0.5, side: float = 40) -> Detection:
    return Detection(words, Box(x0, y0, x0 + side, y0 + side), score)


def plan_by(
    detector: Any, model: Any = None, grounding: Any = "detector", tape: Tape | None = None, **options: Any
) -> Plan:
    team = TeamPolicy(
        model or scripted(DraftPlan=draft(subgoal("G1")), WriteSteps=one_step_each),
        TeamConfig(grounding=grounding),
        subscribers=[tape] if tape else (),
        detector=detector,
        **options,
    )
    scene = Observation({"top": View("top", "top", 0.0, RGB)})
    return asyncio.run(team.make_plan(scene, Instruction("put the first thing into the second thing"), PICK_PLACE))


def test_the_surest_box_of_a_detector_becomes_target_and_points() -> None:
    model = scripted(DraftPlan=draft(subgoal("G1")), WriteSteps=one_step_each)
    detector, tape = Finding(box(FIRST, 50, 60, 0.4), box(FIRST, 200, 100, 0.9), box(SECOND, 400, 300)), Tape()
    plan = plan_by(detector, model, tape=tape)
    assert plan.status == "planned", plan.message
    assert detector.asked == [(FIRST, SECOND)], "one look for all things"
    first, second = plan.grounded["T1"], plan.grounded["T2"]
    assert (first.box, dict(first.points)) == (Box(200, 100, 240, 140), {"pick": (220, 120)})
    assert dict(second.points) == {"place": (420, 320)}
    assert [event.provenance for event in first.history] == ["detector"]
    assert "finding: 'the first thing' with score 0.90, of 2 found" in first.history[0].text
    contracts = {request.contract for request in model.requests}
    assert not contracts & {*GROUNDING_TEAM, "ReadScene", "LocatePoints"}
    assert "ReviewSteps" in contracts, "Verification is the team's"
    (run,) = [event.content for event in tape.kinds("detector")]
    assert isinstance(run, DetectorRun)
    assert (run.words, len(run.found)) == ((FIRST, SECOND), 3)


def test_what_no_detector_finds_goes_back_to_the_supervisor_and_ends_as_not_found() -> None:
    model = scripted(DraftPlan=draft(subgoal("G1")), WriteSteps=one_step_each)
    plan = plan_by(Finding(box(FIRST, 50, 60)), model)
    assert plan.status == "not_found"
    assert "T2" in plan.message
    assert plan.grounded["T2"].history[-1].text == "finding: 'the second thing': nothing found"
    assert len(asked(model, "DraftPlan")) == 2, "asked anew with what was not found"


def test_two_targets_in_the_same_words_get_different_things() -> None:
    model = scripted(DraftPlan=draft(subgoal("G1"), words=SECOND), WriteSteps=one_step_each)
    near = Detection(SECOND, Box(102, 102, 142, 142), 0.8)
    plan = plan_by(Finding(box(SECOND, 100, 100, 0.9), near, box(SECOND, 300, 300, 0.4)), model)
    assert [plan.grounded[name].box for name in ("T1", "T2")] == [Box(100, 100, 140, 140), Box(300, 300, 340, 340)]


def test_places_are_asked_of_the_model_in_one_call_and_the_run_says_so() -> None:
    drafted = draft(subgoal("G1"))
    drafted["targets"][1] |= {"kind": "area", "words": "free space beside the first thing"}
    model, tape = scripted(DraftPlan=drafted, WriteSteps=one_step_each), Tape()
    detector = Finding(box(FIRST, 50, 60))
    plan = plan_by(detector, model, tape=tape)
    assert plan.status == "planned", plan.message
    assert detector.asked == [(FIRST,)]
    (question,) = [request.question for request in asked(model, "ReadScene")]
    assert [target.id for target in question.targets] == ["T2"]
    (told,) = [event.content["text"] for event in tape.kinds("stage") if event.name == "places"]
    assert told == "T2: a detector finds things, not places; asked of the model in one call"


def test_what_only_a_picture_shows_is_not_found_and_says_why() -> None:
    plan = plan_by(Finding(box(SECOND, 50, 60)), scripted(DraftPlan=draft(subgoal("G1"), words="the thing in {cup}")))
    assert plan.status == "not_found"
    assert "points to a picture, and a detector reads words alone" in plan.grounded["T1"].history[-1].text


def test_a_doubted_point_makes_way_for_the_next_box() -> None:
    doubts = iter([{"about": "T1", "kind": "wrong_point", "question": "that is another thing"}])

    def review(request: Any) -> dict[str, Any]:
        doubt = next(doubts, None)
        return APPROVED if doubt is None else {"reasoning": "", "approved": False, "doubt": doubt}

    model = scripted(DraftPlan=draft(subgoal("G1")), WriteSteps=one_step_each, ReviewSteps=review)
    detector = Finding(box(FIRST, 50, 60, 0.4), box(FIRST, 200, 100, 0.9), box(SECOND, 400, 300))
    plan = plan_by(detector, model)
    assert plan.grounded["T1"].box == Box(50, 60, 90, 100)
    assert detector.asked[1:] == [(FIRST,)]


class Choosy(Finding):
    """Refuses words that it does not know."""

    def detect(self, rgb: np.ndarray, words: Sequence[str]) -> list[Detection]:
        unknown = [text for text in words if text not in (FIRST, SECOND)]
        if unknown:
            raise NotUnderstoodError(f"I do not know: {unknown[0]}", stage="grounding")
        return super().detect(rgb, words)


def test_a_thing_whose_part_is_left_out_is_looked_for_anew() -> None:
    whole = draft(subgoal("G1"))
    part = {**whole, "targets": [whole["targets"][0] | {"part": "its lid"}, *whole["targets"][1:]]}
    model = scripted(DraftPlan=[part, whole], WriteSteps=one_step_each)
    assert plan_by(Finding(box(FIRST, 50, 60), box(SECOND, 400, 300)), model).status == "planned"


def test_words_that_a_detector_refuses_leave_the_others_found_and_go_back_to_the_supervisor() -> None:
    drafts = iter([draft(subgoal("G1"), words="gizmo"), draft(subgoal("G1"))])
    model = scripted(DraftPlan=lambda request: next(drafts), WriteSteps=one_step_each)
    tape = Tape()
    plan = plan_by(Choosy(box(FIRST, 50, 60), box(SECOND, 400, 300)), model, tape=tape)
    assert plan.status == "planned", plan.message
    assert "T1 (gizmo) was not found in the picture: I do not know: gizmo." in tape.warnings
    assert asked(model, "DraftPlan")[1].question.advice[0].endswith("I do not know: gizmo."), (
        "who names it anew is told why"
    )
    looks = [event.content for event in tape.kinds("detector")]
    assert [(run.words, run.refused) for run in looks] == [
        (("gizmo", SECOND), "I do not know: gizmo"),
        (("gizmo",), "I do not know: gizmo"),
        ((SECOND,), ""),
        ((FIRST, SECOND), ""),
    ]


def test_where_a_detector_refuses_every_word_planning_ends_as_not_understood_at_grounding() -> None:
    drafted = draft(subgoal("G1"), words="gizmo")
    drafted["targets"][1]["words"] = "widget"
    plan = plan_by(Choosy(), scripted(DraftPlan=drafted))
    assert (plan.status, plan.stage) == ("not_understood", "grounding")
    assert plan.message == "I do not know: gizmo"


@pytest.mark.parametrize(
    ("target", "phrase"),
    [
        (Target("T1", "object", "red mug"), "red mug"),
        (Target("T1", "object", "red mug", part="handle"), "handle of red mug"),
        (Target("T1", "object", "red mug", where="left of the bowl"), "red mug, left of the bowl"),
    ],
)
def test_a_detector_is_told_all_that_the_plan_says_in_words(target: Target, phrase: str) -> None:
    assert phrase_of(target) == phrase


def test_one_call_gives_all_boxes_and_points_and_they_stand() -> None:
    model, tape = scripted(DraftPlan=draft(subgoal("G1")), WriteSteps=one_step_each), Tape()
    plan = plan_by(None, model, "one_call", tape)
    assert plan.status == "planned", plan.message
    grounding = [request for request in model.requests if request.stage == "ground"]
    assert [(request.contract, request.role) for request in grounding] == [("ReadScene", "manager")]
    assert all("one call" in item.history[0].text for item in plan.grounded.values())
    assert not {request.role for request in model.requests} & {"checker", "mover"}


def test_a_doubted_point_of_one_call_is_asked_anew_with_what_was_wrong_marked() -> None:
    doubts = iter([{"about": "T1", "kind": "wrong_point", "question": "that is another thing"}])

    def review(request: Any) -> dict[str, Any]:
        doubt = next(doubts, None)
        return APPROVED if doubt is None else {"reasoning": "", "approved": False, "doubt": doubt}

    model = scripted(DraftPlan=draft(subgoal("G1")), WriteSteps=one_step_each, ReviewSteps=review)
    plan = plan_by(None, model, "one_call")
    assert plan.status == "planned", plan.message
    (request,) = asked(model, "LocatePoints")
    assert request.role == "manager"
    assert "that is another thing" in request.question.rejected[0]


def test_what_is_pushed_starts_on_the_side_away_from_its_goal() -> None:
    drafted = draft(subgoal("G1"))
    drafted["targets"][0]["use"] = ["push_start"]
    drafted["targets"][1]["use"] = ["push_end"]
    push = {"subgoal": "G1", "kind": "push", "start": "T1", "end": {"target": "T2", "how": "at", "side": None}}
    model = scripted(DraftPlan=drafted, WriteSteps={"reasoning": "", "steps": [push]})
    plan = plan_by(Finding(box(FIRST, 300, 300), box(SECOND, 500, 300)), model)
    x, y = plan.grounded["T1"].points["push_start"]
    assert x < 300
    assert y == pytest.approx(320)
    assert dict(plan.grounded["T2"].points) == {"push_end": (520, 320)}


def test_a_broken_detector_is_not_the_methods_failure() -> None:
    class Broken(Finding):
        def detect(self, rgb: np.ndarray, words: Sequence[str]) -> list[Detection]:
            raise OSError("out of memory")

    with pytest.raises(DetectorCodeError, match="detector 'finding' raised OSError: out of memory"):
        plan_by(Broken())


def test_a_detector_is_under_the_cap_on_seconds() -> None:
    class Slow(Finding):
        async def detect(self, rgb: np.ndarray, words: Sequence[str]) -> list[Detection]:  # type: ignore[override]
            await asyncio.Event().wait()
            return []

    plan = plan_by(Slow(), caps=Caps(seconds=1.0))
    assert plan.status == "budget"
    assert "detector 'finding'" in plan.message or "DraftPlan" in plan.message


def test_settings_that_do_not_go_together_are_refused() -> None:
    with pytest.raises(ConfigError, match="needs a detector: anything with a name and detect"):
        plan_by(None)
    with pytest.raises(ConfigError, match="setting 's4' switches some of them off"):
        TeamConfig(grounding="detector", ablation="s4")
    with pytest.raises(UnknownNameError, match="unknown grounding 'owl'"):
        TeamConfig(grounding="owl")  # type: ignore[arg-type]
    assert TeamConfig(grounding="one_call", ablation="s8").name == "single-call-grounding:s8"
    assert [TeamConfig(ablation=name).grounded_by for name in ("full", "s6", "s7")] == [
        "team",
        "supervisor",
        "supervisor",
    ]
