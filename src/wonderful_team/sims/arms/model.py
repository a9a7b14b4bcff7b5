"""From a list of things and an arm to a MuJoCo model: table, pedestal, lights, cameras, one body per thing."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.arms.cameras import PinholeLens
from wonderful_team.sims.arms.rows import ArmRow
from wonderful_team.sims.tabletop.appearance import Look
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.model import (
    FLOOR_GROUP,
    FLOOR_RGB,
    TABLE_GROUP,
    TABLE_RGB,
    BuiltModel,
    Thing,
    add_lights,
    add_meshes,
    add_texture,
    add_thing,
    camera_quaternion,
    covers_of,
    set_physics,
)

TABLE_M = (0.16, 0.82, 0.52)
"""Nearest and farthest edge of the table, and half its width, in the robot's base frame [m]."""
PREFIX = "arm/"
"""Of every name of the arm and its gripper in the scene's model."""
IMPRATIO = 10.0
"""Friction to normal forces of contacts: below it, what is held creeps out of the fingers."""


@dataclass(frozen=True, eq=False, kw_only=True)
class BuiltArm(BuiltModel):
    """A compiled scene with an arm in it.

    Attributes:
        row: Which arm.
        bodies: Ids of the arm's and the gripper's bodies.
    """

    row: ArmRow
    bodies: frozenset[int]

    def arm_id(self, kind: Any, name: str) -> int:
        """Id of something of the arm by the name that its own file gives it."""
        return int(mj.mj_name2id(self.model, kind, PREFIX + name))


def build(
    row: ArmRow,
    things: Sequence[Thing],
    look: Look,
    size_px: tuple[int, int],
    free: Callable[[Thing], bool],
    furnish: Callable[[Any], None] | None = None,
    decorate: Callable[[Any], None] | None = None,
) -> BuiltArm:
    """Compile a scene.

    Args:
        row: The arm.
        things: What stands on the table.
        look: How it is lit and from where it is seen.
        size_px: Of the pictures.
        free: Which of the things physics moves.
        furnish: Adds what a task needs beside its things to the specification.
        decorate: See `BuiltModel`.
    """
    spec = mj.MjSpec()
    set_physics(spec, size_px, IMPRATIO)
    arm = row.load()
    _add_surroundings(spec, look, arm.worldbody.bodies[0].pos)
    for name in sorted({thing.texture for thing in things}):
        add_texture(spec, name)
    for body in {thing.body.key: thing.body for thing in sorted(things, key=lambda t: t.body.key)}.values():
        add_meshes(spec, body)
    for thing in things:
        add_thing(spec, thing, free=free(thing), held_by=None)
    if furnish is not None:
        furnish(spec)
    for body in arm.bodies:
        # Controllers of real arms make up for the weight of the arm and of the gripper they are told of.
        body.gravcomp = 1.0
    spec.attach(arm, prefix=PREFIX, frame=spec.worldbody.add_frame())
    model = spec.compile()
    root = [k for k in range(model.nbody) if (mj.mj_id2name(model, mj.mjtObj.mjOBJ_BODY, k) or "").startswith(PREFIX)]
    return BuiltArm(
        model, tuple(things), covers_of(model, things), look, "gripper", decorate, row=row, bodies=frozenset(root)
    )


def _add_surroundings(spec: Any, look: Look, base_m: Array) -> None:
    world = spec.worldbody
    add_lights(world, look.light)
    for one in look.lenses.values():
        assert isinstance(one, PinholeLens)
        world.add_camera(name=one.name, pos=one.position_m, quat=camera_quaternion(one), fovy=one.fovy_deg)
    for name, rgb in {"table": TABLE_RGB, "floor": FLOOR_RGB}.items():
        material = spec.add_material(name=name, rgba=(*(c / 255 for c in rgb), 1.0))
        material.specular, material.shininess, material.reflectance = 0.0, 0.0, 0.0
    box = mj.mjtGeom.mjGEOM_BOX
    near, far, half = TABLE_M
    world.add_geom(
        name="table", type=box, size=((far - near) / 2, half, 0.02), pos=((near + far) / 2, 0, -0.02),
        material="table", group=TABLE_GROUP, friction=(0.9, 0.005, 0.002), condim=6,
    )  # fmt: skip
    x, top = float(base_m[0]), float(base_m[2]) - 0.001
    # As far as the table where the arm stands close to it.
    ends = x - 0.1, min(x + 0.1, near)
    world.add_geom(
        name="pedestal", type=box, size=((ends[1] - ends[0]) / 2, 0.1, (top + 0.061) / 2),
        pos=((ends[0] + ends[1]) / 2, 0.0, (top - 0.061) / 2), material="floor", group=FLOOR_GROUP, contype=0, conaffinity=0,
    )  # fmt: skip
    world.add_geom(
        name="floor", type=box, size=(2.0, 2.0, 0.01), pos=(0.5, 0, -0.07), material="floor", group=FLOOR_GROUP
    )


def upright(quaternion: ArrayLike) -> float:
    """How far something leans over [rad], from its quaternion (wxyz)."""
    w, x, y, z = (float(value) for value in np.asarray(quaternion))
    return math.acos(float(np.clip(1 - 2 * (x * x + y * y) / (w * w + x * x + y * y + z * z), -1.0, 1.0)))
