"""A wrapper that forwards what it does not know keeps the caps of the model that it wraps, on every Python."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from tests.models.providers.test_sending import REQUEST
from wonderful_team.core.caps import Caps, Estimate
from wonderful_team.errors import BudgetReached
from wonderful_team.models.budget import Budget
from wonderful_team.models.client import ModelClient


class Reckoning:
    name = "reckoning"
    asked = 0

    def estimate(self, request: Any) -> Estimate:
        return Estimate(tokens_in=500, tokens_out=500)

    def answer(self, request: Any) -> Any:
        self.asked += 1
        raise AssertionError("a request beyond the cap was sent")


class Forwarding:
    def __init__(self, model: Any) -> None:
        self.model = model

    def __getattr__(self, name: str) -> Any:
        return getattr(self.model, name)

    async def answer(self, request: Any) -> Any:
        return self.model.answer(request)


def test_a_forwarded_estimate_holds_a_request_back() -> None:
    model = Reckoning()
    with pytest.raises(BudgetReached):
        asyncio.run(ModelClient(Forwarding(model), budget=Budget(Caps(tokens=100))).ask(REQUEST))
    assert model.asked == 0
