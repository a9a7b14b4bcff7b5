"""Every kind of question stands in every table that answers it, and what is said of roles elsewhere follows from the roles."""

from __future__ import annotations

from dataclasses import fields

import pytest

from tests.agents.question_samples import RIVALS, SAMPLES
from tests.planning.stub_model import stub_script
from wonderful_team.agents import ROLES, build_request
from wonderful_team.agents.rendering import words
from wonderful_team.agents.role import Ask, role
from wonderful_team.api.method import POINTING_ROLES
from wonderful_team.contracts import QUESTIONS, Question
from wonderful_team.core.values import Words
from wonderful_team.errors import ConfigError
from wonderful_team.offline.answers import ANSWERS, SAMPLED
from wonderful_team.planning import ABLATIONS, Members
from wonderful_team.registry import grounding_roles


def test_every_question_has_an_answer_in_every_table() -> None:
    assert set(stub_script()) == {question.__name__ for question in QUESTIONS}
    assert set(ANSWERS) == set(QUESTIONS)
    assert set(ANSWERS) >= SAMPLED


@pytest.mark.parametrize("question", SAMPLES, ids=lambda question: question.contract)
def test_the_stub_answers_every_question_in_its_form(question: Question) -> None:
    request = build_request(question, id="q", stage="plan", role=RIVALS.get(question.contract))
    said = stub_script()[question.contract](request)
    assert request.output.model_validate(said).model_dump() is not None


def test_what_studies_and_models_ask_of_roles_follows_from_the_roles() -> None:
    assert grounding_roles("team") == ("manager", "checker", "mover")
    assert set(POINTING_ROLES) == {"supervisor", "manager"}
    assert {member.name for member in fields(Members)} <= set(ROLES)
    assert ABLATIONS["s5"].words == "without Verification, Checker and Mover"


def test_a_role_of_ones_own_asks_in_its_own_words() -> None:
    judge = next(sample for sample in SAMPLES if sample.contract == "JudgeBox")
    asks = Ask(type(judge), "Is it tight?", lambda question: words(question.target.words))
    critic = role("critic", "You criticise.", asks)
    request = build_request(judge, id="q", stage="ground", role=critic)
    assert (request.role, request.system) == ("critic", "You criticise.")
    assert [part.text for part in request.parts if isinstance(part, Words)] == ["striped mug", "Is it tight?"]
    # Of the same name as one of the team's, it is still its own.
    own = build_request(judge, id="q", stage="ground", role=role("checker", "You criticise.", asks))
    assert own.system == "You criticise."
    with pytest.raises(ConfigError, match="'critic' does not ask DraftPlan; it asks JudgeBox"):
        build_request(SAMPLES[0], id="q", stage="plan", role=critic)
