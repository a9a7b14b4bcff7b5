"""Whatever JSON a model writes, a contract makes a valid answer of it or raises ValueError, whose text goes back to the model."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.contracts.right_answers import QUESTION, RIGHT, judged
from tests.damage import damaged_json
from wonderful_team.contracts import QUESTIONS, AnswerModel, PlanDraft, PointPx
from wonderful_team.contracts.shown import BoxPx
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Picture

EVERY = pytest.mark.parametrize("contract", [question.__name__ for question in QUESTIONS])
NAMES = sorted({name for question in QUESTION.values() for name in question.output().model_fields} | {"x", "{id}"})
LEAVES = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8), st.sampled_from(["G1", "T7", "left", "{}"])
)  # fmt: skip
ANY = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(NAMES), inner, max_size=4),
    max_leaves=12,
)
HURRY = settings(max_examples=60, derandomize=True, deadline=None, database=None)


def shown_picture(question: Any) -> Picture | None:
    """The picture that points and boxes of the answer are pixels of."""
    return getattr(question, "view", None)


def check(contract: str, said: Any) -> None:
    """Any other error than ValueError fails the test."""
    try:
        answer, _ = judged(QUESTION[contract], said)
    except ValueError:
        return
    check_valid(contract, answer)


def check_valid(contract: str, answer: AnswerModel) -> None:
    """What those who use a valid answer rely on."""
    question = QUESTION[contract]
    again, repairs = question.validate(answer)
    assert (again, repairs) == (answer, ()), "a valid answer is left as it is"
    picture, said = shown_picture(question), [answer]
    while said:
        one: Any = said.pop()
        match one:
            case PointPx() if picture is not None:
                assert picture.frame.whole_box.contains(one.as_tuple)
            case BoxPx() if picture is not None:
                assert one.as_box.intersection(picture.frame.whole_box) == one.as_box
            case AnswerModel():
                said += [getattr(one, name) for name in type(one).model_fields]
            case list():
                said += one
    match contract, answer:
        case _, PlanDraft():
            assert len(answer.to_subgoals()) == len(answer.subgoals)
            assert len(answer.to_targets()) == len(answer.targets)
        case "WriteSteps", _:
            assert {step.subgoal for step in answer.to_steps()} == {"G1", "G2"}  # type: ignore[attr-defined]
        case "MoveBox", _:
            assert isinstance(answer.apply(question.box), Box)  # type: ignore[attr-defined]
        case "JudgeOutcome", _:
            assert len(answer.to_verdicts()) == 2  # type: ignore[attr-defined]


@EVERY
@HURRY
@given(data=st.data())
def test_a_damaged_answer_is_valid_or_refused(contract: str, data: st.DataObject) -> None:
    said = data.draw(damaged_json(json.dumps(RIGHT[contract])))
    check(contract, said.decode("utf-8", "replace"))


@EVERY
@HURRY
@given(said=ANY)
def test_any_json_is_valid_or_refused(contract: str, said: Any) -> None:
    fields = QUESTION[contract].output().model_fields
    for value in (said, dict.fromkeys(fields, said)):
        check(contract, value)
