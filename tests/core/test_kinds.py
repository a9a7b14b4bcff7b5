"""Every kind of step and action stands in everything that deals with them; a kind that this file defines does too."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from typing import Any, ClassVar, get_args

import numpy as np
import pytest

from wonderful_team.agents import step_words
from wonderful_team.agents.rendering import ability_parts
from wonderful_team.cli.plan import command as plan_command
from wonderful_team.cli.wording import action_line, numbers_line
from wonderful_team.contracts import step_list_type
from wonderful_team.core.actions import (
    ACTIONS,
    STEPS,
    VOCABULARIES,
    Action,
    At,
    Beside,
    CloseStep,
    EndEffectorDelta,
    FollowStep,
    Gripper,
    Home,
    HomeStep,
    MoveStep,
    MoveTo,
    Navigate,
    NavigateStep,
    OpenStep,
    OriginOf,
    PickPlace,
    PickPlaceStep,
    Push,
    PushStep,
    RotateGripper,
    RotateGripperStep,
    Step,
    Trajectory,
    Vocabulary,
    places_of,
    steps_for,
)
from wonderful_team.core.actions import _Action as ActionKind
from wonderful_team.core.geometry import AffineCamera, Box, Pose
from wonderful_team.core.geometry.arrays import Array, frozen_array
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.motions import Motion, Reach
from wonderful_team.core.steps import StepWords
from wonderful_team.core.steps import _Step as StepKind
from wonderful_team.core.values import (
    GateReport,
    GroundedTarget,
    KeepOut,
    Limits,
    Observation,
    PlannedAction,
    Target,
    View,
)
from wonderful_team.motion import ground_actions
from wonderful_team.pages.words import step_words as shown_words
from wonderful_team.record.values_file import decode, encode
from wonderful_team.runtime import check_gate

STEP_EXAMPLES: tuple[Step, ...] = (
    PickPlaceStep("G1", "T1", Beside("T2", "left"), 90.0),
    PushStep("G1", At("T1"), At("T2")),
    MoveStep("G1", OriginOf("T1"), "clear"),
    OpenStep("G1"),
    CloseStep("G1", True),
    RotateGripperStep("G1", -30.0),
    FollowStep("G1", "G1"),
    HomeStep("G1"),
    NavigateStep("G1", At("T2")),
)
ACTION_EXAMPLES: tuple[Action, ...] = (
    PickPlace(np.array([0.1, 0.1, 0.0]), np.array([0.3, 0.3, 0.0]), 1.0),
    Push(np.array([0.1, 0.1, 0.0]), np.array([0.3, 0.3, 0.0])),
    MoveTo(Pose.at((0.1, 0.1, 0.3))),
    Gripper("tight"),
    RotateGripper(0.5),
    Trajectory(np.array([[0.1, 0.1, 0.3], [0.3, 0.3, 0.3]])),
    Home(),
    Navigate(np.array([[0.1, 0.1], [0.3, 0.3]])),
    EndEffectorDelta(np.array([0.01, 0.0, 0.0, 0.0, 0.0, 0.1, 1.0])),
)
LIMITS = Limits(low_m=(0.0, 0.0, 0.0), high_m=(0.5, 0.8, 0.4))
VIEW = View("top", "top", 0.0, np.full((400, 250, 3), 150, np.uint8), None, AffineCamera(
    np.array([[500.0, 0, 0, 0], [0, 500.0, 0, 0], [0, 0, -1, 1.0]])
))  # fmt: skip
GROUNDED = {
    name: GroundedTarget(
        Target(name, "object", "block"), "found", "top", Box.around(at, 20, 20), dict.fromkeys(roles, at)
    )
    for name, at, roles in (
        ("T1", (50.0, 50.0), ("pick", "push_start", "place")),
        ("T2", (150.0, 150.0), ("push_end", "place")),
    )
}


def kind_of(value: Step | Action) -> str:
    return value.kind


def gated(action: Action, step: Step, *regions: KeepOut) -> GateReport:
    words = Vocabulary((action.kind,))
    limits = Limits(LIMITS.low_m, LIMITS.high_m, regions)
    now = Observation({"top": VIEW})
    return check_gate([PlannedAction(step, action)], vocabulary=words, limits=limits, plan=None, then=now, now=now)


def test_there_is_an_example_of_every_kind() -> None:
    assert [step.kind for step in STEP_EXAMPLES] == list(STEPS)
    assert [action.kind for action in ACTION_EXAMPLES] == list(ACTIONS)


@pytest.mark.parametrize("step", STEP_EXAMPLES, ids=kind_of)
def test_every_kind_of_step_stands_everywhere(step: Step) -> None:
    # What a model writes of it comes back as it was.
    written = {item.name: getattr(step, item.name) for item in fields(step)}
    drafted = {
        name: draft(value) if isinstance(value, At | Beside | OriginOf) else value for name, value in written.items()
    }
    reply = {"reasoning": "", "steps": [{"kind": step.kind, **drafted}]}
    assert step_list_type((step.kind,)).model_validate(reply).to_steps() == (step,)
    # Models, pages and terminals have words for it, and no hole in them is left open.
    said = [step_words(step), shown_words(to_jsonable(step)), action_line(PlannedAction(step, None), {})]
    said += [part.text for part in ability_parts((step.kind,))]  # type: ignore[union-attr]
    assert all(words and "{" not in words for words in said)
    # Files bring it back, and numbers can be made of it.
    assert decode(json.loads(json.dumps(encode(step))), Step) == step
    (planned,) = ground_actions((step,), GROUNDED, VIEW, LIMITS, paths={"G1": ((10.0, 10.0), (90.0, 90.0))})
    assert planned.action is not None
    assert step.kind in steps_for(planned.action.kind)
    assert {name for name, _ in places_of(step)} == {role for role, _ in type(step).roles}


def draft(place: At | Beside | OriginOf) -> dict[str, Any]:
    how = {At: "at", Beside: "beside", OriginOf: "origin"}[type(place)]
    return {"target": place.target, "how": how, "side": getattr(place, "side", None)}


@pytest.mark.parametrize("action", ACTION_EXAMPLES, ids=kind_of)
def test_every_kind_of_action_stands_everywhere(action: Action) -> None:
    assert set(action.steps) | set(action.also) <= set(STEPS)
    assert isinstance(action.motion(np.zeros(3)), get_args(Motion))
    step = action.as_step("G1", "a thing")
    assert not action.steps or step.kind in steps_for(action.kind)
    assert numbers_line(PlannedAction(step, action)).startswith(action.kind)
    names = {check.name for check in gated(action, step).checks if not check.ok}
    # Without the robot's own word nobody knows where a small step of a learned policy ends.
    assert names == ({"tool position"} if action.kind == "end_effector_delta" else set())
    back = decode(json.loads(json.dumps(encode(action))), Action)
    assert type(back) is type(action)
    assert encode(back) == encode(action)


@dataclass(frozen=True)
class WipeStep(StepKind):
    """Wipe along a place."""

    kind: ClassVar[str] = "wipe"
    words: ClassVar[StepWords] = StepWords("wipe a place", told="wipe {along}", line="wipe")
    roles: ClassVar[tuple[tuple[str, str], ...]] = (("place", "along"),)
    along: At | Beside | OriginOf


@dataclass(frozen=True, eq=False)
class Wipe(ActionKind):
    """Press, and go along."""

    kind: ClassVar[str] = "wipe"
    steps: ClassVar[tuple[str, ...]] = ("wipe",)
    strokes_m: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "strokes_m", frozen_array(self.strokes_m, (None, 3), "strokes_m"))

    def motion(self, tool_m: Array | None) -> Motion:
        return Reach(self.strokes_m)

    def as_step(self, subgoal: str, thing: str) -> Any:
        return WipeStep(subgoal, At(thing))

    def points(self) -> tuple[tuple[str, Array], ...]:
        return tuple(("waypoint", point) for point in self.strokes_m)


def test_the_command_line_offers_every_vocabulary() -> None:
    (option,) = [item for item in plan_command.params if item.name == "vocabulary"]
    assert list(getattr(option.type, "choices", ())) == list(VOCABULARIES)


def test_a_new_kind_is_its_two_classes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(STEPS, "wipe", WipeStep)  # type: ignore[arg-type]
    monkeypatch.setitem(ACTIONS, "wipe", Wipe)  # type: ignore[arg-type]
    step: Any = WipeStep("G1", Beside("T1", "left"))
    action: Any = Wipe(np.array([[0.1, 0.1, 0.3], [0.3, 0.1, 0.3]]))
    assert Vocabulary(("wipe",)).step_kinds == ("wipe",)
    wanted = step_list_type(("wipe", "open"))
    text = {"subgoal": "G1", "kind": "wipe", "along": draft(step.along)}
    assert wanted.model_validate({"reasoning": "", "steps": [text]}).to_steps() == (step,)
    assert step_words(step) == "[G1] wipe the spot to the left of T1"
    assert shown_words(to_jsonable(step), {"T1": "tray"}) == "wipe left of T1 tray"
    assert action_line(PlannedAction(step, action), {}) == (
        "wipe  left of T1  (0.100, 0.100, 0.300) -> (0.300, 0.100, 0.300) m"
    )
    assert gated(action, step).admitted
    (reason,) = gated(action, step, KeepOut("cup", Box(0.18, 0.05, 0.22, 0.15), "m")).reasons
    assert "keep-out cup" in reason
    assert "workspace x" in "".join(gated(Wipe(np.array([[0.6, 0.1, 0.3]])), step).reasons)  # type: ignore[arg-type]
    assert "step and action" in "".join(gated(action, HomeStep("G1")).reasons)
    broken: Any = Wipe(np.zeros((1, 3)))
    object.__setattr__(broken, "strokes_m", np.array([[np.nan, 0.0, 0.0]]))
    assert "numbers" in "".join(gated(broken, step).reasons)
