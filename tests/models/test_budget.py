"""Caps hold before a request is sent, with many in flight, with retries, and before the first answer is known."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.models.wire.scenes import answer_px, picture, reading
from wonderful_team.core.caps import Caps, Estimate
from wonderful_team.core.values import Answer, Request, Usage
from wonderful_team.errors import BudgetReached, ModelServerError
from wonderful_team.models.budget import Budget, current_ticket
from wonderful_team.models.client import ModelClient

VIEW = picture((64, 48))
REQUEST = reading(VIEW)


class Counting:
    """A model that keeps to its estimate and to the limit that its ticket sets."""

    name = "counting"

    def __init__(self, tokens_in: int = 100, most_out: int = 400, usd: float | None = None, wants: int = 400) -> None:
        self.cost = Estimate(tokens_in, most_out, *((None, None) if usd is None else (usd * tokens_in, usd * most_out)))
        self.usd = usd
        self.wants = wants
        self.sent = 0
        self.most_at_once = 0
        self._now = 0

    def estimate(self, request: Request) -> Estimate:
        return self.cost

    async def answer(self, request: Request) -> Answer:
        ticket = current_ticket()
        self.sent += 1
        self._now += 1
        self.most_at_once = max(self.most_at_once, self._now)
        await asyncio.sleep(0.001)
        self._now -= 1
        out = self.wants if ticket.max_out is None else min(self.wants, ticket.max_out)
        usd = None if self.usd is None else self.usd * (self.cost.tokens_in + out)
        return Answer(answer_px(VIEW), Usage(1, self.cost.tokens_in, tokens_out=out, usd=usd))


async def ask_many(client: ModelClient, count: int) -> list[Any]:
    return await asyncio.gather(*(client.ask(REQUEST) for _ in range(count)), return_exceptions=True)


@settings(deadline=None, max_examples=40)
@given(st.integers(400, 5000), st.integers(1, 12), st.integers(10, 300), st.integers(0, 400))
def test_a_cap_on_tokens_is_never_passed(cap: int, at_once: int, tokens_in: int, wants: int) -> None:
    model = Counting(tokens_in, wants=wants)
    client = ModelClient(model, budget=Budget(Caps(tokens=cap)), concurrency=at_once)
    results = asyncio.run(ask_many(client, 20))
    assert client.budget.spent.tokens <= cap
    assert all(isinstance(result, Answer | BudgetReached) for result in results)
    assert model.sent == client.budget.spent.calls


@settings(deadline=None, max_examples=30)
@given(st.floats(0.005, 0.05), st.integers(1, 12))
def test_a_cap_on_money_is_never_passed(cap: float, at_once: int) -> None:
    client = ModelClient(Counting(usd=1e-5), budget=Budget(Caps(usd=cap)), concurrency=at_once)
    asyncio.run(ask_many(client, 20))
    assert client.budget.spent.usd is not None
    assert client.budget.spent.usd <= cap + 1e-12


def test_calls_that_do_not_fit_beside_others_wait_and_are_not_refused() -> None:
    model = Counting(tokens_in=100, most_out=400, wants=10)
    client = ModelClient(model, budget=Budget(Caps(tokens=1100)))
    results = asyncio.run(ask_many(client, 6))
    assert all(isinstance(result, Answer) for result in results)
    assert model.most_at_once < 6
    assert client.budget.spent.tokens == 6 * 110


def test_without_caps_nothing_waits() -> None:
    model = Counting()
    asyncio.run(ask_many(ModelClient(model, concurrency=8), 8))
    assert model.most_at_once == 8


def test_the_first_call_is_refused_when_its_estimate_passes_the_cap() -> None:
    model = Counting(tokens_in=900)
    with pytest.raises(
        BudgetReached, match=r"cap of 1000 tokens is reached \(0 spent; the next call needs about 1156\)"
    ):
        asyncio.run(ModelClient(model, budget=Budget(Caps(tokens=1000))).ask(REQUEST))
    assert model.sent == 0


class Failing(Counting):
    """A provider that is tried again and again: every try asks for leave."""

    def __init__(self, tries: int, **options: Any) -> None:
        super().__init__(**options)
        self.tries = tries

    async def answer(self, request: Request) -> Answer:
        ticket = current_ticket()
        for attempt in range(self.tries):
            if attempt:
                ticket.another_try()
            self.sent += 1
            ticket.book_lost_try()
        raise ModelServerError("down")


def test_tries_count_as_calls_and_what_they_may_have_cost_is_booked() -> None:
    client = ModelClient(Failing(3, usd=1e-5))
    with pytest.raises(ModelServerError):
        asyncio.run(client.ask(REQUEST))
    assert client.budget.spent.calls == 3
    assert client.budget.spent.tokens == 3 * (100 + 400)
    assert client.budget.spent.usd == pytest.approx(1500e-5)
    assert client.budget.by_role["manager"].calls == 3


@pytest.mark.parametrize("caps", [Caps(calls=2), Caps(tokens=850), Caps(usd=0.0085)])
def test_another_try_is_not_sent_past_a_cap(caps: Caps) -> None:
    model = Failing(50, usd=1e-5)
    client = ModelClient(model, budget=Budget(caps))
    with pytest.raises(BudgetReached):
        asyncio.run(client.ask(REQUEST))
    assert model.sent <= 6
    assert caps.calls is None or model.sent == 2


def test_a_model_without_an_estimate_is_reckoned_by_the_dearest_call() -> None:
    class Plain:
        name = "plain"
        sent = 0

        def answer(self, request: Request) -> Answer:
            self.sent += 1
            return Answer(answer_px(VIEW), Usage(1, tokens_in=90, tokens_out=10, usd=None))

    model = Plain()
    client = ModelClient(model, budget=Budget(Caps(tokens=350)))

    async def in_turn() -> None:
        for _ in range(5):
            await client.ask(REQUEST)

    with pytest.raises(BudgetReached, match="cap of 350 tokens"):
        asyncio.run(in_turn())
    assert model.sent == 3
    assert client.budget.spent.tokens == 300


def test_the_clock_ends_a_wait() -> None:
    async def work() -> None:
        budget = Budget(Caps(tokens=600, seconds=0.05))
        await budget.take(Estimate(100, 400))
        with pytest.raises(BudgetReached, match=r"cap of 0\.05 s"):
            await budget.take(Estimate(100, 400))

    asyncio.run(work())


def test_a_cancelled_call_gives_its_place_back() -> None:
    class Hanging(Counting):
        async def answer(self, request: Request) -> Answer:
            await asyncio.sleep(30)
            raise AssertionError

    async def work() -> Budget:
        client = ModelClient(Hanging(), budget=Budget(Caps(tokens=2000)))
        task = asyncio.ensure_future(client.ask(REQUEST))
        await asyncio.sleep(0.01)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        return client.budget

    budget = asyncio.run(work())
    # It may have been worked on, so its request and the longest answer count.
    assert budget.spent.tokens == 500
    assert budget.spent.calls == 1
