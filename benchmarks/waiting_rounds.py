"""Print the chain of waiting rounds of one plan, by name, and what it sends.

    python -m benchmarks.waiting_rounds

A model that takes one (virtual) second per answer and agrees with everything plans for two targets; requests that
wait for each other make the rounds. Nothing here says how good a plan is.
"""

from __future__ import annotations

import asyncio
import json
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks.virtual_time import run_virtual
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import Instruction, Observation, Plan, Request, View, Words
from wonderful_team.images import draw, to_png
from wonderful_team.models.agreeable import agreeable_model
from wonderful_team.planning import Team, TeamConfig


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
    team = Team(agreeable_model(delay_s=1.0), config, subscribers=(watch,))

    async def run() -> tuple[Plan, float]:
        start = asyncio.get_running_loop().time()
        plan = await team.make_plan(photo(), Instruction("put the first thing into the second thing"), PICK_PLACE)
        return plan, asyncio.get_running_loop().time() - start

    plan, seconds = run_virtual(run())
    return plan, watch, seconds


def sizes(requests: list[Request]) -> dict[str, int]:
    """Calls, pictures, characters of words and bytes of PNG that these requests send."""
    words = sum(len(r.system) + sum(len(p.text) for p in r.parts if isinstance(p, Words)) for r in requests)
    schema = sum(len(json.dumps(r.output.model_json_schema())) for r in requests)
    pictures = [picture for r in requests for picture in r.pictures]
    return {
        "calls": len(requests),
        "pictures": len(pictures),
        "characters": words,
        "schema characters": schema,
        "png bytes": sum(len(to_png(draw(picture))) for picture in pictures),
    }


def describe(name: str, config: TeamConfig) -> dict[str, Any]:
    """Print one way of working and return its figures."""
    plan, watch, seconds = measure(config)
    figures = sizes([request for _, request in watch.sent])
    print(f"\n{name}: {seconds:.0f} waiting rounds, plan {plan.status}")
    for number, kinds in enumerate(watch.rounds(), start=1):
        print(f"  {number:2d}  " + " + ".join(f"{kind} x{n}" if n > 1 else kind for kind, n in kinds.items()))
    print("  " + ", ".join(f"{value:,} {key}" for key, value in figures.items()))
    return {"rounds": round(seconds), **figures}


def main() -> None:
    """Print the chain for both ways of working and for the switch-offs."""
    print(
        "two targets, one_step, no doubt, first boxes accepted, Memory on; photo 640 x 480; model: agreeable (scripted)"
    )
    for way in ("paper", "lean"):
        describe(way, TeamConfig(way=way))
    for setting in ("s1", "s2", "s4", "s6", "s7", "s8"):
        describe(f"paper, {setting}", TeamConfig(way="paper", setting=setting))


if __name__ == "__main__":
    main()
