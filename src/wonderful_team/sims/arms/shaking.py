"""Shaking a bottle: how often it turned back while it was held off the table is counted, and how it stands in the end is judged."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from wonderful_team.core.actions import Action, Trajectory
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Score
from wonderful_team.sims.arms.bottle import CLEAR_M, OFF_M, Bottles
from wonderful_team.sims.tabletop.goals import Poses
from wonderful_team.sims.tabletop.model import Thing

STROKE_M = 0.04
"""Shorter ways to and fro are no strokes of shaking [m]."""
REVERSALS = 5
"""So often it has to turn back: up and down three times, with the lifting and the putting back."""
BACK_M = 0.1
"""It is put back within this of where it stood [m]."""
DROP_M, LOOSE = 0.03, 5
"""A bottle that is higher than this and so many looks in no fingers was dropped [m]."""
GRASP_M, RISE_M, STROKES = 0.03, 0.07, 4
"""How far below its top the oracle grips it, how far it lifts it in a stroke, and how often [m]."""
DIRECTIONS = np.array([one for one in product((-1.0, 0.0, 1.0), repeat=3) if one > (0.0, 0.0, 0.0)])
"""Directions in which ways are looked at, shape (13, 3): along the axes and between them."""


def reversals(track: Array, stroke_m: float = STROKE_M) -> int:
    """How often something turned back along the one direction in which it did so most often.

    Args:
        track: Where it was, one instant after the other, shape (N, 3) [m].
        stroke_m: A way back counts from this length on [m].
    """
    unit = DIRECTIONS / np.linalg.norm(DIRECTIONS, axis=1, keepdims=True)
    return max(_turned_back(track @ direction, stroke_m) for direction in unit)


def _turned_back(values: Array, stroke_m: float) -> int:
    """How often a value turned back by at least a stroke after it had gone at least a stroke, shape (N,)."""
    low = high = float(values[0])
    heading, count = 0, 0
    for value in values.tolist():
        low, high = min(low, value), max(high, value)
        if heading <= 0 and value - low >= stroke_m:
            count, heading, high = count + (heading < 0), 1, value
        elif heading >= 0 and high - value >= stroke_m:
            count, heading, low = count + (heading > 0), -1, value
        if heading > 0:
            low = high
        elif heading < 0:
            high = low
    return count


class Shaking(Bottles):
    """A bottle is shaken in the air.

    Attributes:
        ways: Where the bottle was while both fingers held it off the table, way after way, as points [m].
        dropped_m: How high it was when it was dropped; 0 when it was not.
    """

    facts = "A bottle has been shaken when it was moved to and fro several times, well off the table; then it stands on the table again."

    def __init__(self, wanted: Thing, things: Sequence[Thing]) -> None:
        super().__init__(wanted, things)
        self.ways: list[list[tuple[float, float, float]]] = []
        self.dropped_m = 0.0
        self._in_air, self._loose = False, 0

    def watch(self) -> None:
        super().watch()
        x, y, z = (float(value) for value in self._state.xpos[self._bodies[self.wanted.name]])
        held = self.held(self.wanted.name)
        in_air = z > OFF_M and held
        # What the disturbance "slip" lets fall, nobody has dropped.
        self._loose = self._loose + 1 if z > DROP_M and not held and not self._robot.loosened else 0
        if self._loose >= LOOSE:
            self.dropped_m = max(self.dropped_m, z)
        if in_air and not self._in_air:
            self.ways.append([])
        if in_air:
            self.ways[-1].append((x, y, z))
        self._in_air = in_air

    @property
    def shaken(self) -> int:
        """How often the bottle turned back in the air."""
        return sum(reversals(np.array(way)) for way in self.ways if len(way) > 1)

    def score(self, poses: Poses) -> Score:
        name = self.wanted.name
        wrong = self.disturbed(poses)
        if wrong is not None:
            return wrong
        if self.fallen(name, poses):
            return Score(False, "execution", f"the {name} does not stand any more")
        if self.dropped_m:
            return Score(False, "execution", f"the {name} was dropped from {100 * self.dropped_m:.0f} cm")
        said = f"the {name} turned back {self.shaken} times in the air (at least {REVERSALS}, {100 * STROKE_M:.0f} cm each)"
        if self.shaken < REVERSALS:
            moved = name in self.lifted or self.moved_m(name, poses) > 0.001
            return Score(False, "execution" if moved else "plan", said)
        if float(poses[name].position_m[2]) > OFF_M or self.held(name):
            return Score(False, "execution", f"the {name} was not put back onto the table")
        moved_m = self.moved_m(name, poses)
        if moved_m > BACK_M:
            said = f"the {name} stands {100 * moved_m:.0f} cm from where it stood (at most {100 * BACK_M:.0f} cm)"
            return Score(False, "execution", said)
        return Score(True, None, f"{said}, and stands again")

    def oracle(self, poses: Poses) -> Sequence[Action]:
        if self.score(poses).success or self.fallen(self.wanted.name, poses):
            return []
        at, yaw, grip = self.grasp(self.wanted, poses, GRASP_M, tight=True)
        low = at + np.array([0.0, 0.0, CLEAR_M])
        high = low + np.array([0.0, 0.0, RISE_M])
        path = Trajectory(np.array([low, *([high, low] * STROKES)]))
        return [*grip, self.to(at, yaw, CLEAR_M), path, *self.put(at + np.array([0.0, 0.0, 0.003]), yaw)]
