"""A plan survives its file whole; anything else is refused with a reason."""

from __future__ import annotations

import json

import numpy as np
import pytest

from tests.record.rich_plans import rich_plan
from wonderful_team.errors import ConfigError
from wonderful_team.record import plan_from_json, plan_to_json, read_plan


def test_round_trip_through_text_keeps_everything():
    plan = rich_plan()
    again = plan_from_json(json.loads(json.dumps(plan_to_json(plan))))
    assert again.id == plan.id
    assert again.steps == plan.steps
    assert [item.sources for item in again.actions] == [item.sources for item in plan.actions]
    assert np.allclose(again.actions[1].action.pose.quaternion_wxyz, plan.actions[1].action.pose.quaternion_wxyz)
    assert again.keep_out == plan.keep_out
    assert (again.parent, again.choices, again.first_draft) == (plan.parent, plan.choices, plan.first_draft)
    assert again.grounded["T1"].history == plan.grounded["T1"].history
    assert again.subgoals == plan.subgoals
    assert again.questions == plan.questions
    before, after = (p.instruction.slots["red_thing"].views["top"] for p in (plan, again))
    assert np.array_equal(before.rgb, after.rgb)


def test_a_file_can_be_named_by_its_run_folder(tmp_path):
    plan = rich_plan()
    (tmp_path / "plan.json").write_text(json.dumps(plan_to_json(plan)), encoding="utf-8")
    assert read_plan(tmp_path).id == read_plan(tmp_path / "plan.json").id == plan.id


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.update(schema_version=0), r"schema version 0 cannot be read; this release reads 1 and 2"),
        (lambda d: d.update(format="coco"), r"not a plan file \(found format 'coco'"),
        (lambda d: d["plan"]["actions"][0]["action"]["pick_m"].__setitem__(0, 0.3), "changed after it was written"),
        (lambda d: d["plan"].pop("steps"), r"Plan lacks \['steps'\]"),
        (lambda d: d["plan"].update(extra=1), r"unknown \['extra'\]"),
        (lambda d: d["plan"].update(mode="twice"), r"mode: expected one of 'full', 'one_step', got 'twice'"),
        (lambda d: d["plan"]["steps"][0].update(type="Jump"), r"steps\[0\]: unknown type 'Jump'; valid: PickPlaceStep"),
        (lambda d: d["plan"]["actions"][0]["action"].update(pick_m="left"), "expected a list of numbers, got 'left'"),
    ],
)
def test_wrong_files_are_refused_with_the_reason(change, message):
    data = json.loads(json.dumps(plan_to_json(rich_plan())))
    change(data)
    with pytest.raises(ConfigError, match=message):
        plan_from_json(data)


def test_missing_and_foreign_files(tmp_path):
    with pytest.raises(ConfigError, match="no plan to read"):
        read_plan(tmp_path)
    (tmp_path / "plan.json").write_text("nonsense", encoding="utf-8")
    with pytest.raises(ConfigError, match="not JSON"):
        read_plan(tmp_path)
    with pytest.raises(ConfigError, match="found a list"):
        plan_from_json([])
