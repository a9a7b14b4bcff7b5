"""A team over a script that differs from the agreeable one in single answers."""

from __future__ import annotations

import asyncio
from typing import Any

from tests.planning.rounds import photo
from tests.planning.stub_model import stub_script
from wonderful_team.core.actions import PICK_PLACE, Vocabulary
from wonderful_team.core.caps import Caps
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import Instruction, Plan, Request
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.planning import TeamConfig, TeamPolicy


class Tape:
    """Keeps every event."""

    def __init__(self) -> None:
        self.events: list[Event] = []

    def on_event(self, event: Event) -> None:
        self.events.append(event)

    def kinds(self, kind: str) -> list[Event]:
        return [event for event in self.events if event.kind == kind]

    @property
    def warnings(self) -> str:
        return "\n".join(str(event.content) for event in self.kinds("warning"))


def scripted(**changes: Any) -> ScriptedModel:
    return ScriptedModel({**stub_script(), **changes})


AS_LARGE = (1280, 960)
"""Size of a view that is shown as it is: positions in its pictures are its own [px]."""


def plan_with(
    model: Any,
    config: TeamConfig | None = None,
    *,
    caps: Caps | None = None,
    vocabulary: Vocabulary = PICK_PLACE,
    tape: Tape | None = None,
    size: tuple[int, int] = (640, 480),
    **options: Any,
) -> Plan:
    team = TeamPolicy(model, config or TeamConfig(mode="paper"), caps=caps, subscribers=[tape] if tape else ())
    instruction = Instruction("put the first thing into the second thing")
    return asyncio.run(team.make_plan(photo(*size), instruction, vocabulary, **options))


def asked(model: ScriptedModel, contract: str) -> list[Request]:
    return [request for request in model.requests if request.contract == contract]


def doubt(about: str = "G1", question: str = "is it free?") -> dict[str, Any]:
    return {
        "reasoning": "",
        "approved": False,
        "doubt": {"about": about, "kind": "collision", "question": question},
    }


APPROVED = {"reasoning": "", "approved": True, "doubt": None}


def subgoal(name: str, text: str = "put the first thing into the second thing", **changes: Any) -> dict[str, Any]:
    return {"id": name, "text": text, "after": [], "targets": ["T1", "T2"], "function": None, **changes}


def draft(*subgoals: dict[str, Any], mode: str = "one_step", words: str = "the first thing") -> dict[str, Any]:
    target = {"id": "T1", "kind": "object", "words": words, "part": None, "where": "", "like": [], "use": ["pick"]}
    other = {**target, "id": "T2", "words": "the second thing", "use": ["place"]}
    return {
        "reasoning": "",
        "subgoals": list(subgoals),
        "targets": [target, other],
        "mode": mode,
        "clarification": None,
    }


def one_step_each(request: Request) -> dict[str, Any]:
    """A step for every subgoal of the question."""
    return {
        "reasoning": "",
        "steps": [
            {
                "subgoal": item.id,
                "kind": "pick_place",
                "pick": "T1",
                "place": {"target": "T2", "how": "at", "side": None},
                "rotate_deg": 0,
            }
            for item in request.question.subgoals
        ],
    }
