"""What the suite `annotations` asks about: toy tables with a crop's window, a box, a turned goal, or a box before and after a change."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import Literal, TypeAlias

import numpy as np

from wonderful_team.core.geometry import AffineCamera, Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import GroundTruthView, Instruction, TrueThing, View
from wonderful_team.lab.marks import COLOURS
from wonderful_team.lab.toy import BOX_KINDS, MAT, PX_PER_M, RADIUS_PX, RIGHT, SIDE_PX, BoxKind, ToyTable, ToyTruth

Change: TypeAlias = Literal["worse", "better", "right"]
CHANGES: Mapping[Change, str] = {"worse": "keep_before", "better": "take_after_go_on", "right": "take_after_stop"}
"""What was done to a box, and what is right to say of it."""
WINDOW_RADII = 3.5
"""Half the side of a crop's window, in radii of the target, which lies whole in it and not in its middle."""
ANSWERS_DEG = tuple(30.0 * number for number in range(12))
"""Turns to choose from [degrees clockwise]."""
ARM_PX, THICK_PX = 150.0, 50.0
"""Long arm of the thing that is turned, and how thick its arms are; the short one is half as long."""


def crop_window(table: ToyTable) -> Box:
    """A window round the target that does not give it away: its middle lies up to 2 radii beside the target's."""
    rng = np.random.default_rng([table.seed, 11])
    angle, far = rng.uniform(0, 2 * np.pi), rng.uniform(0.5, 2.0) * RADIUS_PX
    x, y = table.target.centre
    side = 2 * WINDOW_RADII * RADIUS_PX
    return Box.around((x + far * math.cos(angle), y + far * math.sin(angle)), side, side)


def box_to_judge(table: ToyTable) -> tuple[Box, str]:
    """A box of one of the four kinds in turn, and the right verdict on it."""
    kind: BoxKind = BOX_KINDS[table.seed % len(BOX_KINDS)]
    return table.box(kind), RIGHT[kind]


def change_to_judge(table: ToyTable) -> tuple[Box, Box, str]:
    """A box before and after a change, which made it worse, better or right in turn; and what is right to say."""
    rng = np.random.default_rng([table.seed, 13])
    change: Change = tuple(CHANGES)[table.seed % len(CHANGES)]
    angle = rng.uniform(0, 2 * np.pi)
    near, far = rng.uniform(0.35, 0.5) * RADIUS_PX, rng.uniform(0.8, 1.1) * RADIUS_PX
    right = table.target.box

    def off(by: float) -> Box:
        return right.shifted(by * math.cos(angle), by * math.sin(angle))

    match change:
        case "worse":
            return off(near), off(far), CHANGES[change]
        case "better":
            return off(far), off(near), CHANGES[change]
        case "right":
            return off(far), right, CHANGES[change]


class TurnTable(ToyTable):
    """A mat with one L-shaped block, and a picture of how it is to lie.

    Attributes:
        turn_deg: By how much it has to be turned [degrees clockwise]: one of ANSWERS_DEG, not 0.
        at, goal_at: Middle of the block now and in the goal [px].
        goal: The picture of the goal.
    """

    def __init__(self, seed: int = 0) -> None:
        rng = np.random.default_rng([seed, 17])
        self.seed = seed
        colour = str(rng.choice(list(COLOURS)))
        self.words = f"{colour} L-shaped block"
        start = float(rng.uniform(0, 360))
        self.turn_deg = float(ANSWERS_DEG[1 + int(rng.integers(len(ANSWERS_DEG) - 1))])
        self.at, self.goal_at = (_place(rng) for _ in range(2))
        self.mask, goal_mask = _block(self.at, start), _block(self.goal_at, start + self.turn_deg)
        camera = AffineCamera(np.array([[PX_PER_M, 0, 0, 0], [0, PX_PER_M, 0, 0], [0, 0, -1, 1.0]]))
        self.view = View("toy", "toy", 0.0, _mat(self.mask, colour), None, camera)
        self.goal = View("toy goal", "toy goal", 0.0, _mat(goal_mask, colour), None, camera)
        self.instruction = Instruction(f"Turn the {self.words} as the goal shows it")
        self.things = ()
        self.privileged = TurnTruth(self, goal_mask)

    @property
    def box(self) -> Box:  # type: ignore[override]
        """Tight round the block [px]."""
        return _box(self.mask)


class TurnTruth(ToyTruth):
    """What simulated models know of it: the block, now and in the goal."""

    def __init__(self, table: TurnTable, goal_mask: Array) -> None:
        super().__init__(table)
        self._of, self._goal_mask = table, goal_mask

    @cached_property
    def _things(self) -> dict[str, TrueThing]:
        return {self._of.words: _true_block(self._of.words, self._of.at, self._of.mask, 0.0)}

    @cached_property
    def _views(self) -> dict[str, GroundTruthView]:
        name, table = self._of.words, self._of
        goal = _true_block(name, table.goal_at, self._goal_mask, -math.radians(table.turn_deg))
        return {
            table.view.id: GroundTruthView(table.view, {name: table.mask}, self._things),
            table.goal.id: GroundTruthView(table.goal, {name: self._goal_mask}, {name: goal}),
        }

    def observation_log(self, view_id: str) -> tuple[GroundTruthView, ...]:
        return (self._views[view_id],) if view_id in self._views else ()


def _place(rng: np.random.Generator) -> Point:
    room = 1.5 * ARM_PX
    x, y = (float(value) for value in rng.uniform(room, SIDE_PX - room, size=2))
    return round(x), round(y)


def _block(at: Point, turn_deg: float) -> Array:
    """An L, turned clockwise about its middle, shape (H, W), bool."""
    rows, columns = np.mgrid[0:SIDE_PX, 0:SIDE_PX] + 0.5
    angle = math.radians(turn_deg)
    dx, dy = columns - at[0], rows - at[1]
    # Rows grow downwards, so a clockwise turn of the thing is a turn by +angle in (x, y) of the picture.
    x, y = dx * math.cos(angle) + dy * math.sin(angle), -dx * math.sin(angle) + dy * math.cos(angle)
    x, y = x + ARM_PX / 4, y + ARM_PX / 2
    long_arm = (x >= 0) & (x < THICK_PX) & (y >= 0) & (y < ARM_PX)
    short_arm = (x >= 0) & (x < ARM_PX / 2 + THICK_PX / 2) & (y >= ARM_PX - THICK_PX) & (y < ARM_PX)
    return np.asarray(long_arm | short_arm)


def _mat(mask: Array, colour: str) -> Array:
    rgb = np.full((SIDE_PX, SIDE_PX, 3), MAT, np.uint8)
    rgb[mask] = COLOURS[colour]
    return rgb


def _box(mask: Array) -> Box:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return Box(float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))


def _true_block(words: str, at: Point, mask: Array, yaw_rad: float) -> TrueThing:
    box, middle = _box(mask), np.array([*at, 0.0]) / PX_PER_M
    outline = np.array(box.corners) / PX_PER_M
    return TrueThing(words, words, "object", "L", words.partition(" ")[0], middle, yaw_rad, 0.0, outline, middle)
