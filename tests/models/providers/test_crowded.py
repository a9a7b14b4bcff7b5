"""A server whose requests share one context, as llama.cpp's do unless it is told otherwise: together they overfill it."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from tests.models.providers.asking import question
from tests.models.providers.test_real_servers import Ear, Server, refused
from wonderful_team.errors import ModelServerError
from wonderful_team.models.client import ModelClient

AT_ONCE = 4


class SharedContext(Server):
    """Takes one request at a time; the first ones arrive together, and all of them fail, as llama.cpp answers."""

    def __init__(self) -> None:
        super().__init__()
        self.first, self.lock = threading.Barrier(AT_ONCE), threading.Lock()
        self.under_way = self.most = 0

    def reply(self, number: int) -> Any:
        with self.lock:
            self.under_way += 1
            self.most = max(self.most, self.under_way)
            alone = self.under_way == 1
        try:
            if number < AT_ONCE:
                self.first.wait(30.0)
                alone = False
            return (200, self.answer()) if alone else refused("Context size has been exceeded.", 500)
        finally:
            with self.lock:
                self.under_way -= 1


@pytest.fixture
def shared() -> Iterator[SharedContext]:
    running = SharedContext()
    yield running
    running.server.shutdown()
    running.server.server_close()


def ask(client: ModelClient, count: int) -> list[Any]:
    async def go() -> list[Any]:
        return await asyncio.gather(*(client.ask(question(f"0/ground/{n}/ReadScene/1")) for n in range(count)))

    return asyncio.run(go())


def test_requests_that_overfill_the_context_together_are_asked_one_at_a_time_from_then_on(
    shared: SharedContext,
) -> None:
    shared.lists(max_model_len=8192)
    ear, provider = Ear(), shared.provider()
    client = ModelClient(provider, subscribers=(ear,))
    assert len(ask(client, AT_ONCE)) == AT_ONCE
    assert len(shared.bodies) == 2 * AT_ONCE, "each is asked once more, alone"
    shared.most = 0
    assert len(ask(client, AT_ONCE)) == AT_ONCE
    assert (len(shared.bodies), shared.most) == (3 * AT_ONCE, 1)
    (said,) = [text for text in ear.warnings if "one at a time" in text]
    assert "context of 8192 tokens" in said
    assert "-c 32768" in said


def test_whoever_waits_for_its_turn_is_given_the_time_of_those_before_it(shared: SharedContext) -> None:
    provider = shared.provider()
    own_s, seen = provider.deadline_s, []
    shared.on_answer = lambda: seen.append(provider.deadline_s)
    ask(ModelClient(provider), AT_ONCE)
    assert max(seen) >= AT_ONCE * own_s
    assert provider.deadline_s == own_s, "nobody has a turn any more"


def test_a_request_that_overfills_the_context_alone_ends_as_the_servers_failure(shared: SharedContext) -> None:
    shared.script = [refused("Context size has been exceeded.", 500)] * 9
    with pytest.raises(ModelServerError, match="Context size has been exceeded") as caught:
        ask(ModelClient(shared.provider()), 1)
    assert (caught.value.exit_code, len(shared.bodies)) == (3, 5)
