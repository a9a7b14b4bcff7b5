"""The waiting rounds of one plan: a model that takes one (virtual) second per answer and agrees with everything."""

from __future__ import annotations

import asyncio
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from tests.planning.stub_model import stub_model
from tests.planning.virtual_time import run_virtual
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import Instruction, Observation, Plan, Request, View
from wonderful_team.planning import TeamConfig, TeamPolicy


@dataclass
class Stopwatch:
    """Notes when each request was sent, in rounds (one second each)."""

    sent: list[tuple[int, Request]] = field(default_factory=list)

    def on_event(self, event: Event) -> None:
        if event.kind == "request":
            self.sent.append((round(asyncio.get_running_loop().time()), event.content))

    def rounds(self) -> list[Counter[str]]:
        """Requests by kind, round after round."""
        last = max((number for number, _ in self.sent), default=-1)
        return [Counter(r.contract for number, r in self.sent if number == n) for n in range(last + 1)]


def photo(width: int = 640, height: int = 480) -> Observation:
    """A table with two plain things on it, lit from one side: what it holds does not matter here."""
    shade = np.linspace(200, 225, width)[None, :, None] + np.zeros((height, 1, 3))
    rgb = shade.astype(np.uint8)
    for centre, colour in ((0.3, (190, 60, 50)), (0.7, (60, 90, 180))):
        x = int(centre * width)
        rgb[height // 2 - 40 : height // 2 + 40, x - 40 : x + 40] = colour
    return Observation({"photo": View("photo", "photo", 0.0, rgb)})


def measure(config: TeamConfig) -> tuple[Plan, Stopwatch, float]:
    """One plan by a model that takes one virtual second per answer: the plan, what was sent, and the time in seconds."""
    watch = Stopwatch()
    team = TeamPolicy(stub_model(delay_s=1.0), config, subscribers=(watch,))

    async def run() -> tuple[Plan, float]:
        start = asyncio.get_running_loop().time()
        plan = await team.make_plan(photo(), Instruction("put the first thing into the second thing"), PICK_PLACE)
        return plan, asyncio.get_running_loop().time() - start

    plan, seconds = run_virtual(run())
    return plan, watch, seconds
