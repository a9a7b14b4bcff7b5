"""The planned and the measured path of the tool: in space, over the table, and over the picture."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from wonderful_team.core.geometry import Camera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.pages.figures import mark_size, view_drawing
from wonderful_team.pages.height_profile import nice_step
from wonderful_team.pages.legs import Leg, corners_of
from wonderful_team.pages.pictures import Album, text_in_svg

_WIDTH, _MARGIN, _SIZE = 640.0, 26.0, 13.0
_AZIMUTH, _ELEVATION = math.radians(24.0), math.radians(32.0)
"""From where it is looked at: turned from the direction of the picture, and that high above the table."""
_BESIDE_M = 0.05
"""What lies farther outside of the workspace than this is not drawn [m]: the way from a parking place, for instance."""
_ROUND_M, _LEAST_M = 0.08, 0.25
"""The table is drawn so far round the paths, and at least so much of it [m]."""
_MOST_DROPS = 60
_DOTS = 8
"""Of at most so many positions in one action each is a dot."""
_FARTHEST_M = 10.0
"""A workspace that reaches farther is none that a drawing could show: a photo without a robot has such a one [m]."""


def picture_drawing(album: Album, key: str | None, legs: Sequence[Leg], camera: Camera) -> Markup:
    """The scene with both paths over it, seen by its camera."""
    shown = album.get(key)
    if shown is None:
        return Markup("")
    size = 0.4 * mark_size((0, 0, *shown.size_px))
    layers = []
    for css, paths in (("planned", [leg.points_m for leg in legs]), ("measured", measured_paths(legs))):
        for path in paths:
            points = _seen(path, camera, shown.size_px)
            layers += [_path(part, f"path {css}", rim=css == "planned") for part in points if len(part) > 1]
        if css == "measured":
            dots = [point for path in _single(legs) for part in _seen(path, camera, shown.size_px) for point in part]
            layers += [_dot(x, y, 0.5 * size, "measured-dot") for x, y in dots]
    return view_drawing(album, key, "the planned and the measured path over the picture", layers, "half")


def measured_paths(legs: Sequence[Leg]) -> list[Array]:
    """Measured positions as lines, from action to action as long as each has some; none where the world went its own way."""
    found: list[list[Array]] = []
    last = -1
    for leg in legs:
        if len(leg.measured_m) and leg.profile.get("stays"):
            if not found or leg.number != last + 1:
                found.append([])
            found[-1].append(leg.measured_m)
            last = leg.number
    return [np.vstack(parts) for parts in found]


def _single(legs: Sequence[Leg]) -> list[Array]:
    """Measured positions that stand alone; where a whole path was measured, its line says it all."""
    return [leg.measured_m for leg in legs if 0 < len(leg.measured_m) <= _DOTS]


def _seen(path: Array, camera: Camera, size_px: Sequence[int]) -> list[list[tuple[float, float]]]:
    """A path in pixels, in parts that lie within the picture or just beside it."""
    width, height = size_px
    parts: list[list[tuple[float, float]]] = [[]]
    for point in path:
        try:
            x, y = (float(value) for value in camera.project(point[None])[0])
        except ValueError:
            x = y = math.nan
        if -0.1 * width <= x <= 1.1 * width and -0.1 * height <= y <= 1.1 * height:
            parts[-1].append((x, y))
        elif parts[-1]:
            parts.append([])
    return [part for part in parts if part]


def space_drawing(legs: Sequence[Leg], limits: Mapping[str, Any] | None, camera: Camera | None) -> Markup:
    """Both paths over the table, drawn to one scale in all directions; lines drop to the table where the plan turns."""
    low, high = _bounds(legs, limits)
    right, up = _axes_of(camera)
    table_z = 0.0 if low[2] <= 0.0 <= high[2] else float(low[2])

    def flat(points: Array) -> Array:
        across, away = points[:, :2] @ right, points[:, :2] @ up
        x = across * math.cos(_AZIMUTH) + away * math.sin(_AZIMUTH)
        depth = away * math.cos(_AZIMUTH) - across * math.sin(_AZIMUTH)
        return np.column_stack([x, -(depth * math.sin(_ELEVATION) + points[:, 2] * math.cos(_ELEVATION))])

    planned = [part for leg in legs for part in _inside(leg.points_m, low, high)]
    measured = [part for path in measured_paths(legs) for part in _inside(path, low, high)]
    near, far = _shown_table([*planned, *measured], low, high)
    table = np.array([[near[0], near[1]], [far[0], near[1]], [far[0], far[1]], [near[0], far[1]]])
    table = np.column_stack([table, np.full(4, table_z)])
    everything = np.vstack([flat(part) for part in (table, *planned, *measured)])
    least, most = everything.min(axis=0), everything.max(axis=0)
    scale = (_WIDTH - 2 * _MARGIN) / max(1e-3, float(most[0] - least[0]))
    height = float(most[1] - least[1]) * scale + 2 * _MARGIN + 16

    def drawn(points: Array) -> list[tuple[float, float]]:
        return [(float(x), float(y)) for x, y in (flat(points) - least) * scale + (_MARGIN, _MARGIN)]

    layers = [_table(drawn, table, near, far, table_z)]
    layers += _drops(drawn, legs, low, high, table_z)
    layers += [_path(drawn(part), "path planned") for part in planned]
    layers += [_path(drawn(part), "path measured") for part in measured if len(part) > 1]
    single = [part for path in _single(legs) for part in _inside(path, low, high)]
    layers += [_dot(x, y, 3.2, "measured-dot") for part in single for x, y in drawn(part)]
    layers += _numbers(drawn, legs, low, high)
    words = f"The planned path of the tool over the table{' and the measured one' if measured else ''}"
    return Markup('<svg class="chart space" viewBox="0 0 {} {}" role="img" aria-label="{}">{}</svg>').format(
        f"{_WIDTH:.0f}", f"{height:.0f}", words, Markup("").join(layers)
    )


def _bounds(legs: Sequence[Leg], limits: Mapping[str, Any] | None) -> tuple[Array, Array]:
    """The workspace; where nobody says how far it reaches, what holds the path."""
    if limits is not None:
        low, high = np.array(limits["low_m"], dtype=np.float64), np.array(limits["high_m"], dtype=np.float64)
        if float((high - low).max()) <= _FARTHEST_M:
            return low, high
    points = np.vstack([leg.points_m for leg in legs])
    room = 0.1 * float(np.ptp(points, axis=0).max()) + 0.02
    return points.min(axis=0) - room, points.max(axis=0) + room


def _shown_table(paths: Sequence[Array], low: Array, high: Array) -> tuple[Array, Array]:
    """The part of the workspace that the paths need, so that a small figure is not drawn small."""
    if not paths:
        return low[:2], high[:2]
    points = np.vstack(paths)[:, :2]
    middle, half = (points.max(axis=0) + points.min(axis=0)) / 2, np.ptp(points, axis=0) / 2 + _ROUND_M
    half = np.maximum(half, _LEAST_M / 2)
    return np.maximum(middle - half, low[:2]), np.minimum(middle + half, high[:2])


def _axes_of(camera: Camera | None) -> tuple[Array, Array]:
    """What is right and what is up in the picture, as directions on the table, so that both drawings look alike."""
    right, up = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    if camera is not None:
        try:
            corner, beside, below = camera.on_plane([(100.0, 100.0), (140.0, 100.0), (100.0, 140.0)], 0.0)[:, :2]
        except ValueError:
            return right, up
        if float(np.linalg.norm(beside - corner)) > 1e-9:
            right = (beside - corner) / np.linalg.norm(beside - corner)
            up = np.array([-right[1], right[0]])
            up = up if float(up @ (corner - below)) >= 0 else -up
    return right, up


def _inside(path: Array, low: Array, high: Array) -> list[Array]:
    """The parts of a path that lie over the workspace, or just beside it."""
    good = ((path[:, :2] >= low[:2] - _BESIDE_M) & (path[:, :2] <= high[:2] + _BESIDE_M)).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], good.astype(int), [0]])))
    return [path[first:last] for first, last in zip(edges[::2], edges[1::2], strict=True)]


def _table(drawn: Any, table: Array, low: Array, high: Array, z: float) -> Markup:
    """The table with a grid."""
    step = nice_step(float((high - low).max()), 8)
    lines = []
    for axis in (0, 1):
        for count in range(math.ceil(low[axis] / step), math.floor(high[axis] / step) + 1):
            ends = np.array([[low[0], low[1], z], [high[0], high[1], z]])
            ends[:, axis] = count * step
            lines.append("M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in drawn(ends)))
    border = " ".join(f"{x:.1f},{y:.1f}" for x, y in drawn(table))
    said = f"squares of {100 * step:.0f} cm" if step >= 0.01 else f"squares of {1000 * step:.0f} mm"
    x, y = min(drawn(table), key=lambda point: -point[1])
    return Markup('<polygon points="{}" class="table"/><path d="{}" class="table-grid"/>{}').format(
        border, "".join(lines), text_in_svg(_WIDTH - 8, y + 18, said, "tick end", _SIZE)
    )


def _drops(drawn: Any, legs: Sequence[Leg], low: Array, high: Array, z: float) -> list[Markup]:
    """Lines from where the plan turns down to the table."""
    corners = [leg.points_m[k] for leg in legs for k in corners_of(leg.points_m)]
    inside = [point for part in corners for point in _inside(part[None], low, high)]
    feet: dict[tuple[int, int], Array] = {}
    for point in (part[0] for part in inside):
        # Of several above one another the highest says it for all.
        key = (round(500 * float(point[0])), round(500 * float(point[1])))
        if key not in feet or feet[key][2] < point[2]:
            feet[key] = point
    layers = []
    for point in list(feet.values())[:_MOST_DROPS]:
        (x, y), (_, foot) = drawn(np.array([point, [point[0], point[1], z]]))
        layers.append(
            Markup('<path d="M{x} {}V{foot}" class="drop"/><circle cx="{x}" cy="{foot}" r="2.4" class="foot"/>').format(
                f"{y:.1f}", x=f"{x:.1f}", foot=f"{foot:.1f}"
            )
        )
    return layers


def _numbers(drawn: Any, legs: Sequence[Leg], low: Array, high: Array) -> list[Markup]:
    """The numbers of the actions where they end; those that end in one place stand together."""
    places: list[tuple[float, float, list[int]]] = []
    for leg in legs:
        end = leg.points_m[-1:]
        if not _inside(end, low, high):
            continue
        x, y = drawn(end)[0]
        near = next((place for place in places if math.dist((x, y), place[:2]) < 1.3 * _SIZE), None)
        if near is not None:
            near[2].append(leg.number)
        else:
            places.append((x, y, [leg.number]))
    return [
        text_in_svg(min(x + 9, _WIDTH - 30), y - 6, ", ".join(map(str, numbers)), "path-number", _SIZE)
        for x, y, numbers in places
    ]


def _path(points: Iterable[tuple[float, float]], css: str, rim: bool = False) -> Markup:
    path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
    line = Markup('<path d="{}" class="{}"/>').format(path, css)
    return Markup('<path d="{}" class="path path-rim"/>').format(path) + line if rim else line


def _dot(x: float, y: float, radius: float, css: str) -> Markup:
    return Markup('<circle cx="{}" cy="{}" r="{}" class="{}"/>').format(f"{x:.1f}", f"{y:.1f}", f"{radius:.1f}", css)
