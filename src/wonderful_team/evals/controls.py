"""Methods that bound every study: an oracle that must succeed, and two that must not. A wrong scorer shows here first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wonderful_team.core.actions import (
    GRIPPER_STATES,
    Action,
    Gripper,
    MoveTo,
    PickPlace,
    Push,
    RotateGripper,
    Trajectory,
)
from wonderful_team.core.geometry import Pose
from wonderful_team.core.protocols import Act, Decision, Done, Policy, Privileged, Situation
from wonderful_team.core.values import Limits, PlannedAction
from wonderful_team.errors import ConfigError
from wonderful_team.evals.names import CONTROLS, NO_MODEL, NO_OP, ORACLE, RANDOM
from wonderful_team.images.keep_out import table_height_m
from wonderful_team.images.relief import Relief

MOST_ACTIONS = 80
"""The oracle runs no more than these: what they have not solved it does not solve."""


def run_together(actions: Sequence[Action]) -> Sequence[Action]:
    """What of the simulator's own solution runs before a new one is asked for.

    An arm's moves and grips belong together: no single one gets anything done from which a new solution could start, so they
    run as they were given.
    """
    return actions[:1] if isinstance(actions[0], PickPlace | Push) else actions


class OracleControl:
    """Runs the simulator's own solution, asked for anew after every pick and place or push, for as long as something is left to do."""

    name = ORACLE
    chunks = True

    def __init__(self, truth: Privileged) -> None:
        self._truth = truth
        self._count = 0

    def decide(self, situation: Situation) -> Decision:
        actions = list(self._truth.oracle())
        if situation.refused is not None:
            return Done("the oracle's actions were refused")
        if not actions:
            return Done("the oracle has nothing left to do")
        if self._count >= MOST_ACTIONS:
            return Done(f"the oracle has run {self._count} actions, and something is left to do")
        now = run_together(actions)
        first, self._count = self._count + 1, self._count + len(now)
        return Act(
            tuple(planned(at_seen_height(one, situation), number) for number, one in enumerate(now, start=first))
        )


class NoOpControl:
    """Says at once that it is done."""

    name = NO_OP

    def decide(self, situation: Situation) -> Decision:
        return Done("the no-op control does nothing")


RANDOM_KINDS = ("pick_place", "push", "move_to", "gripper", "rotate_gripper", "trajectory")
"""What is drawn at random. Going home does nothing to a scene, and a base is not driven blindly."""


class RandomControl:
    """As many actions as the oracle would take, each at random within the workspace."""

    name = RANDOM

    def __init__(self, seed: int, actions: int) -> None:
        self._rng = np.random.default_rng([seed, 0x5EED])
        self._left = max(1, actions)

    def decide(self, situation: Situation) -> Decision:
        if situation.executed or situation.refused is not None:
            return Done("the random control has acted")
        kinds = [kind for kind in situation.vocabulary.kinds if kind in RANDOM_KINDS]
        if not kinds:
            known = ", ".join(RANDOM_KINDS)
            return Done(f"the random control knows {known}; this world runs {', '.join(situation.vocabulary.kinds)}")
        chosen = [kinds[int(self._rng.integers(len(kinds)))] for _ in range(self._left)]
        actions = [at_seen_height(self._action(kind, situation.limits), situation) for kind in chosen]
        return Act(tuple(planned(action, number) for number, action in enumerate(actions, start=1)))

    def _action(self, kind: str, limits: Limits) -> Action:
        low, high = np.array(limits.low_m), np.array(limits.high_m)
        ends = self._rng.uniform(low + 0.02 * (high - low), high - 0.02 * (high - low), size=(2, 3))
        turn = float(self._rng.uniform(-np.pi, np.pi))
        match kind:
            case "move_to":
                return MoveTo(Pose.at(ends[0], turn))
            case "gripper":
                return Gripper(GRIPPER_STATES[int(self._rng.integers(len(GRIPPER_STATES)))])
            case "rotate_gripper":
                return RotateGripper(turn)
            case "trajectory":
                return Trajectory(ends)
        ends[:, 2] = np.clip(0.0, low[2], high[2])
        return Push(ends[0], ends[1]) if kind == "push" else PickPlace(ends[0], ends[1], turn)


def make_control(name: str, seed: int, truth: Privileged | None) -> Policy:
    """The control of that name.

    Raises:
        ConfigError: The world offers no truth, which oracle and random need.
    """
    if name == NO_OP:
        return NoOpControl()
    if truth is None:
        raise ConfigError(f"the {name} control needs a world with truth (an attribute `privileged`); this one has none")
    if name == ORACLE:
        return OracleControl(truth)
    return RandomControl(seed, len(list(truth.oracle())))


def at_seen_height(action: Action, situation: Situation) -> Action:
    """The same pick and place, at the heights of the surfaces that depth shows there: truth and chance know none."""
    view = situation.observation.main
    relief = Relief.of(view) if isinstance(action, PickPlace) else None
    if relief is None or not isinstance(action, PickPlace):
        return action
    own = relief.patch(action.pick_m[:2], table_height_m(situation.limits))
    found = relief.surface_m(action.pick_m[:2]), relief.surface_m(action.place_m[:2], own)
    ends = []
    for point, height in zip((action.pick_m, action.place_m), found, strict=True):
        low, high = situation.limits.low_m[2], situation.limits.high_m[2]
        ends.append(np.append(point[:2], point[2] if height is None else np.clip(height, low, high)))
    return PickPlace(ends[0], ends[1], action.yaw_rad)


def planned(action: Action, number: int) -> PlannedAction:
    """An action as a method returns it; its step names what truth knows and no picture shows."""
    return PlannedAction(action.as_step(f"G{number}", "(from truth)"), action)


def control_faults(successes: dict[str, tuple[int, int]]) -> list[str]:
    """What the controls say against a task's scorer or oracle.

    Args:
        successes: (successes, scored trials) of oracle, no-op and random, where they ran.
    """
    faults: list[str] = []
    won, n = successes.get(ORACLE, (0, 0))
    if won < n:
        faults.append(
            f"the oracle fails {n - won} of {n}: its solution or the scorer is wrong, or the scene is unsolvable"
        )
    won, n = successes.get(NO_OP, (0, 0))
    if won:
        faults.append(
            f"doing nothing succeeds in {won} of {n}: the scorer is wrong, or the scene is solved at the start"
        )
    won, n = successes.get(RANDOM, (0, 0))
    if n and won > max(1, 0.1 * n):
        faults.append(f"random actions succeed in {won} of {n}: the scorer is too lenient, or the task is trivial")
    return faults


__all__ = ["CONTROLS", "NO_MODEL", "NO_OP", "ORACLE", "RANDOM", "control_faults", "make_control", "planned"]
