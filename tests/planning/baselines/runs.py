"""Rivals at work in worlds, and what their records hold."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import wonderful_team as wt
from tests.desk import WORDS, draw_desk, read_record
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.protocols import Decision, Situation
from wonderful_team.core.values import NO_WORKSPACE
from wonderful_team.registry.methods import METHODS

RIVALS = [name for name, row in METHODS.items() if row.team is None]
PLANNERS = [name for name in RIVALS if METHODS[name].plans]
ON_PICTURES = [name for name in RIVALS if METHODS[name].plans and not METHODS[name].privileged and ":text" not in name]
"""Rivals that plan from pictures, and from no more than they show."""


class Listening:
    """Another model, and everything that it was asked."""

    def __init__(self, model: Any) -> None:
        self.name, self.model = "listening", model
        self.heard: list[wt.Request] = []

    def answer(self, request: wt.Request) -> Any:
        self.heard.append(request)
        return self.model.answer(request)


def run(method: str, task: str, out: Path, model: str = "simulated:perfect", seed: int = 500, **caps: Any) -> Any:
    """One trial in the simulator, recorded."""
    world = wt.make_world(f"tabletop/{task}", seed=seed)
    try:
        return wt.rollout(wt.Method(method=method, model=model, **caps), world, out=out, seed=seed)
    finally:
        world.close()


def requests(trial: Any) -> list[dict[str, Any]]:
    """What was asked, in the order of each branch."""
    asked: list[dict[str, Any]] = read_record(trial.folder)["planner"]["requests"]
    return sorted(asked, key=lambda request: int(request["id"].rpartition("/")[2]))


def contracts(trial: Any) -> list[str]:
    """The kinds of question that were asked, in order."""
    return [request["contract"] for request in requests(trial)]


def pictures(request: dict[str, Any]) -> list[dict[str, Any]]:
    """The pictures of a request."""
    return [part for part in request["parts"] if "picture" in part]


def words(request: dict[str, Any]) -> str:
    """Everything that a request says."""
    return "\n".join([request["system"], *(part["words"] for part in request["parts"] if "words" in part)])


def photo(folder: Path) -> Situation:
    """A photo of two things, without a camera, and what to do with them."""
    seen = wt.Observation.from_files(draw_desk(folder) / "desk.png")
    return Situation(seen, wt.Instruction(WORDS), PICK_PLACE, NO_WORKSPACE)


def decided(method: str, situation: Situation, model: Any = "offline") -> Decision:
    """What a rival decides."""
    policy: Any = wt.Method(method=method, model=model).policy()
    made: Decision = asyncio.run(policy.decide(situation))
    return made
