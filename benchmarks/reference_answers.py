"""What the reference implementation of the paper is answered: rightly and at once, in the fields that each of its questions names.

A question is known by those field names. Positions come from boxes that are known beforehand, in the reference's own
picture: 2,000 pixels wide, y upwards.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from tests.servers.brains import Brain
from tests.servers.heard import Heard
from wonderful_team.core.geometry import Box

WIDTH_PX = 2000
"""Width to which the reference enlarges its picture."""


@dataclass(frozen=True)
class Thing:
    """A target, with its box in the photo [px].

    Attributes:
        spot: A point is enough; the reference calls it a location.
    """

    words: str
    box: Box
    spot: bool = False


@dataclass(frozen=True)
class Scene:
    """A photo of known content.

    Attributes:
        size_px: Width and height of the photo.
        subgoals: What is to be done, in order.
        draws: A shape is drawn on the last target, for which a function is written.
    """

    instruction: str
    size_px: tuple[int, int]
    things: tuple[Thing, ...]
    subgoals: tuple[str, ...]
    draws: bool

    def middle(self, thing: Thing) -> tuple[int, int]:
        """Of a target, in the reference's picture."""
        scale = WIDTH_PX / self.size_px[0]
        x, y = (thing.box.x0 + thing.box.x1) / 2, (thing.box.y0 + thing.box.y1) / 2
        return round(x * scale), round((self.size_px[1] - y) * scale)

    def extent(self, thing: Thing) -> tuple[int, int]:
        """Width and height of a target, in the reference's picture."""
        scale = WIDTH_PX / self.size_px[0]
        return round((thing.box.x1 - thing.box.x0) * scale), round((thing.box.y1 - thing.box.y0) * scale)


def answers(scene: Scene) -> Brain:
    """A brain for one plan of the reference for this scene."""
    script = _Script(scene)
    return lambda heard: json.dumps(script.answer(heard))


class _Script:
    """Answers each kind of question; counts what is asked once a subgoal or once a function."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.checked = 0
        self.drawn = False
        self.kinds: tuple[tuple[str, Callable[[str], dict[str, Any]]], ...] = (
            ("verification_mode", self._plan),
            ("descriptive_key", self._memory),
            ("subgoal_in_question", self._subgoal),
            ("target_list", self._targets),
            ("initial_center", self._centre),
            ("best_center_point", lambda _: {"best_center_point": 0}),
            ("bounding_box", self._box),
            ("target_appearance", lambda _: {**_margins(), "target_appearance": "True"}),
            ("decision", lambda _: {"decision": "Accept"}),
            ("best_action_point_index", self._point),
            ("actionable_point", self._spot),
            ("best_action_point", lambda _: {"best_action_point": 0, "context": _CONTEXT}),
            ("request_function", self._request),
            ("generated_function", lambda _: {"generated_function": _STAR}),
            ("run_function", self._run),
            ("correct_results", lambda _: {"correct_results": True, "feedback": ""}),
            ("updated_action_sequence", lambda _: {"updated_action_sequence": self._actions(0.02)}),
            ("verified_action_sequence", lambda _: {"verified_action_sequence": self._actions("table height")}),
            ("action_sequence", lambda _: {"action_sequence": self._actions("table height")}),
            (
                "clarifying_questions",
                lambda _: {"clarifying_questions": "", "status": "terminate", "context": _CONTEXT},
            ),
        )

    def answer(self, heard: Heard) -> dict[str, Any]:
        """The answer to one question.

        Raises:
            ValueError: The question names none of the fields that are known.
        """
        words = heard.words
        for name, say in self.kinds:
            if f'"{name}"' in words:
                return {"reasoning_process": _REASONING, **say(words)}
        raise ValueError(f"a question of the reference that has no answer here: {words[-400:]!r}")

    def _plan(self, _: str) -> dict[str, Any]:
        mode = "full" if len(self.scene.subgoals) > 1 else "one_step"
        return {"high_level_plan": list(self.scene.subgoals), "verification_mode": mode, "context": _CONTEXT}

    def _memory(self, _: str) -> dict[str, Any]:
        return {"descriptive_key": "plan and targets", "information_summary": "; ".join(self.scene.subgoals)}

    def _subgoal(self, _: str) -> dict[str, Any]:
        """One subgoal a question, then the end."""
        self.checked += 1
        return {
            "subgoal_in_question": "",
            "clarifying_questions": "",
            "checked_list": list(self.scene.subgoals[: self.checked]),
            "status": "terminate" if self.checked >= len(self.scene.subgoals) else "in progress",
            "context": _CONTEXT,
        }

    def _targets(self, _: str) -> dict[str, Any]:
        listed = [
            {"type": "location" if thing.spot else "object", "image": "env_img", "description": thing.words}
            for thing in self.scene.things
        ]
        return {"target_list": listed, "context": _CONTEXT}

    def _asked(self, words: str) -> Thing:
        """The target that a question names; where it names several (the plan stands there too), the one named last."""
        return max(self.scene.things, key=lambda thing: (words.rfind(thing.words), len(thing.words)))

    def _centre(self, words: str) -> dict[str, Any]:
        x, y = self.scene.middle(self._asked(words))
        return {"initial_center": {"x": x, "y": y}}

    def _box(self, words: str) -> dict[str, Any]:
        thing = self._asked(words)
        (x, y), (width, height) = self.scene.middle(thing), self.scene.extent(thing)
        return {"center": {"x": x, "y": y}, "bounding_box": {"size": {"w": width, "h": height}}}

    def _point(self, words: str) -> dict[str, Any]:
        x, y = self.scene.middle(self._asked(words))
        return {"best_action_point_index": 1, "best_action_point_coord": [x, y], "context": _CONTEXT}

    def _spot(self, words: str) -> dict[str, Any]:
        x, y = self.scene.middle(self._asked(words))
        return {"actionable_point": {"x": x, "y": y}, "context": _CONTEXT}

    def _request(self, _: str) -> dict[str, Any]:
        wanted, self.drawn = self.scene.draws and not self.drawn, True
        told = "Points of a five-pointed star, closed, from its centre and outer radius in pixels." if wanted else ""
        return {"request_function": wanted, "function_description": told, "desired_output_variable": "points"}

    def _run(self, _: str) -> dict[str, Any]:
        thing = self.scene.things[-1]
        (x, y), radius = self.scene.middle(thing), min(self.scene.extent(thing)) // 3
        return {"run_function": f"{_STAR}\npoints = star({x}, {y}, {radius})"}

    def _actions(self, height: float | str) -> list[dict[str, Any]]:
        moves = [[*self.scene.middle(thing), height] for thing in self.scene.things]
        actions: list[dict[str, Any]] = []
        for number, move in enumerate(moves):
            actions += [{"move": move}, {"open_gripper": "open_gripper"} if number % 2 else _CLOSE]
        return [*actions, {"return_home": "return_home"}]


_CLOSE = {"close_gripper": "close_gripper_default"}
_CONTEXT = "The plan for the instruction is being made; this is one step of it."
_REASONING = (
    "The picture shows each thing that the instruction names once, apart from the others, so the answer is plain."
)
_STAR = """import math
def star(x, y, radius):
    corners = []
    for number in range(11):
        reach = radius if number % 2 == 0 else 0.38 * radius
        angle = math.pi / 2 + number * math.pi / 5
        corners.append((x + reach * math.cos(angle), y + reach * math.sin(angle)))
    return corners"""


def _margins() -> dict[str, dict[str, str]]:
    """The thing fills its box and ends there."""
    return {"inside_margin": dict.fromkeys("ABCD", "True"), "outside_margin": dict.fromkeys("ABCD", "False")}
