"""From how things moved to a score: what is in the box, where the lid is, and how it came there."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Score
from wonderful_team.sims.fetch.scene import BOX_NAME, LID_NAME, TABLE_M, FetchScene
from wonderful_team.sims.fetch.things import BOX_INSIDE_M, LID_M, RIM_M, Kind

LEANS_RAD = math.radians(5)
"""What leans by more does not stand upright, or lie flat."""
LOW_M = 0.006
"""What lies on the table has its foot no higher than this [m]."""
DEEP_M = 0.01
"""Something in the box reaches so far below its rim [m]."""
OFF_M, LIFTED_M = 0.02, 0.003
"""A lid that is so far from the middle of its box is off it; it came off lifted when it was then held, and so far above the rim [m]."""


@dataclass(frozen=True, eq=False)
class Track:
    """How things moved, one row per step of the simulator.

    Attributes:
        poses: By name, shape (N, 7) each: position in the base frame [m] and quaternion wxyz.
        held: By name, shape (N,) bool: whether both fingers touched it.
    """

    poses: Mapping[str, Array]
    held: Mapping[str, Array]


def lid_on(poses: Mapping[str, Pose]) -> bool:
    """Whether the lid lies on its box."""
    x, y, z = _in_box(poses[LID_NAME].position_m, poses[BOX_NAME])
    return math.hypot(x, y) <= OFF_M and -LOW_M <= z - RIM_M <= LOW_M


def lid_on_table(poses: Mapping[str, Pose]) -> str:
    """What keeps the lid from lying on the table; "" when it does."""
    pose = poses[LID_NAME]
    x, y, z = (float(v) for v in pose.position_m)
    if lid_on(poses):
        return "the lid is on the box"
    if not (0 <= x <= TABLE_M[0] and abs(y) <= TABLE_M[1]) or z < -LOW_M:
        return "the lid is not on the table"
    if leans_rad(pose) > LEANS_RAD or z > LOW_M:
        return f"the lid does not lie flat on the table: {1000 * z:.0f} mm high, leaning {math.degrees(leans_rad(pose)):.0f} degrees"
    return ""


def pushed_off(track: Track) -> bool:
    """Whether the lid left its box without being lifted: not held, or not above the rim, when it was first off it."""
    lid, box = track.poses[LID_NAME], track.poses[BOX_NAME]
    off = np.flatnonzero(np.hypot(*(lid[:, :2] - box[:, :2]).T) > OFF_M)
    if not len(off):
        return False
    first = int(off[0])
    above = float(lid[first, 2] - box[first, 2]) - RIM_M
    return not bool(track.held[LID_NAME][first]) or above < LIFTED_M


def inside(kind: Kind, pose: Pose, box: Pose) -> bool:
    """Whether a thing is in the box: its middle between the walls, and its lowest point below the rim."""
    middle = pose.apply(np.array([(0.0, 0.0, kind.height_m / 2)]))[0]
    x, y, _ = _in_box(middle, box)
    if abs(x) > BOX_INSIDE_M[0] / 2 or abs(y) > BOX_INSIDE_M[1] / 2:
        return False
    half_x, half_y = kind.half_m
    corners = np.array([(a * half_x, b * half_y, c * kind.height_m) for a in (-1, 1) for b in (-1, 1) for c in (0, 1)])
    lowest = min(_in_box(corner, box)[2] for corner in pose.apply(corners))
    return lowest < RIM_M - DEEP_M


def leans_rad(pose: Pose) -> float:
    """How far something leans from upright [rad]."""
    return math.acos(float(np.clip(pose.rotation[2, 2], -1.0, 1.0)))


def missing(scene: FetchScene, poses: Mapping[str, Pose], touched: Sequence[str], track: Track) -> list[str]:
    """Everything that keeps the task from being done."""
    found = []
    for name in scene.wanted:
        if not inside(scene.things[name].kind, poses[name], poses[BOX_NAME]):
            found.append(f"the {scene.things[name].kind.words} is not in the box")
        elif name in touched:
            found.append(f"the {scene.things[name].kind.words} was not let go")
    for name, one in scene.things.items():
        if name in (BOX_NAME, LID_NAME, *scene.wanted):
            continue
        if inside(one.kind, poses[name], poses[BOX_NAME]):
            found.append(f"the {one.kind.words} is in the box too")
        elif float(poses[name].position_m[2]) < -0.05:
            found.append(f"the {one.kind.words} fell off the table")
    if leans_rad(poses[BOX_NAME]) > LEANS_RAD or float(poses[BOX_NAME].position_m[2]) > LOW_M:
        found.append("the box does not stand upright on the table")
    lid = lid_on_table(poses)
    found += [lid] if lid else []
    if LID_NAME in touched:
        found.append("the lid was not let go")
    if pushed_off(track):
        found.append("the lid was pushed off, not lifted")
    return found


def score_of(
    scene: FetchScene, poses: Mapping[str, Pose], touched: Sequence[str], track: Track, closings: int
) -> Score:
    """Success when nothing is missing; else all that is, and the stage at which it failed.

    Args:
        scene: What stands where, and what is asked.
        poses: Where things are at the end.
        touched: What the fingers still touch.
        track: How things moved.
        closings: How often the fingers were closed.
    """
    found = missing(scene, poses, touched, track)
    if not found:
        return Score(True, None, "what was asked for is in the box, and its lid lies on the table")
    return Score(False, _stage(scene, track, closings), "; ".join(found))


def _stage(scene: FetchScene, track: Track, closings: int) -> str:
    """Never closed, or no lid lifted, or not everything taken: plan; closed on nothing: grounding; on others: wrong object."""
    held = {name for name, flags in track.held.items() if flags.any()}
    if not closings:
        return "plan"
    if not held:
        return "grounding"
    if held - {LID_NAME, *scene.wanted}:
        return "wrong object"
    return "execution" if {LID_NAME, *scene.wanted} <= held else "plan"


def _in_box(point_m: Array, box: Pose) -> tuple[float, float, float]:
    x, y, z = (np.asarray(point_m) - box.position_m) @ box.rotation
    return float(x), float(y), float(z)


LID_TOP_M = RIM_M + LID_M[2]
"""Height of the closed box without the lid's handle [m]."""
