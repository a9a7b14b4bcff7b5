"""What the episode asks for, how far it has come by the simulator's own word, and actions that fulfil it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .scene import Scene

LOW_XY_M, HIGH_XY_M = (0.25, -0.5), (0.75, 0.5)
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
SAME_M = 0.005


class Goal:
    """One entry of the simulator's list of goals, by name instead of by position in a tuple."""

    def __init__(self, entry: Sequence[Any]) -> None:
        things, matches, targets, _, self.turns, self.metric, self.more, _ = entry
        self.bodies = [int(thing[0]) for thing in things]
        self.turn_counts = [float(thing[1][0]) > 0 for thing in things]
        self.targets = [(np.array(at, dtype=float), np.array(turned, dtype=float)) for at, turned in targets]
        self._matches = np.atleast_2d(np.asarray(matches))
        self.for_oracle = isinstance(self.more, Mapping) and bool(self.more.get("oracle_only", False))

    def targets_of(self, index: int) -> list[tuple[Any, Any]]:
        """Where one of its things may go."""
        row = self._matches[index] if index < len(self._matches) else []
        allowed = [self.targets[k] for k, wanted in enumerate(row) if wanted and k < len(self.targets)]
        return allowed or self.targets


class Goals:
    """The goals of one episode, and the first end that was reached."""

    def __init__(self, env: Any, scene: Scene, horizon: int) -> None:
        self._env, self._scene, self._horizon = env, scene, horizon
        self._first = [Goal(entry) for entry in env.task.goals]
        self._steps = 0
        self._state = "open"
        self._ended_at: int | None = None

    @property
    def ended(self) -> bool:
        """Whether success or failure was reached."""
        return self._state != "open"

    def left(self) -> list[Goal]:
        """What the simulator still waits for, without what it asks of its own oracle alone."""
        return [goal for goal in map(Goal, self._env.task.goals) if not goal.for_oracle]

    def stepped(self, success: bool, failure: bool) -> None:
        """Take the simulator's word after an action; the first end counts, and nothing after the horizon does."""
        self._steps += 1
        if not self.ended and self._steps <= self._horizon and (success or failure):
            self._state, self._ended_at = "success" if success else "failure", self._steps

    def judged(self) -> dict[str, Any]:
        """State, and what is still unmet."""
        return {
            "state": self._state,
            "ended_at": self._ended_at,
            "steps": self._steps,
            "horizon": self._horizon,
            "pushed": any(goal.metric == "zone" for goal in self._first),
            "wanted": sorted({name for goal in self._first for name in self._named(goal)}),
            "unmet": [] if self._state == "success" else [one for goal in self.left() for one in self._unmet(goal)],
        }

    def told(self) -> dict[str, Any]:
        """All goals of the episode as plain values, and those that are left."""
        task = self._env.task
        return {
            "goals": [self._plain(goal) for goal in self._first],
            "left": [self._plain(goal) for goal in map(Goal, task.goals)],
            "distractors": self._distractors(),
            "within_m": float(task.pos_eps),
            "within_rad": float(task.rot_eps),
            "horizon": self._horizon,
        }

    def picks(self, bodies: Any) -> list[dict[str, Any]]:
        """The whole remaining plan of a suction task, thing after thing in the simulator's order.

        Args:
            bodies: The body picture of the top view as it is now.
        """
        if not self.left():
            return []
        believed = {body: self._scene.pose(body) for body in self._scene.names}
        # Where each thing is held, in its own frame, so that it can be found again after it was moved.
        actions = []
        for goal in map(Goal, self._env.task.goals):
            for index, body in enumerate(goal.bodies):
                at, turned = goal.targets_of(index)[0]
                if goal.for_oracle and _near(believed[body][0], at, float(self._env.task.pos_eps)):
                    continue
                pick = self._held_at(body, believed, bodies)
                yaw = _wrapped(_yaw_of(turned) - _yaw(believed[body][1])) if goal.turns else 0.0
                if not goal.turn_counts[index] and self._onto_another(body, at, believed):
                    yaw = 0.0
                place = at[:2] + _turn(yaw) @ (pick - believed[body][0][:2])
                if not _on_table(place):
                    yaw, place = 0.0, at[:2] + pick - believed[body][0][:2]
                actions.append(
                    {
                        "pose0_position": [float(value) for value in pick],
                        "pose0_rotation": list(UPRIGHT),
                        "pose1_position": [float(value) for value in np.clip(place, LOW_XY_M, HIGH_XY_M)],
                        "pose1_rotation": [0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)],
                    }
                )
                believed[body] = _moved(believed[body], at, yaw)
        return actions

    @staticmethod
    def _onto_another(body: int, at: Any, believed: Mapping[int, Any]) -> bool:
        """Whether a place is that of another thing, such as a container: how that is turned means nothing then."""
        return any(_near(pose[0], at, SAME_M) for other, pose in believed.items() if other != body)

    def _held_at(self, body: int, believed: Mapping[int, Any], bodies: Any) -> Any:
        position, matrix = self._scene.pose(body)
        local = _turn(-_yaw(matrix)) @ (np.array(self._scene.grasp_xy(body, bodies)) - position[:2])
        now, turned = believed[body]
        return now[:2] + _turn(_yaw(turned)) @ local

    def _named(self, goal: Goal) -> list[str]:
        return [name for name in map(self._scene.name, goal.bodies) if name is not None]

    def _distractors(self) -> list[str]:
        listed = self._env.task.distractors or []
        bodies = [thing[0] if isinstance(thing, (tuple, list)) else thing for thing in listed]
        return [name for name in (self._scene.name(int(body)) for body in bodies) if name is not None]

    def _plain(self, goal: Goal) -> dict[str, Any]:
        return {
            "things": self._named(goal),
            "targets": [
                {"position_m": [float(v) for v in at], "yaw_rad": _yaw_of(turned)} for at, turned in goal.targets
            ],
            "turn_counts": goal.turn_counts,
            "metric": str(goal.metric),
            "for_oracle_only": goal.for_oracle,
            "zones": self._zones(goal),
        }

    @staticmethod
    def _zones(goal: Goal) -> list[dict[str, Any]]:
        """Where blocks are swept to: the middle, the way it is turned, and the size of each zone."""
        if goal.metric != "zone":
            return []
        return [
            {"position_m": [float(v) for v in pose[0]], "yaw_rad": _yaw_of(pose[1]), "size_m": [float(v) for v in size]}
            for pose, size in goal.more[1]
        ]

    def _unmet(self, goal: Goal) -> list[dict[str, Any]]:
        """How far each thing of a goal is from the nearest place that it may go to."""
        found = []
        for index, body in enumerate(goal.bodies):
            position, matrix = self._scene.pose(body)
            at, turned = min(
                goal.targets_of(index), key=lambda target: float(np.linalg.norm(position[:2] - target[0][:2]))
            )
            off = abs(_wrapped(_yaw(matrix) - _yaw_of(turned))) if goal.turn_counts[index] else 0.0
            found.append(
                {
                    "thing": self._scene.name(body),
                    "target_m": [float(value) for value in at[:2]],
                    "off_m": float(np.linalg.norm(position[:2] - at[:2])),
                    "off_rad": off,
                    "within_m": float(self._env.task.pos_eps),
                    "zone": goal.metric == "zone",
                }
            )
        return found


def _near(one: Any, other: Any, within_m: float) -> bool:
    return bool(np.linalg.norm(np.asarray(one)[:2] - np.asarray(other)[:2]) < within_m)


def _on_table(point: Any) -> bool:
    return all(low <= value <= high for low, value, high in zip(LOW_XY_M, point, HIGH_XY_M))  # noqa: B905  runs on 3.9


def _moved(pose: Any, to_m: Any, yaw_rad: float) -> Any:
    matrix = np.eye(3)
    matrix[:2, :2] = _turn(yaw_rad)
    return np.array([to_m[0], to_m[1], pose[0][2]]), matrix @ pose[1]


def _turn(yaw_rad: float) -> Any:
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return np.array([[c, -s], [s, c]])


def _yaw(matrix: Any) -> float:
    return math.atan2(matrix[1, 0], matrix[0, 0])


def _yaw_of(turned: Any) -> float:
    """Of a quaternion (x, y, z, w)."""
    x, y, z, w = (float(value) for value in turned)
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def _wrapped(angle_rad: float) -> float:
    return math.remainder(angle_rad, 2 * math.pi)
