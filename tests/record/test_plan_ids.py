"""The plan's id is over everything that is read or run; a plan file is data of unknown origin."""

from __future__ import annotations

import copy
import json
from dataclasses import replace

import numpy as np
import pytest

from tests.record.test_plan_file import rich_plan
from tests.runtime.runtime_fakes import SquaresWorld, make_plan
from wonderful_team.core.geometry import Box
from wonderful_team.core.values import Critique, Instruction, Subgoal, Target, content_hash
from wonderful_team.errors import ConfigError
from wonderful_team.record import plan_from_json, plan_to_json

NOT_IN_THE_ID = {"provenance"}
"""Who answered: the same plan out of a cache or a replay is the same plan."""
NOT_AS_TEXT = {"time_s", "png"}
"""When the instruction's picture was taken; and its pixels count, not their packing."""


def written(plan):
    return json.loads(json.dumps(plan_to_json(plan)))


def leaves(value, path=()):
    """Every single value of a JSON document, with the way to it."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, (*path, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from leaves(item, (*path, index))
    else:
        yield path, value


def other(value):
    """A value of the same type that is not it; as near as it gets."""
    match value:
        case bool():
            return not value
        case None:
            return "something"
        case int():
            return value + 1
        case float():
            return float(np.nextafter(value, 10.0))
    return f"{value} "


def set_at(data, path, value):
    *way, last = path
    for key in way:
        data = data[key]
    data[last] = value


def test_the_id_is_a_whole_sha_256():
    plan = rich_plan()
    assert len(plan.id) == 64
    assert int(plan.id, 16)
    assert plan.id == rich_plan().id


def test_no_single_value_of_a_plan_file_can_be_changed_unnoticed():
    data = written(rich_plan())
    tried = 0
    for path, value in leaves(data["plan"], ("plan",)):
        if path[-1] in NOT_IN_THE_ID | NOT_AS_TEXT:
            continue
        changed = copy.deepcopy(data)
        set_at(changed, path, other(value))
        with pytest.raises(ConfigError):
            plan_from_json(changed)
        tried += 1
    assert tried > 150


def test_what_is_only_read_counts_too():
    plan = make_plan(SquaresWorld().observe(), [((60.0, 60.0), (200.0, 30.0))])
    grounded = dict(plan.grounded)
    grounded["T1"] = replace(grounded["T1"], box=Box(1, 2, 30, 40))
    changes = [
        {"status": "refused"},
        {"verified": False},
        {"message": "all is well"},
        {"scene_hash": ""},
        {"grounded": grounded},
        {"warnings": ("mind the cable",)},
        {"choices": ("red",)},
        {"questions": (Critique("G1", "collision", "Is it free?", "Yes.", False, "offline"),)},
        {"targets": (Target("T1", "object", "the other square"), *plan.targets[1:])},
        {"subgoals": (Subgoal("G1", "move another square", targets=("T1", "T2")),)},
        {"instruction": Instruction("put it away")},
    ]
    ids = [replace(plan, **change).id for change in changes]
    assert len({plan.id, *ids}) == len(changes) + 1


def test_a_pixel_of_the_instructions_picture_counts():
    plan = rich_plan()
    slot = plan.instruction.slots["red_thing"]
    rgb = slot.views["top"].rgb.copy()
    rgb[3, 3, 2] ^= 1
    view = replace(slot.views["top"], rgb=rgb)
    said = Instruction(plan.instruction.text, {"red_thing": replace(slot, views={"top": view})})
    assert replace(plan, instruction=said).id != plan.id


def test_who_answered_does_not():
    plan = rich_plan()
    doubt = replace(plan.questions[0], provenance="cached")
    assert replace(plan, questions=(doubt,)).id == plan.id


def test_equal_content_has_one_hash():
    assert content_hash({"a": 1, "b": (1.0, np.float64(2))}) == content_hash({"b": [1, 2.0], "a": 1.0})
    assert content_hash(np.array([1.0, 2.0])) == content_hash([1, 2])
    assert content_hash(2**53 + 1) != content_hash(2**53)
    assert content_hash("1") != content_hash(1)
    assert content_hash(True) != content_hash(1)
    with pytest.raises(TypeError, match="no canonical form for object"):
        content_hash(object())


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), 10**400, "0.5", True, None, [], {}])
def test_a_number_is_a_finite_number(bad):
    for path in (("actions", 0, "action", "yaw_rad"), ("actions", 0, "action", "pick_m", 0)):
        data = written(rich_plan())
        set_at(data, ("plan", *path), bad)
        with pytest.raises(ConfigError, match="broken plan|changed after it was written"):
            plan_from_json(data)


def test_odd_documents_are_refused_by_name():
    deep: object = 1.0
    for _ in range(100_000):
        deep = [deep]
    data = written(rich_plan())
    data["plan"]["actions"] = deep
    with pytest.raises(ConfigError, match="broken plan"):
        plan_from_json(data)
    for version in (True, "2", 2.5, None, 3):
        with pytest.raises(ConfigError, match="cannot be read; this release reads 1 and 2"):
            plan_from_json({**written(rich_plan()), "schema_version": version})
    for name in ("", "a" * 64, None, 5, ["x"]):
        with pytest.raises(ConfigError, match="changed after it was written"):
            plan_from_json({**written(rich_plan()), "id": name})


def test_a_plan_of_an_earlier_release_opens_and_goes_by_its_new_id():
    plan = rich_plan()
    data = {**written(plan), "schema_version": 1, "id": plan.short_id()}
    again = plan_from_json(data)
    assert len(data["id"]) == 12
    assert again.id == plan.id
    data["plan"]["actions"][0]["action"]["pick_m"][0] += 0.01
    with pytest.raises(ConfigError, match="changed after it was written"):
        plan_from_json(data)
