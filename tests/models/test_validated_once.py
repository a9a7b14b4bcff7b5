"""An answer is validated once on its way to whoever asked, be it new or kept."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from tests.models.cache_helpers import GOOD, Paid, request
from wonderful_team.contracts import ReviewPath
from wonderful_team.core.caps import Estimate
from wonderful_team.core.values import Answer, Request
from wonderful_team.models.cache import Cached
from wonderful_team.models.cache_store import CacheStore
from wonderful_team.models.client import ModelClient


class Priced(Paid):
    """It says beforehand what a request may cost, as providers do."""

    def estimate(self, asked: Request) -> Estimate:
        return Estimate(1000, 100, 0.01, 0.01)


@pytest.fixture
def validations(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Every validation by the answer's type, and by the question."""
    done: list[str] = []
    output, by_question = request().output, ReviewPath.validate
    parse = output.model_validate

    def parsed(value: Any, **how: Any) -> Any:
        done.append("type")
        return parse(value, **how)

    def settled(question: ReviewPath, answer: Any) -> Any:
        done.append("question")
        return by_question(question, answer)

    monkeypatch.setattr(output, "model_validate", parsed)
    monkeypatch.setattr(ReviewPath, "validate", settled)
    return done


@pytest.fixture
def store(tmp_path: Any) -> Iterator[CacheStore]:
    held = CacheStore(tmp_path / "cache.db")
    yield held
    held.close()


def ask(model: Any) -> Answer:
    return asyncio.run(ModelClient(model).ask(request()))


def test_without_a_cache(validations: list[str]) -> None:
    assert ask(Priced()).value.accepted
    assert validations == ["type", "question"]


def test_new_and_then_kept(store: CacheStore, validations: list[str]) -> None:
    model = Priced()
    assert ask(Cached(model, store)).provenance == "model"
    assert validations == ["type", "question"]
    validations.clear()
    kept = ask(Cached(model, store))
    assert (kept.provenance, model.calls) == ("cached", 1)
    assert kept.value == request().output(**GOOD)
    assert validations == ["type", "question"]


def test_what_is_changed_on_the_way_is_validated_as_it_is_then(store: CacheStore) -> None:
    class Changing:
        name = "changing"

        def __init__(self, inner: Any) -> None:
            self.inner = inner

        async def answer(self, asked: Request) -> Answer:
            answer = await self.inner.answer(asked)
            return replace(answer, value={**GOOD, "accepted": False, "problem": "it is not free"})

    model = Changing(Cached(Paid(), store))
    for _ in range(2):
        assert not ask(model).value.accepted


def test_a_kept_answer_is_read_once(store: CacheStore, monkeypatch: pytest.MonkeyPatch) -> None:
    model = Priced()
    ask(Cached(model, store))
    read, get = [], store.get
    monkeypatch.setattr(store, "get", lambda key: read.append(key) or get(key))
    ask(Cached(model, store))
    assert len(read) == 1
