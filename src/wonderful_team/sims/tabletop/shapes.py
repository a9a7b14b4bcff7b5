"""The shapes by name: what they look like, what they collide with, where suction holds them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Literal, TypeAlias

import numpy as np
import shapely
from shapely import LineString, Point, Polygon, box
from shapely.geometry.base import BaseGeometry

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.errors import UnknownNameError
from wonderful_team.sims.tabletop import bottles, fruits
from wonderful_team.sims.tabletop.outlines import outline
from wonderful_team.sims.tabletop.solids import CHAMFER_M, Mesh, convex_pieces, extruded, joined, polygons, prism

Kind: TypeAlias = Literal["kit", "base", "area", "fruit"]
Layer: TypeAlias = tuple[BaseGeometry, float, float]
"""An outline that stands from one height to another [m]."""
KIT_WIDTH_M = 0.136
KIT_HEIGHT_M = 0.034
BLOCK_M = 0.07
PAPER_M = 0.001

FULL_TURN = (
    "L-shaped block",
    "letter A",
    "letter E",
    "letter G",
    "letter M",
    "letter R",
    "letter T",
    "letter V",
    "heart",
)
"""Shapes that look the same only after a full turn."""
KIT = (
    *("block", "L-shaped block", "letter A", "letter E", "letter G", "letter M", "letter R", "letter T", "letter V"),
    *("cross", "diamond", "triangle", "flower", "heart", "hexagon", "pentagon", "ring", "round", "star"),
)
BASES = ("pan", "bowl", "frame", "square", "container", "pallet")
AREAS = ("paper", "line")
PLATE, PLATE_M, WELL_M = "plate", (0.1, 0.006), 0.08
"""A flat round plate: its radius and height, and the radius of the part inside its edge [m]."""
BOX, BOX_M = "box", (0.07, 0.008, 0.104, 0.055)
"""A box with a wide rim: half the room inside it, thickness of its walls, half of what its rim covers, and its height [m]."""
LID, LID_M = "lid", (0.077, 0.008)
"""A lid that rests on that rim: half its side, thickness of its plate [m]."""
HANDLE_M = (0.01, 0.03, 0.04)
"""The handle on the lid: half its width and half its length, and the height of its top over the lid's underside [m]."""
SMALL = {"shorter block": (BLOCK_M, 0.03), "small block": (0.03, 0.03), "cube": (0.045, 0.045)}
"""Cuboids by name: side and height [m]."""
CARDS = {"price tag": (0.11, 0.075), "label": (0.11, 0.044)}
"""Cards to print on by name: width, which is that of a tile, and depth [m]."""
THREE_SIDED = "three-sided rectangle"
ROOM_M = (0.3, 0.172)
"""Width and depth of the room inside the three-sided rectangle; it is open upwards in the drawing plane [m]."""
WALL_M = 0.012
LINE_M = (0.1875, 0.008)
"""Length and width of the line [m]."""


@dataclass(frozen=True, eq=False)
class Shape:
    """One shape, in its body frame: origin at the centre, z = 0 at the bottom.

    Attributes:
        footprint: What it covers seen from above, outline coordinates (a right, b up) [m].
        mesh: What is seen.
        inside: What is seen of its floor, in the shade of its walls; None without walls.
        pieces: Corners of convex pieces to collide with, shape (N, 3) each [m].
        grasp_ab: A point well inside the material, outline coordinates [m].
        movable: Whether a robot can carry or push it.
        stretch: How many times as high as usual it is.
    """

    name: str
    kind: Kind
    footprint: BaseGeometry
    height_m: float
    mesh: Mesh
    inside: Mesh | None
    pieces: tuple[Array, ...]
    grasp_ab: tuple[float, float]
    movable: bool
    stretch: float = 1.0

    @property
    def key(self) -> str:
        """A name that differs for each height of a shape."""
        return self.name if self.stretch == 1.0 else f"{self.name} x {self.stretch:g}"

    @property
    def radius_m(self) -> float:
        """Radius of the circle round the origin that holds the footprint [m]."""
        return float(shapely.hausdorff_distance(Point(0, 0), self.footprint.convex_hull))


def shape_names(kind: Kind | None = None) -> tuple[str, ...]:
    """All names, or those of one kind that tasks may choose among."""
    chosen = {"kit": KIT, "base": BASES, "area": AREAS, "fruit": fruits.NAMES}
    return (
        chosen[kind]
        if kind
        else (*KIT, *SMALL, *BASES, THREE_SIDED, PLATE, BOX, LID, *AREAS, *CARDS, *bottles.BOTTLES, *fruits.NAMES)
    )


@cache
def shape(name: str, stretch: float = 1.0) -> Shape:
    """A shape by name; made once for each height.

    Raises:
        UnknownNameError: No such shape; lists the known ones.
    """
    if stretch != 1.0:
        return _stretched(shape(name), stretch)
    if name in KIT:
        return _kit(name)
    if name in SMALL:
        side, height = SMALL[name]
        return _from_layers(name, "kit", [(outline("block", side), 0.0, height)], [], movable=True)
    if name in BASES:
        return _base(name)
    if name == THREE_SIDED:
        return _three_sided()
    if name == PLATE:
        return _plate()
    if name == BOX:
        return _box()
    if name == LID:
        return _lid()
    if name in AREAS or name in CARDS:
        width, depth = {"paper": (0.17, 0.17), "line": LINE_M, **CARDS}[name]
        across, along = width / 2, depth / 2
        return _from_layers(name, "area", [(box(-across, -along, across, along), 0.0, PAPER_M)], [], movable=False)
    if name in bottles.BOTTLES:
        return _from_layers(name, "kit", bottles.layers(name), [], movable=True)
    if name in fruits.NAMES:
        made = fruits.fruit(name)
        return Shape(name, "fruit", made.footprint, made.height_m, made.mesh, None, made.pieces, made.grasp_ab, True)
    raise UnknownNameError("shape", name, shape_names())


def _stretched(usual: Shape, stretch: float) -> Shape:
    """The same shape, higher or lower; the texture on its walls keeps its size."""
    up = np.array([1.0, 1.0, stretch])
    mesh = replace(usual.mesh, points_m=usual.mesh.points_m * up)
    inside = usual.inside and replace(usual.inside, points_m=usual.inside.points_m * up)
    pieces = tuple(piece * up for piece in usual.pieces)
    return replace(usual, height_m=usual.height_m * stretch, mesh=mesh, inside=inside, pieces=pieces, stretch=stretch)


def _three_sided() -> Shape:
    across, along = ROOM_M[0] / 2, ROOM_M[1] / 2
    around = box(-across - WALL_M, -along - WALL_M, across + WALL_M, along)
    wall = around.difference(box(-across, -along, across, along + WALL_M))
    return _from_layers(THREE_SIDED, "base", [(wall, 0.0, 0.02)], [], movable=False)


def _plate() -> Shape:
    """The part inside the edge is darker, and as high but for what keeps the two apart in a picture."""
    (radius, height), well = PLATE_M, Point(0, 0).buffer(WELL_M)
    edge = Point(0, 0).buffer(radius).difference(well)
    return _from_layers(PLATE, "base", [(edge, 0.0, height)], [(well, 0.0, height)], movable=False)


def _box() -> Shape:
    """Walls and a floor; a rim stands out from the walls at their top, so that what a lid rests on shows round the lid."""
    inner, thick, rim, height = BOX_M
    room, walls, edge = (box(-half, -half, half, half) for half in (inner, inner + thick, rim))
    layers: list[Layer] = [
        (walls.difference(room), 0.0, height - 0.006),
        (edge.difference(room), height - 0.006, height),
    ]
    return _from_layers(BOX, "base", layers, [(room, 0.0, 0.005)], movable=False)


def _lid() -> Shape:
    """A flat plate with a narrow upright handle on its middle."""
    (half, thick), (across, along, top) = LID_M, HANDLE_M
    plate, handle = box(-half, -half, half, half), box(-along, -across, along, across)
    return _from_layers(LID, "kit", [(plate, 0.0, thick), (handle, thick, top)], [], movable=True)


def _kit(name: str) -> Shape:
    width, height = (BLOCK_M, BLOCK_M) if name == "block" else (KIT_WIDTH_M, KIT_HEIGHT_M)
    return _from_layers(name, "kit", [(outline(name, width), 0.0, height)], [], movable=True)


def _base(name: str) -> Shape:
    round_room, square_room = Point(0, 0).buffer(0.094), box(-0.09, -0.09, 0.09, 0.09)
    match name:
        case "pan":
            dish = Point(0, 0).buffer(0.104)
            handle = LineString([(0.1, 0.0), (0.204, 0.0)]).buffer(0.0175).difference(box(0.0, -0.1, 0.1, 0.1))
            walls = [(dish.difference(round_room), 0.0, 0.03), (handle, 0.014, 0.026)]
            floor: list[Layer] = [(round_room, 0.0, 0.005)]
        case "bowl":
            rim = Point(0, 0).buffer(0.11).difference(Point(0, 0).buffer(0.098))
            walls = [(Point(0, 0).buffer(0.104).difference(round_room), 0.0, 0.03), (rim, 0.03, 0.045)]
            floor = [(round_room, 0.0, 0.005)]
        case "frame":
            walls, floor = [(box(-0.115, -0.115, 0.115, 0.115).difference(square_room), 0.0, 0.024)], []
        case "square":
            room = box(-0.092, -0.092, 0.092, 0.092)
            walls, floor = [(box(-0.1, -0.1, 0.1, 0.1).difference(room), 0.0, 0.014)], [(room, 0.0, 0.008)]
        case "container":
            walls = [(box(-0.1, -0.1, 0.1, 0.1).difference(square_room), 0.0, 0.05)]
            floor = [(square_room, 0.0, 0.005)]
        case _:
            walls, floor = [(outline("slats", 0.21), 0.014, 0.024)], [(outline("crossbars", 0.21), 0.0, 0.014)]
    return _from_layers(name, "base", walls, floor, movable=False)


def _from_layers(name: str, kind: Kind, layers: list[Layer], floor: list[Layer], *, movable: bool) -> Shape:
    everything = [*layers, *floor]
    footprint = shapely.unary_union([layer for layer, _, _ in everything])
    mesh = joined([extruded(layer, low, high, 0.0 if high - low < 0.01 else CHAMFER_M) for layer, low, high in layers])
    inside = joined([extruded(layer, low, high, 0.0) for layer, low, high in floor]) if floor else None
    pieces = tuple(prism(piece, low, high) for layer, low, high in everything for piece in convex_pieces(layer))
    height = max(high for _, _, high in layers)
    return Shape(name, kind, footprint, height, mesh, inside, pieces, _grasp_point(footprint), movable)


def _grasp_point(footprint: BaseGeometry) -> tuple[float, float]:
    """The centre where there is enough material round it, else the point farthest from every edge."""
    if footprint.contains(Point(0, 0).buffer(0.012)):
        return 0.0, 0.0
    largest: Polygon = max(polygons(footprint), key=lambda part: part.area)
    middle = shapely.maximum_inscribed_circle(largest, tolerance=0.0005)
    a, b = middle.coords[0]
    return float(a), float(b)
