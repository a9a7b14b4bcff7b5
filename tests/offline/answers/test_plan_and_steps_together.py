"""Where a plan was not checked by itself, the check of its steps finds what is wrong with the plan too."""

from __future__ import annotations

import pytest

import wonderful_team as wt
from tests.desk import WORDS, draw_desk, read_record
from wonderful_team.models.wrappers import Injecting, Injection
from wonderful_team.offline import OfflineModel


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    return draw_desk(tmp_path_factory.mktemp("desk")) / "desk.png"


def wrong_way_round(plan, _request):
    """The whole plan for the other way round, move and uses included: nothing in it contradicts itself."""
    first, second = plan.targets
    text = f"put {second.words} on {first.words}"
    move = plan.subgoals[0].move
    place = move.place.model_copy(update={"target": first.id})
    swapped = {"text": text, "move": move.model_copy(update={"pick": second.id, "place": place})}
    targets = [
        first.model_copy(update={"use": list(second.use)}),
        second.model_copy(update={"use": list(first.use)}),
    ]
    return plan.model_copy(update={"subgoals": [plan.subgoals[0].model_copy(update=swapped)], "targets": targets})


def planned(desk, out, *faults):
    made = wt.Team(model=Injecting(OfflineModel(), list(faults)), out=out).plan(desk, WORDS)
    return made, [entry["contract"] for entry in read_record(made.folder)["planner"]["requests"]]


def test_a_right_plan_is_approved_in_one_look(desk, tmp_path):
    made, asked = planned(desk, tmp_path)
    assert made.verified, made.message
    assert "ReviewPlan" not in asked


def test_a_plan_for_the_other_way_round_is_found_with_its_steps_and_written_anew(desk, tmp_path):
    made, asked = planned(desk, tmp_path, Injection(("DraftPlan",), wrong_way_round, "the plan is the wrong way round"))
    assert asked.count("RevisePlan") == 1
    assert made.verified
    (question,) = made.plan.questions
    assert (question.about, question.changed) == ("G1", True)
    picked = next(target for target in made.plan.targets if target.id == made.plan.steps[0].pick)
    assert "red circle" in picked.words
