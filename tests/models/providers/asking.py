"""One small question with a known answer, asked through the client, for tests of faults."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.planning.stub_model import stub_script
from tests.servers.brains import AgentSession, Brain, Tapped, typed_brain
from tests.servers.server import WireServer
from tests.servers.speech import Speech
from tests.servers.wiring import Wire
from wonderful_team.agents import build_request
from wonderful_team.contracts import ReadScene
from wonderful_team.contracts.read_scene import SceneReading
from wonderful_team.core.values import Answer, Request, Target, View
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.images import whole
from wonderful_team.models.client import ModelClient

TARGETS = (Target("T1", "object", "the red cube"), Target("T2", "area", "the free corner"))


def small_scene(width: int = 160, height: int = 120) -> View:
    """A picture with two things on it."""
    rgb = np.full((height, width, 3), 190, np.uint8)
    rgb[height // 2 - 12 : height // 2 + 12, width // 3 - 12 : width // 3 + 12] = (200, 30, 30)
    rgb[height // 2 - 16 : height // 2 + 16, 2 * width // 3 : 2 * width // 3 + 32] = (30, 60, 200)
    return View("top", "small", 0.0, rgb)


def question(name: str = "0/ground/main/ReadScene/1") -> Request:
    """Where are T1 and T2?"""
    asked = ReadScene(TARGETS, ("G1: put T1 into T2",), whole(small_scene(), "top view", min_side_px=96))
    return build_request(asked, id=name, stage="ground")


def right_answer(request: Request) -> SceneReading:
    """What the brain says, before anything is done to it."""
    value = stub_script()["ReadScene"](request)
    return SceneReading.model_validate(value)


def known_brain(desk: AgentSession, speech: Speech) -> Brain:
    """Knows the right answer to every question."""
    script = stub_script()
    return typed_brain(desk, lambda request: script[request.contract](request), speech)


@dataclass(frozen=True, eq=False)
class Asked:
    """How one question ended."""

    answer: Answer | None
    error: WonderfulTeamError | None
    requests: int
    calls: int

    @property
    def exit_code(self) -> int:
        return 0 if self.error is None else self.error.exit_code


class Asking:
    """Asks one server, again and again, over connections that live as long as this."""

    def __init__(self, server: WireServer, desk: AgentSession, wire: Wire) -> None:
        self.server, self.desk, self.wire = server, desk, wire
        self._runner = asyncio.Runner()
        self._providers: dict[tuple[tuple[str, Any], ...], Any] = {}

    def __enter__(self) -> Asking:
        return self

    def __exit__(self, *_: object) -> None:
        for provider in self._providers.values():
            self._runner.run(provider.aclose())
        self._runner.close()

    def ask(self, **options: Any) -> Asked:
        """Ask the question; errors that are not ours come through."""
        before = len(self.server.log)
        key = tuple(sorted(options.items()))
        if key not in self._providers:
            self._providers[key] = self.wire.provider(self.server, **options)
        client = ModelClient(Tapped(self._providers[key], self.desk))
        answer, error = None, None
        try:
            answer = self._runner.run(client.ask(question()))
        except WonderfulTeamError as failed:
            error = failed
        return Asked(answer, error, len(self.server.log) - before, client.budget.spent.calls)


def largest_gap_px(answer: Answer, request: Request) -> float:
    """Largest distance between a coordinate of the answer and the right one [px]."""
    right = right_answer(request)
    gaps = [0.0]
    for got, wanted in zip(answer.value.targets, right.targets, strict=True):
        pairs = list(zip(got.box.as_box.as_tuple, wanted.box.as_box.as_tuple, strict=True))
        for one, other in zip(got.points, wanted.points, strict=True):
            pairs += zip(one.point.as_tuple, other.point.as_tuple, strict=True)
        gaps += [abs(a - b) for a, b in pairs]
    return max(gaps)
