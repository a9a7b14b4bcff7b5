"""Every contract takes a right answer as it stands, and no answer with a field too many or too few."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest
from pydantic import ValidationError

from tests.contracts.right_answers import LEAVE_OUT, QUESTION, RIGHT, changed, judged
from wonderful_team.contracts import QUESTIONS

LATER = {"wrong_points", "walk"}
"""Fields that came later: answers in records of earlier releases do without them."""
EVERY = pytest.mark.parametrize("contract", [question.__name__ for question in QUESTIONS])


def objects(value: Any, place: tuple[str, ...] = ()) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every JSON object in an answer with its place."""
    if isinstance(value, dict):
        yield ".".join(place), value
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield from objects(item, (*place, str(key)))


@EVERY
def test_a_right_answer_is_taken_as_it_stands(contract: str) -> None:
    for said in (RIGHT[contract], json.dumps(RIGHT[contract])):
        answer, repairs = judged(QUESTION[contract], said)
        assert repairs == ()
        assert json.loads(answer.model_dump_json()) == json.loads(type(answer)(**RIGHT[contract]).model_dump_json())


@EVERY
def test_a_field_that_the_contract_does_not_know_is_refused_wherever_it_stands(contract: str) -> None:
    for place, _ in objects(RIGHT[contract]):
        with pytest.raises(ValidationError, match="Extra inputs are not permitted"):
            judged(QUESTION[contract], changed(contract, {f"{place}.confidence".lstrip("."): 0.9}))


@EVERY
def test_a_field_that_is_left_out_is_refused_by_name(contract: str) -> None:
    for place, held in objects(RIGHT[contract]):
        for name in held.keys() - LATER:
            with pytest.raises(ValidationError, match=rf"{name}\n  Field required|discriminator '{name}'"):
                judged(QUESTION[contract], changed(contract, {f"{place}.{name}".lstrip("."): LEAVE_OUT}))


@EVERY
@pytest.mark.parametrize("said", ["", "null", "[]", "{", "{{}}", "the red block", "```json\n{}\n```", "{} {}"])
def test_what_is_no_json_object_is_refused(contract: str, said: str) -> None:
    with pytest.raises(ValidationError):
        judged(QUESTION[contract], said)
