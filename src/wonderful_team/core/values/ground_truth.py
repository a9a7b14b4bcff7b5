"""What really stands on a simulator's table: for scorers and simulated models only, never for a planner."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from wonderful_team.core.geometry.arrays import Array, frozen_array
from wonderful_team.core.values.observation import View


@dataclass(frozen=True, eq=False)
class TrueThing:
    """One thing as it stands now.

    Attributes:
        name: Unique in the scene.
        words: What a person who sees it would call it, such as "red and green striped star".
        kind: object (can be picked or pushed), container (things are put into it) or area (flat, marked on the table).
        shape, cover: Names of its shape and its texture.
        position_m: Its centre in the base frame, shape (3,) [m].
        yaw_rad: Which way it is turned, counter-clockwise.
        height_m: Of its top above the table.
        outline_m: What it covers seen from above: corners of a simple polygon in the base frame, shape (N, 2) [m].
        grasp_m: A point (x, y, z) at which a suction gripper holds it, shape (3,) [m].
    """

    name: str
    words: str
    kind: str
    shape: str
    cover: str
    position_m: Array
    yaw_rad: float
    height_m: float
    outline_m: Array
    grasp_m: Array

    def __post_init__(self) -> None:
        for name, shape in (("position_m", (3,)), ("outline_m", (None, 2)), ("grasp_m", (3,))):
            object.__setattr__(self, name, frozen_array(getattr(self, name), shape, name))


@dataclass(frozen=True, eq=False)
class GroundTruthView:
    """One view or instruction picture as it really was when it was drawn.

    Attributes:
        view: Its clean pixels; `view.id` is the id that pictures cut from it carry in their frame.
        masks: Which of its pixels show each thing, shape (H, W) bool, by the thing's name (or a prop's, in a picture
            of something that is not on the table).
        things: Each of them as it stood in this very picture, by the same names; may leave out what nobody knows.
    """

    view: View
    masks: Mapping[str, Array]
    things: Mapping[str, TrueThing] = field(default_factory=dict)
