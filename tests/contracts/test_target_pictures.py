"""What targets say of the instruction's pictures: names in any form, what is alike, and scenes for places only."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

from tests.agents.question_samples import picture
from tests.planning.helpers import photo
from wonderful_team.agents.rendering import target_words
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import DraftPlan, ExtractTargets, PlanDraft, RevisePlan, ShownSlot, ShownTask, TargetDraft
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.values import NO_WORKSPACE, Critique, Instruction, Plan, Slot, Subgoal, Target
from wonderful_team.record.plan_file import plan_from_json, plan_to_json

TASK = ShownTask(
    "Put {dragged_obj_1} where {scene_1} has it.",
    (picture("top view"),),
    (
        ShownSlot("dragged_obj_1", "object", (picture("{dragged_obj_1} top"),)),
        ShownSlot("scene_1", "scene", (picture("{scene_1} top"),)),
    ),
)


def drafted(kind: str, like: list[str], words: str = "block", where: str = "") -> dict[str, Any]:
    target = {
        "id": "T1",
        "kind": kind,
        "words": words,
        "part": None,
        "where": where,
        "like": like,
        "alike": "both",
        "use": ["place"],
    }
    subgoal = {"id": "G1", "text": "do it", "after": [], "targets": ["T1"], "function": None}
    return {
        "reasoning": "",
        "subgoals": [subgoal],
        "targets": [target],
        "mode": "one_step",
        "clarification": None,
    }


def settled(draft: dict[str, Any]) -> tuple[TargetDraft, tuple[str, ...]]:
    answer, repairs = DraftPlan(TASK, ("pick_place",), True).validate(PlanDraft.model_validate(draft))
    return answer.targets[0], repairs


@pytest.mark.parametrize("written", ["dragged_obj_1", "{dragged_obj_1}", "{dragged_obj_1} top", "dragged_obj_1 top"])
def test_a_picture_may_be_named_as_words_and_captions_name_it(written: str) -> None:
    target, _ = settled(drafted("object", [written]))
    assert target.like == ["dragged_obj_1"]


def test_a_name_that_no_picture_has_is_refused_with_those_that_are_there() -> None:
    with pytest.raises(ValueError, match=r"unknown picture in 'like' of T1 'bowl'; valid: dragged_obj_1, scene_1"):
        settled(drafted("object", ["bowl"]))


def test_a_whole_scene_describes_no_object() -> None:
    target, repairs = settled(drafted("object", ["{scene_1}", "dragged_obj_1"]))
    assert target.like == ["dragged_obj_1"]
    assert "scene_1 dropped, a whole scene describes no object" in repairs[0]


def test_a_place_gets_the_scene_that_its_words_speak_of() -> None:
    target, _ = settled(drafted("area", [], "where the block lies in {scene_1}"))
    assert target.like == ["scene_1"]
    assert target.to_target().source == "slot"
    assert "defined by {scene_1}" in target_words(target.to_target())


def test_revisions_and_extracted_targets_are_settled_alike() -> None:
    plan = drafted("object", ["{scene_1}"])
    doubt = Critique("G1", "ambiguity", "which?")
    revise = RevisePlan(TASK, ("pick_place",), (), (), doubt, True)
    revision = {"reasoning": "", "decision": "revise", "answer": "yes", "plan": plan}
    answer, repairs = revise.validate(revise.output().model_validate(revision))
    assert (answer.plan.targets[0].like, len(repairs)) == ([], 1)
    extract = ExtractTargets(TASK, (Subgoal("G1", "do it"),))
    said = {"reasoning": "", "targets": plan["targets"], "needs": [{"subgoal": "G1", "targets": ["T1"]}]}
    answer, repairs = extract.validate(extract.output().model_validate(said))
    assert (answer.targets[0].like, len(repairs)) == ([], 1)


def test_a_place_that_names_no_scene_is_found_with_all_of_them_and_an_object_with_none() -> None:
    view = photo().main
    slots = {
        "obj": Slot("obj", "object", {"top": replace(view, id="slot:obj:top")}),
        "goal": Slot("goal", "scene", {"top": replace(view, id="slot:goal:top")}),
        "frame": Slot("frame", "frame", {"top": replace(view, id="slot:frame:top")}, 1),
    }
    scene = SceneShown(photo(), Instruction("like {goal}, then {frame}, with {obj}", slots), PICK_PLACE, NO_WORKSPACE)

    def names(target: Target) -> list[str]:
        return [slot.name for slot in scene.examples([target])]

    assert names(Target("T1", "area", "its final spot")) == ["goal", "frame"]
    assert names(Target("T1", "area", "its place in {goal}", like=("goal",))) == ["goal"]
    assert names(Target("T1", "object", "block", like=("obj",))) == ["obj"]
    assert names(Target("T1", "object", "block")) == []


def test_what_is_alike_is_said_in_words() -> None:
    target = Target("T1", "object", "any object", like=("base",), alike="surface")
    assert "has the surface (colour and pattern) of {base}; its shape does not count" in target_words(target)
    assert "has the shape of {base}; its surface does not count" in target_words(replace(target, alike="shape"))
    assert "looks like {base}" in target_words(replace(target, alike="both"))


def test_an_answer_without_what_is_alike_is_read_and_a_model_is_asked_for_it() -> None:
    draft = drafted("object", ["dragged_obj_1"])
    del draft["targets"][0]["alike"]
    assert settled(draft)[0].alike == "both"
    assert "alike" in TargetDraft.model_json_schema()["required"]
    assert "default" not in json.dumps(TargetDraft.model_json_schema())


def test_a_plan_file_of_an_earlier_release_opens_with_its_id() -> None:
    plan = Plan(Instruction("put it there"), "planned", targets=(Target("T1", "object", "block"),))
    data = json.loads(json.dumps(plan_to_json(plan)))
    del data["plan"]["targets"][0]["alike"]
    assert plan_from_json(data).id == plan.id
    other = replace(plan, targets=(Target("T1", "object", "block", alike="shape"),))
    assert other.id != plan.id
    assert plan_from_json(json.loads(json.dumps(plan_to_json(other)))).targets[0].alike == "shape"
