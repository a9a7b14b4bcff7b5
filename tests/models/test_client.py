"""The client: validation, retries with the reason, deadlines, concurrency, and what subscribers hear."""

from __future__ import annotations

import asyncio
import threading
import time

import pytest

from wonderful_team.contracts import ReviewPath
from wonderful_team.core.caps import Caps
from wonderful_team.core.geometry import Frame
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Answer, Request, Subgoal, Usage, Words
from wonderful_team.errors import ConfigError, ModelOutputError
from wonderful_team.models.budget import Budget
from wonderful_team.models.client import ModelClient
from wonderful_team.models.scripted import ScriptedModel

GOOD = {"reasoning": "", "accepted": True, "problem": ""}
CONTRADICTION = {"reasoning": "", "accepted": True, "problem": "it is wrong"}


def request(role: str = "supervisor", id: str = "0/act/main/ReviewPath/1") -> Request:
    import numpy as np

    picture = Picture("view", np.zeros((8, 8, 3), np.uint8), Frame.whole("view", (8, 8)))
    question = ReviewPath(Subgoal("G1", "go round"), picture)
    return Request(id, "act", role, question, (Words("see"), picture), question.output())


class Heard:
    def __init__(self):
        self.events = []

    def on_event(self, event):
        self.events.append(event)

    @property
    def kinds(self):
        return [event.kind for event in self.events]


def ask(model, **options):
    return asyncio.run(ModelClient(model, **options).ask(request()))


@pytest.mark.parametrize(
    "given", [GOOD, '{"reasoning": "", "accepted": true, "problem": ""}', Answer(GOOD), ReviewPath.output(None)(**GOOD)]
)
def test_any_form_of_a_right_answer_is_taken(given):
    answer = ask(ScriptedModel({"ReviewPath": given}))
    assert answer.value.accepted is True
    assert answer.tries == 1


def test_what_the_schema_cannot_say_is_sent_back_in_words():
    model, heard = ScriptedModel({"ReviewPath": [CONTRADICTION, GOOD]}), Heard()
    answer = ask(model, subscribers=[heard])
    assert answer.tries == 2
    assert answer.usage.calls == 2
    assert "exactly when" in model.requests[1].feedback
    assert model.requests[1].previous == CONTRADICTION
    assert heard.kinds == ["request", "drawn", "invalid", "request", "drawn", "answer"]


def test_three_invalid_answers_are_a_typed_failure_of_the_method():
    model = ScriptedModel({"ReviewPath": CONTRADICTION})
    with pytest.raises(ModelOutputError, match="no valid answer to ReviewPath in 3 attempts") as failure:
        ask(model)
    assert failure.value.stage == "act"
    assert len(model.requests) == 3


def test_each_role_may_have_its_own_model():
    one, rest = ScriptedModel({"ReviewPath": GOOD}), ScriptedModel({"ReviewPath": GOOD})
    client = ModelClient({"checker": one, "*": rest})
    asyncio.run(client.ask(request("checker")))
    asyncio.run(client.ask(request("supervisor")))
    assert (len(one.requests), len(rest.requests)) == (1, 1)
    assert set(client.budget.by_role) == {"checker", "supervisor"}


def test_a_role_without_a_model_is_a_configuration_error():
    with pytest.raises(ConfigError, match=r"no model for role 'supervisor'; models are set for: checker"):
        asyncio.run(ModelClient({"checker": ScriptedModel({})}).ask(request()))


def test_something_that_cannot_answer_is_refused_at_once():
    with pytest.raises(ConfigError, match="without answer"):
        ModelClient(object())


def test_plain_functions_run_beside_each_other():
    class Plain:
        name = "plain"

        def __init__(self):
            self.threads = set()

        def answer(self, request):
            self.threads.add(threading.get_ident())
            time.sleep(0.1)
            return GOOD

    async def two(client):
        started = time.monotonic()
        await asyncio.gather(client.ask(request()), client.ask(request(id="2")))
        return time.monotonic() - started

    model = Plain()
    assert asyncio.run(two(ModelClient(model))) < 0.19
    assert threading.get_ident() not in model.threads


def test_the_concurrency_limit_holds():
    class Counting:
        running = peak = 0

        async def answer(self, request):
            self.running += 1
            self.peak = max(self.peak, self.running)
            await asyncio.sleep(0.01)
            self.running -= 1
            return GOOD

    async def many(client):
        await asyncio.gather(*(client.ask(request(id=str(n))) for n in range(12)))

    model = Counting()
    asyncio.run(many(ModelClient(model, concurrency=3)))
    assert model.peak == 3


def test_calls_in_flight_count_against_the_caps():
    async def many(client):
        return await asyncio.gather(*(client.ask(request(id=str(n))) for n in range(6)), return_exceptions=True)

    model = ScriptedModel({"ReviewPath": Answer(GOOD, Usage(calls=1, tokens_in=100))}, delay_s=0.01)
    results = asyncio.run(many(ModelClient(model, budget=Budget(Caps(calls=4)))))
    assert len(model.requests) == 4
    assert sum(isinstance(r, Exception) for r in results) == 2


def test_the_door_serves_several_event_loops_one_after_the_other():
    client = ModelClient(ScriptedModel({"ReviewPath": GOOD}), concurrency=1)
    for _ in range(3):
        assert asyncio.run(client.ask(request())).value.accepted
