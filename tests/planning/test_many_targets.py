"""Many targets are looked for in several questions of a bounded size, asked at once; few in one."""

from __future__ import annotations

from typing import Any

import pytest

from tests.planning.helpers import asked, plan_with
from tests.planning.stub_model import stub_script
from wonderful_team.core.together import batches
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.planning import Bounds, TeamConfig


class OfFewPictures(ScriptedModel):
    """A model that takes so many pictures in one request."""

    picture_limit = 3


def plan_of_many(count: int, bounds: Bounds, kind: type[ScriptedModel] = ScriptedModel) -> tuple[Any, ScriptedModel]:
    """Every one of `count` things into the last one."""
    script = stub_script()
    before = script["DraftPlan"]

    def draft(request: Any) -> Any:
        plan = before(request)
        one, goal = plan["targets"]
        subgoal = plan["subgoals"][0]
        things = [f"T{number}" for number in range(1, count)]
        goal = {**goal, "id": f"T{count}"}
        plan["targets"] = [*({**one, "id": name, "words": f"thing {name}"} for name in things), goal]
        plan["subgoals"] = [
            {
                **subgoal,
                "id": f"G{number}",
                "targets": [name, goal["id"]],
                "move": {"pick": name, "place": {"target": goal["id"], "how": "at", "side": None}, "rotate_deg": 0},
            }
            for number, name in enumerate(things, 1)
        ]
        return plan

    model = kind({**script, "DraftPlan": draft})
    return plan_with(model, TeamConfig(mode="lean", bounds=bounds)), model


def sizes(model: ScriptedModel, contract: str, field: str) -> list[int]:
    return sorted(len(getattr(request.question, field)) for request in asked(model, contract))


def test_many_targets_are_read_and_judged_in_parts() -> None:
    plan, model = plan_of_many(9, Bounds(targets=4))
    assert sizes(model, "ReadScene", "targets") == [3, 3, 3]
    assert sum(sizes(model, "JudgeBoxes", "boxes")) + len(asked(model, "JudgeBox")) == 9
    assert max(sizes(model, "JudgeBoxes", "boxes"), default=0) <= 4
    assert list(plan.grounded) == [f"T{number}" for number in range(1, 10)]


def test_few_targets_are_read_in_one_question() -> None:
    _, model = plan_of_many(9, Bounds())
    assert sizes(model, "ReadScene", "targets") == [9]


def test_crops_fit_the_pictures_that_the_model_takes() -> None:
    _, many = plan_of_many(9, Bounds())
    _, few = plan_of_many(9, Bounds(), OfFewPictures)
    assert sum(sizes(few, "JudgeBoxes", "boxes")) == sum(sizes(many, "JudgeBoxes", "boxes"))
    assert max(sizes(few, "JudgeBoxes", "boxes")) <= 3 < max(sizes(many, "JudgeBoxes", "boxes"))


@pytest.mark.parametrize(
    ("count", "most", "parts"), [(0, 4, []), (4, 4, [4]), (5, 4, [2, 3]), (9, 4, [3, 3, 3]), (3, 0, [1, 1, 1])]
)
def test_parts_are_few_and_alike(count: int, most: int, parts: list[int]) -> None:
    items = list(range(count))
    cut = list(batches(items, most))
    assert [len(part) for part in cut] == parts
    assert [item for part in cut for item in part] == items
