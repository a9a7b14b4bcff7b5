"""The scene of a seed: what stands where, what is asked, and the model that the simulator is given."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.affinity import rotate, translate

from wonderful_team.sims.arms.cameras import PinholeLens
from wonderful_team.sims.fetch.things import BOX, KINDS, LID, LID_M, RIM_M, Kind, Solid
from wonderful_team.sims.tabletop.seeds import generator

ORIGIN_M = (1.05, 0.75, 0.4)
"""Of the base frame, in the package's own world: the middle of the table's near edge, on its top [m]."""
TABLE_M = (0.5, 0.35)
"""The table reaches so far from the origin: along x, and to both sides along y [m]."""
STAND_M = ((0.06, -0.3), (0.35, 0.3))
"""Where middles of things may stand: what the arm reaches pointing straight down [m]."""
FINGERS_M = (0.05, 0.085)
"""Room round the middle of a thing for the open gripper, along x and y [m]."""
APART_M, RIGHTMOST_M, TRIES = 0.02, 0.05, 4000
MOST_YAW_RAD = math.radians(12)
"""Things with corners stand turned by at most this: the gripper does not turn."""
COUNT = 4
BOX_NAME, LID_NAME = "box", "lid"


@dataclass(frozen=True)
class Stands:
    """A thing on the table: its foot's middle and its turn."""

    name: str
    kind: Kind
    x_m: float
    y_m: float
    yaw_rad: float
    z_m: float = 0.0

    def footprint(self, more_m: tuple[float, float] = (0.0, 0.0)) -> shapely.Polygon:
        """What it covers of the table, with a margin along both of its sides."""
        return footprint(self.kind, self.x_m, self.y_m, self.yaw_rad, more_m)


@dataclass(frozen=True)
class FetchScene:
    """One scene.

    Attributes:
        things: By name; the box and its lid too.
        wanted: Names of what has to go into the box.
        words: The instruction.
    """

    things: Mapping[str, Stands]
    wanted: tuple[str, ...]
    words: str


def footprint(kind: Kind, x_m: float, y_m: float, yaw_rad: float, more_m: tuple[float, float] = (0.0, 0.0)) -> shapely.Polygon:  # fmt: skip
    """What a thing covers of the table, from above."""
    if kind.round:
        return shapely.Point(x_m, y_m).buffer(kind.half_m[0] + max(more_m))
    half_x, half_y = kind.half_m[0] + more_m[0], kind.half_m[1] + more_m[1]
    return translate(rotate(shapely.box(-half_x, -half_y, half_x, half_y), yaw_rad, use_radians=True), x_m, y_m)


def set_table(seed: int, count: int) -> FetchScene:
    """The scene of a seed, with one or two things to be put into the box."""
    rng = generator(seed, "fetch", count)
    for _ in range(TRIES):
        things = _placed(rng)
        if things is None:
            continue
        names = [name for name in things if name not in (BOX_NAME, LID_NAME)]
        by_y = sorted(names, key=lambda name: things[name].y_m)
        rightmost, others = by_y[-1], by_y[:-1]
        box = things[BOX_NAME]
        clear = things[rightmost].y_m - max(things[others[-1]].y_m, box.y_m + box.kind.half_m[1])
        if clear < RIGHTMOST_M:
            continue
        named = str(rng.choice(others))
        by_place = bool(rng.random() < 0.5)
        wanted = (named, rightmost) if count == 2 else (rightmost if by_place else named,)
        said = [KINDS[named].words, "rightmost object"] if count == 2 else ["rightmost object" if by_place else KINDS[named].words]  # fmt: skip
        return FetchScene(
            things, wanted, f"Place the {' and the '.join(said)} inside the small blue box with a black handle."
        )
    raise AssertionError(f"no scene in {TRIES} tries for seed {seed}")


def _placed(rng: np.random.Generator) -> dict[str, Stands] | None:
    """The box with its lid, room for the lid beside it, and four things, apart from each other; None when they do not fit."""
    (low_x, low_y), (high_x, high_y) = STAND_M
    box = Stands(BOX_NAME, BOX, rng.uniform(0.13, 0.28), rng.uniform(low_y + 0.1, 0.08), 0.0)
    free = Stands("", LID, rng.uniform(0.1, 0.3), rng.uniform(low_y + 0.08, high_y - 0.08), 0.0)
    taken = [box.footprint((APART_M, APART_M)), free.footprint((APART_M, APART_M))]
    if taken[0].intersects(taken[1]):
        return None
    things = {BOX_NAME: box, LID_NAME: Stands(LID_NAME, LID, box.x_m, box.y_m, 0.0, RIM_M)}
    rooms = list(taken)
    for name in rng.permutation(list(KINDS))[:COUNT]:
        kind = KINDS[str(name)]
        for _ in range(30):
            yaw = 0.0 if kind.round else rng.uniform(-MOST_YAW_RAD, MOST_YAW_RAD)
            one = Stands(str(name), kind, rng.uniform(low_x, high_x), rng.uniform(low_y, high_y), yaw)
            body, room = one.footprint((0.005, 0.005)), _room(one)
            if not any(room.intersects(other) for other in taken) and not any(
                body.intersects(other) for other in rooms
            ):
                break
        else:
            return None
        things[one.name] = one
        taken.append(body)
        rooms.append(room)
    return things


def _room(one: Stands) -> shapely.Polygon:
    """Where the open gripper comes down to take it."""
    c, s = math.cos(one.yaw_rad), math.sin(one.yaw_rad)
    x = one.x_m + c * one.kind.grasp_m[0] - s * one.kind.grasp_m[1]
    y = one.y_m + s * one.kind.grasp_m[0] + c * one.kind.grasp_m[1]
    room = shapely.box(x - FINGERS_M[0], y - FINGERS_M[1], x + FINGERS_M[0], y + FINGERS_M[1])
    return room.union(one.footprint()).envelope


def room_for_lid(things: Mapping[str, shapely.Polygon], near_m: tuple[float, float]) -> tuple[float, float] | None:
    """Where the lid's middle may go such that it lies on free table; the nearest such place, None when there is none.

    Args:
        things: What everything but the lid covers of the table.
        near_m: From where it comes.
    """
    (low_x, low_y), (high_x, high_y) = STAND_M
    taken = shapely.union_all([shape.buffer(0.012) for shape in things.values()])
    inside = shapely.box(0.01, 0.01 - TABLE_M[1], TABLE_M[0] - 0.01, TABLE_M[1] - 0.01)
    found = []
    for x in np.arange(low_x, high_x, 0.01):
        for y in np.arange(low_y, high_y, 0.01):
            plate = shapely.box(x - LID_M[0] / 2, y - LID_M[1] / 2, x + LID_M[0] / 2, y + LID_M[1] / 2)
            if inside.contains(plate) and not taken.intersects(plate):
                found.append((math.dist((x, y), near_m), float(x), float(y)))
    return min(found)[1:] if found else None


def model_xml(scene: FetchScene, lenses: Mapping[str, PinholeLens], assets: str) -> str:
    """The MuJoCo model: the package's own robot and table, our things and cameras.

    Args:
        scene: What stands on the table.
        lenses: Cameras by name.
        assets: What stands for the folder of the package's files, which are included and not copied.
    """
    bodies = "\n".join(_body(one, number) for number, one in enumerate(scene.things.values()))
    cameras = "\n".join(_camera(lens) for lens in lenses.values())
    x, y, z = ORIGIN_M
    return f"""\
<mujoco>
  <compiler angle="radian" meshdir="{assets}/stls/fetch" texturedir="{assets}/textures"/>
  <option timestep="0.002"/>
  <visual><headlight ambient="0.25 0.25 0.25" diffuse="0.25 0.25 0.25" specular="0 0 0"/><quality offsamples="0" shadowsize="0"/><map znear="0.01"/></visual>
  <include file="{assets}/fetch/shared.xml"/>
  <worldbody>
    <geom name="floor0" pos="0.8 0.75 0" size="1.2 1 1" type="plane" condim="3" material="floor_mat"/>
    <body name="floor0" pos="0.8 0.75 0"><site name="target0" pos="0 0 0.5" size="0.02" rgba="0 0 0 0"/></body>
    <include file="{assets}/fetch/robot.xml"/>
    <body name="table0" pos="{x + TABLE_M[0] / 2} {y} {z / 2}">
      <geom name="table0" size="{TABLE_M[0] / 2} {TABLE_M[1]} {z / 2}" type="box" mass="2000" material="table_mat"/>
    </body>
    <light directional="true" ambient="0.1 0.1 0.1" diffuse="0.35 0.35 0.35" specular="0 0 0" castshadow="false" pos="0 0 4" dir="0.2 0.1 -1"/>
{cameras}
{bodies}
  </worldbody>
  <actuator>
    <position ctrllimited="true" ctrlrange="0 0.2" joint="robot0:l_gripper_finger_joint" kp="30000" name="robot0:l_gripper_finger_joint" user="1"/>
    <position ctrllimited="true" ctrlrange="0 0.2" joint="robot0:r_gripper_finger_joint" kp="30000" name="robot0:r_gripper_finger_joint" user="1"/>
  </actuator>
</mujoco>
"""


def body_name(scene: FetchScene, name: str) -> str:
    """What the model calls a thing: the first object is `object0`, as the package's own code wants it."""
    objects = [one for one in scene.things if one not in (BOX_NAME, LID_NAME)]
    return f"object{objects.index(name)}" if name in objects else name


def _body(one: Stands, number: int) -> str:
    named = {BOX_NAME: BOX_NAME, LID_NAME: LID_NAME}.get(one.name, f"object{number - 2}")
    volumes = [_volume(solid) for solid in one.kind.solids]
    geoms = "\n".join(
        _geom(solid, f"{named}:{k}", one.kind.kg * volume / sum(volumes))
        for k, (solid, volume) in enumerate(zip(one.kind.solids, volumes, strict=True))
    )
    x, y, z = (low + at for low, at in zip(ORIGIN_M, (one.x_m, one.y_m, one.z_m), strict=True))
    half = one.yaw_rad / 2
    return f"""\
    <body name="{named}" pos="{x} {y} {z}" quat="{math.cos(half)} 0 0 {math.sin(half)}">
      <joint name="{named}:joint" type="free" damping="0.001"/>
      <site name="{named}" size="0.005" rgba="0 0 0 0"/>
{geoms}
    </body>"""


def _geom(solid: Solid, name: str, kg: float) -> str:
    kind, turned = ("cylinder", ' euler="1.5707963 0 0"') if solid.shape == "wheel" else (solid.shape, "")
    at, size = " ".join(f"{v:.5f}" for v in solid.at_m), " ".join(f"{v:.5f}" for v in solid.size_m)
    rgba = " ".join(f"{v:.3f}" for v in (*solid.rgb, 1.0))
    return (
        f'      <geom name="{name}" type="{kind}" pos="{at}" size="{size}"{turned} rgba="{rgba}" mass="{kg:.5f}" condim="4" '
        'friction="1.0 0.02 0.001" solref="0.008 1" solimp="0.95 0.99 0.001"/>'
    )


def _volume(solid: Solid) -> float:
    if solid.shape == "box":
        return 8 * math.prod(solid.size_m)
    return 2 * math.pi * solid.size_m[0] ** 2 * solid.size_m[1]


def _camera(lens: PinholeLens) -> str:
    at = " ".join(f"{v:.5f}" for v in np.asarray(ORIGIN_M) + lens.position_m)
    axes = " ".join(f"{v:.6f}" for v in (*lens.right, *-lens.down))
    return f'    <camera name="{lens.name}" pos="{at}" xyaxes="{axes}" fovy="{lens.fovy_deg:.6f}"/>'
