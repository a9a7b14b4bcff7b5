"""From a list of things to a MuJoCo model: table, lights, cameras, one body per thing."""

from __future__ import annotations

import hashlib
import math
import pickle
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
import shapely

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop import textures
from wonderful_team.sims.tabletop.appearance import Light, Look, plain_look
from wonderful_team.sims.tabletop.cameras import SEEN_WIDTH_M, Lens
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.shapes import Shape, shape
from wonderful_team.sims.tabletop.solids import Mesh, extruded

TIMESTEP_S = 0.002
THING_GROUP, TABLE_GROUP, FLOOR_GROUP, WHITE_GROUP, COLLISION_GROUP = 0, 1, 2, 4, 3
"""What is drawn together: things, the table, the floor round it, a white ground for pictures of one thing alone."""
SHADOW_PX = 4096
"""Side of the map that shadows are drawn from [px]."""
SHADE = 0.82
"""How bright the floor inside a container is, against its walls."""
TABLE_RGB = (224, 219, 208)
FLOOR_RGB = (148, 152, 158)
DENSITY = 350.0
"""Of every thing [kg/m^3]: like light wood."""
ToolName: TypeAlias = Literal["suction", "spatula", "gripper"]
BLADE_HALF_M = (0.002, 0.02, 0.014)
"""Half the thickness, width and height of the spatula's blade [m]; it pushes along its own x axis."""
BLADE_BIT = 2
"""Collision bit of the blade: it touches what can be moved, and nothing else."""


@dataclass(frozen=True)
class Thing:
    """One thing on the table as it stands at the start.

    Attributes:
        name: Unique in the scene; never shown to a planner.
        x_m, y_m, yaw_rad: Where its centre stands and how it is turned.
        z_m: Height of its bottom [m].
        stretch: How many times as high as usual it is.
    """

    name: str
    shape: str
    texture: str
    x_m: float
    y_m: float
    yaw_rad: float
    z_m: float = 0.0
    stretch: float = 1.0

    @property
    def body(self) -> Shape:
        return shape(self.shape, self.stretch)


@dataclass(frozen=True, eq=False)
class BuiltModel:
    """A compiled model and where each thing is in it.

    Attributes:
        covers: Texture of each geom that is seen and how bright it is, by geom id.
        look: How it is lit and from where it is seen.
        tool: What the robot holds: a suction cup, which needs no body of its own, a spatula, or the gripper of an arm.
        decorate: Adds what no body shows, such as ink, to MuJoCo's visual scene before it is drawn.
        same_as: Digest of all that the model was made from; None where that is not known.
    """

    model: Any
    things: tuple[Thing, ...]
    covers: dict[int, tuple[str, float]]
    look: Look
    tool: ToolName = "suction"
    decorate: Callable[[Any], None] | None = None
    same_as: str | None = None

    @property
    def lenses(self) -> dict[str, Lens]:
        """The cameras by name."""
        return self.look.lenses

    def body_id(self, name: str) -> int:
        return int(mj.mj_name2id(self.model, mj.mjtObj.mjOBJ_BODY, name))


def covers_of(model: Any, things: Sequence[Thing]) -> dict[int, tuple[str, float]]:
    """Texture and brightness of each geom of these things that is seen, by geom id."""
    covers = {}
    for thing in things:
        for name, brightness in ((f"see {thing.name}", 1.0), (f"floor of {thing.name}", SHADE)):
            geom = int(mj.mj_name2id(model, mj.mjtObj.mjOBJ_GEOM, name))
            if geom >= 0:
                covers[geom] = (thing.texture, brightness)
    return covers


def build(
    things: Sequence[Thing], size_px: tuple[int, int], tool: ToolName = "suction", look: Look | None = None
) -> BuiltModel:
    """Compile a model with these things, a tool and a look; the usual look if none is given."""
    spec = mj.MjSpec()
    look = look or plain_look(size_px)
    _set_options(spec, size_px, look)
    _add_surroundings(spec, look)
    held = spec.worldbody.add_body(name="tool", mocap=True, pos=(0.5, 0.0, 0.3))
    if tool == "spatula":
        held.add_geom(
            name="blade", type=mj.mjtGeom.mjGEOM_BOX, size=BLADE_HALF_M, group=COLLISION_GROUP, condim=4,
            friction=(0.3, 0.005, 0.002), contype=BLADE_BIT, conaffinity=0, solref=(0.004, 1.0), priority=1, rgba=(0.5, 0.5, 0.5, 0.0),
        )  # fmt: skip
    for name in sorted({thing.texture for thing in things}):
        add_texture(spec, name)
    for body in {thing.body.key: thing.body for thing in sorted(things, key=lambda t: t.body.key)}.values():
        add_meshes(spec, body)
    for thing in things:
        add_thing(spec, thing)
    model = spec.compile()
    covers = covers_of(model, things)
    if look.table_cover is not None:
        covers[int(mj.mj_name2id(model, mj.mjtObj.mjOBJ_GEOM, "see table"))] = (look.table_cover, 1.0)
    made_from = hashlib.sha256(pickle.dumps((tuple(things), size_px, tool, look))).hexdigest()
    return BuiltModel(model, tuple(things), covers, look, tool, same_as=made_from)


def _set_options(spec: Any, size_px: tuple[int, int], look: Look) -> None:
    set_physics(spec, size_px, impratio=5.0)
    spec.visual.quality.offsamples = 4
    spec.visual.quality.shadowsize = SHADOW_PX if look.light.shadows else 0


def set_physics(spec: Any, size_px: tuple[int, int], impratio: float) -> None:
    """What holds for every table: time step, friction, and pictures without smoothing or shadows unless asked for."""
    spec.option.timestep = TIMESTEP_S
    spec.option.integrator = mj.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mj.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = impratio
    # What rests is left out of the computation until something touches it, or it is put elsewhere.
    spec.option.enableflags |= int(mj.mjtEnableBit.mjENBL_SLEEP)
    spec.visual.global_.offwidth, spec.visual.global_.offheight = size_px
    spec.visual.quality.offsamples = spec.visual.quality.shadowsize = 0
    spec.visual.headlight.active = 0
    spec.visual.map.znear, spec.visual.map.zfar = 0.1, 4.0
    spec.stat.extent = 1.0
    spec.stat.center = (0.5, 0.0, 0.0)


def _add_surroundings(spec: Any, look: Look) -> None:
    world = spec.worldbody
    add_lights(world, look.light)
    for one in look.lenses.values():
        world.add_camera(
            name=one.name,
            pos=one.position_m,
            quat=camera_quaternion(one),
            proj=mj.mjtProjection.mjPROJ_ORTHOGRAPHIC,
            fovy=one.seen_height_m,
        )
    colours = {"table": TABLE_RGB, "floor": FLOOR_RGB}
    for name, rgb in colours.items():
        material = spec.add_material(name=name, rgba=(*(c / 255 for c in rgb), 1.0))
        material.specular, material.shininess, material.reflectance = 0.0, 0.0, 0.0
    box = mj.mjtGeom.mjGEOM_BOX
    size = (0.25, 0.5, 0.02)
    world.add_geom(
        name="table",
        type=box,
        size=size,
        pos=(0.5, 0, -0.02),
        material="table",
        group=TABLE_GROUP if look.table_cover is None else COLLISION_GROUP,
        friction=(0.9, 0.005, 0.002),
        condim=6,
    )
    if look.table_cover is not None:
        _add_table_cover(spec, look.table_cover)
    far = SEEN_WIDTH_M * 2
    ground = {"type": box, "size": (far, far, 0.01)}
    world.add_geom(name="floor", pos=(0.5, 0, -0.06), material="floor", group=FLOOR_GROUP, **ground)
    white = spec.add_material(name="white", rgba=(1, 1, 1, 1), emission=1.0)
    white.specular, white.shininess, white.reflectance = 0.0, 0.0, 0.0
    world.add_geom(
        name="white", pos=(0.5, 0, -0.0105), material="white", group=WHITE_GROUP, contype=0, conaffinity=0, **ground
    )


def add_lights(world: Any, light: Light) -> None:
    """A light that casts shadows takes its ambient share away in them, so that this share has a light of its own."""
    parts = [((0.0,) * 3, light.diffuse, True), (light.ambient, (0.0,) * 3, False)]
    for ambient, diffuse, shadows in parts if light.shadows else [(light.ambient, light.diffuse, False)]:
        world.add_light(
            type=mj.mjtLightType.mjLIGHT_DIRECTIONAL,
            pos=np.array([0.5, 0.0, 0.0]) - 2.0 * light.direction if shadows else (0.5, 0.0, 2.0),
            dir=light.direction,
            ambient=ambient,
            diffuse=diffuse,
            specular=(0.0,) * 3,
            castshadow=shadows,
        )


def _add_table_cover(spec: Any, cover: str) -> None:
    """What is seen of a table with a pattern, where otherwise the box itself is seen."""
    add_texture(spec, cover)
    mesh = extruded(shapely.box(-0.5, -0.75, 0.5, -0.25), -0.04, 0.0, 0.0)
    _add_mesh(spec, "see table", mesh)
    spec.worldbody.add_geom(
        name="see table", type=mj.mjtGeom.mjGEOM_MESH, meshname="see table", material=f"cover {cover}",
        group=TABLE_GROUP, contype=0, conaffinity=0, mass=0,
    )  # fmt: skip


def camera_quaternion(one: Lens) -> Array:
    """How a camera stands: MuJoCo's cameras look along -z with y up."""
    quaternion = np.zeros(4)
    axes = np.column_stack([one.right, -one.down, -one.forward])
    mj.mju_mat2Quat(quaternion, axes.ravel())
    return quaternion


def add_texture(spec: Any, name: str) -> None:
    """A texture, and the two materials made of it: as it is, and shaded."""
    tile = textures.texture(name)
    texture = spec.add_texture(
        name=f"tile {name}", type=mj.mjtTexture.mjTEXTURE_2D, width=tile.shape[1], height=tile.shape[0], nchannel=3
    )
    texture.data = np.ascontiguousarray(tile).tobytes()
    for use, brightness in (("cover", 1.0), ("shaded", SHADE)):
        material = spec.add_material(name=f"{use} {name}", rgba=(brightness, brightness, brightness, 1.0))
        material.textures[mj.mjtTextureRole.mjTEXROLE_RGB] = f"tile {name}"
        material.specular, material.shininess, material.reflectance = 0.0, 0.0, 0.0


def add_meshes(spec: Any, body: Shape) -> None:
    """What of a shape is seen, and what it collides with."""
    for name, mesh in ((f"see {body.key}", body.mesh), (f"floor of {body.key}", body.inside)):
        if mesh is None:
            continue
        _add_mesh(spec, name, mesh)
    for k, piece in enumerate(body.pieces):
        spec.add_mesh(name=f"touch {body.key} {k}", uservert=piece.ravel())


def _add_mesh(spec: Any, name: str, mesh: Mesh) -> None:
    """Something to look at."""
    faces = np.arange(len(mesh.points_m), dtype=np.int32)
    seen = spec.add_mesh(name=name, inertia=mj.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    seen.uservert, seen.usernormal = mesh.points_m.ravel(), mesh.normals.ravel()
    seen.usertexcoord = (mesh.texture_m / textures.TILE_M + 0.5).ravel()
    seen.userface = seen.userfacenormal = seen.userfacetexcoord = faces


def add_thing(spec: Any, thing: Thing, *, free: bool | None = None, held_by: str | None = "tool") -> None:
    """A body for a thing.

    Args:
        spec: Gets the body.
        thing: Where it stands and what it is.
        free: Whether physics moves it; None for what its shape says.
        held_by: Body that a weld, switched off at first, can tie it to; None for a robot that holds by contact alone.
    """
    body = thing.body
    free = body.movable if free is None else free
    half = thing.yaw_rad / 2
    where = {"pos": (thing.x_m, thing.y_m, thing.z_m), "quat": (math.cos(half), 0, 0, math.sin(half))}
    made = spec.worldbody.add_body(name=thing.name, mocap=not free, **where)
    if free:
        made.add_freejoint(name=f"free {thing.name}")
    mesh = mj.mjtGeom.mjGEOM_MESH
    seen = {"type": mesh, "group": THING_GROUP, "contype": 0, "conaffinity": 0, "mass": 0}
    made.add_geom(name=f"see {thing.name}", meshname=f"see {body.key}", material=f"cover {thing.texture}", **seen)
    if body.inside is not None:
        floor = f"floor of {body.key}"
        made.add_geom(name=f"floor of {thing.name}", meshname=floor, material=f"shaded {thing.texture}", **seen)
    if body.kind == "area":
        return
    for k in range(len(body.pieces)):
        made.add_geom(
            name=f"touch {thing.name} {k}", type=mesh, meshname=f"touch {body.key} {k}", group=COLLISION_GROUP,
            density=DENSITY, condim=6, friction=(0.9, 0.005, 0.002), rgba=(0.5, 0.5, 0.5, 0.0),
            conaffinity=1 | BLADE_BIT if body.movable else 1,
        )  # fmt: skip
    if free and held_by is not None:
        hold = spec.add_equality(
            name=f"hold {thing.name}", type=mj.mjtEq.mjEQ_WELD, objtype=mj.mjtObj.mjOBJ_BODY,
            name1=held_by, name2=thing.name, active=False, solref=(0.004, 1.0),
        )  # fmt: skip
        # The specification's own default puts the anchor a metre away.
        hold.data[:] = 0.0
        hold.data[6] = hold.data[10] = 1.0
