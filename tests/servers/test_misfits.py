"""The check of answers against their schema finds what breaks it."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.agents.question_samples import RIVALS, SAMPLES
from tests.models.wire.writing import written
from tests.planning.stub_model import stub_script
from tests.servers.schemas import misfits, nodes
from wonderful_team.agents import build_request
from wonderful_team.contracts import Question
from wonderful_team.models.conventions import CONVENTIONS
from wonderful_team.models.wire.form import Form

SCHEMA = {
    "$defs": {"One": {"type": "object", "properties": {"kind": {"const": "one"}}, "required": ["kind"]}},
    "type": "object",
    "properties": {
        "text": {"type": "string", "minLength": 2},
        "items": {"type": "array", "items": {"anyOf": [{"$ref": "#/$defs/One"}, {"type": "integer", "maximum": 9}]}, "maxItems": 2},
    },
    "required": ["text"],
    "additionalProperties": False,
}  # fmt: skip


@pytest.mark.parametrize(
    ("value", "found"),
    [
        ({"text": "ab", "items": [{"kind": "one"}, 9]}, 0),
        ({"text": "a"}, 1),
        ({}, 1),
        ({"text": "ab", "more": 1}, 1),
        ({"text": "ab", "items": [10]}, 1),
        ({"text": "ab", "items": [{"kind": "two"}]}, 1),
        ({"text": "ab", "items": [1, 2, 3]}, 1),
        ({"text": "ab", "items": [True]}, 1),
        ([], 1),
    ],
)
def test_everything_that_breaks_a_schema_is_found(value: Any, found: int) -> None:
    assert len(misfits(value, SCHEMA)) == found


@pytest.mark.parametrize("asked", SAMPLES, ids=lambda asked: asked.contract)
def test_right_answers_to_every_question_fit_and_all_words_of_its_schema_are_known(asked: Question) -> None:
    request = build_request(asked, id="q", stage="plan", role=RIVALS.get(asked.contract))
    said = request.output.model_validate(stub_script()[asked.contract](request))
    right = said.model_dump(mode="json")
    if right.get("reasoning", "") is None:
        # A field that only answers of earlier releases have.
        del right["reasoning"]
    for step in right.get("steps", ()):
        # Taken from who answers so all the same, and offered to nobody who knows points alone.
        if asked.contract == "PlanFromList" and "place" in step:
            assert step["place"].pop("side") is None
    form = Form.of(request.output, CONVENTIONS["qwen2.5-vl"])
    sent = written(form, right, (640, 480))
    assert misfits(json.loads(json.dumps(sent)), form.schema) == []
    known = {
        "$defs", "$ref", "additionalProperties", "anyOf", "const", "description", "discriminator", "enum", "exclusiveMaximum",
        "exclusiveMinimum", "items", "maxItems", "maxLength", "maximum", "minItems", "minLength", "minimum", "oneOf",
        "properties", "required", "title", "type", "default",
    }  # fmt: skip
    assert {word for _, node in nodes(form.schema) for word in node} <= known
