"""Does what depth shows leave room: heights that are known, free places, nothing on the way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.motions import Carry, Motion, Reach, Slide
from wonderful_team.core.values import GateCheck, Limits, View
from wonderful_team.images.relief import Relief, covered, outline
from wonderful_team.runtime.passing import LEAST_SPECKS, PROUD_M, Piece
from wonderful_team.runtime.stage import Stage

AGREE_M = 0.02
"""How far the height of a pick or of a place that no plan names may be from the surface seen there [m]."""
PUSHED_M = 0.015
"""What is less than this higher than a push lies flat, such as a line or a sheet [m]."""
OFF_M = 0.02
"""How far from where it was expected a thing may have come to lie [m]."""
SPECKS_SHARE = 0.01
"""So few of the points of a place, or `LEAST_SPECKS` of them, do not make a thing: edges that are seen unsharp."""
LEVEL_SHARE = 0.5
"""So much of what is round a place must not lie lower than the place, or it is the top of something."""
AROUND_SHARE, LEAST_AROUND_M = 0.35, 0.012
"""How far round a place is looked at: share of the thing's reach, and at least [m]."""


def height_checks(stage: Stage, limits: Limits, measured: bool) -> list[GateCheck]:
    """Whether the heights of what is touched are known, and agree with what is seen there.

    Args:
        stage: What will run, and the scene before it.
        limits: Gives the clearance under which surfaces must be known.
        measured: Refuse heights that no depth shows.
    """
    points = _touched(stage.motion, limits)
    if not points:
        return []
    relief = stage.relief
    if relief is None:
        if not measured:
            return []
        return [
            GateCheck(None, "heights", False, "not measured: there is no depth", "depth at every point (--depth FILE)")
        ]
    found = [(role, point, relief.surface_m(point[:2])) for role, point in points]
    unknown = [role for role, _, surface in found if surface is None]
    if unknown:
        return [GateCheck(None, "heights", False, f"no depth at {', '.join(unknown)}", "depth at every point")]
    checks = [GateCheck(None, "heights", True, f"{len(found)} of {len(found)} seen", "depth at every point")]
    for role, point, surface in found:
        if role == "pick" or (role == "place" and not stage.stated):
            assert surface is not None
            under = surface if role == "pick" else relief.surface_m(point[:2], stage.own)
            if under is None:
                continue
            off = abs(float(point[2]) - under)
            value = f"{point[2]:z.3f} m, where the surface is at {under:z.3f} m"
            limit = f"within {AGREE_M:.3f} m"
            checks.append(GateCheck(None, f"{role} height", off <= AGREE_M, value, limit, f"{AGREE_M - off:+.3f} m"))
    return checks


def _touched(motion: Motion, limits: Limits) -> list[tuple[str, Array]]:
    match motion:
        case Carry():
            return [("pick", motion.start_m), ("place", motion.end_m)]
        case Slide():
            return [("push_end", motion.end_m)]
        case Reach(planned=True):
            several = len(motion.points_m) > 1
            named = [
                (f"waypoint {k}" if several else "waypoint", one) for k, one in enumerate(motion.points_m, start=1)
            ]
            return [(role, point) for role, point in named if point[2] < limits.clearance_m]
    return []


def place_checks(stage: Stage, limits: Limits) -> list[GateCheck]:
    """Whether the place is free, but for what the thing is meant to rest on."""
    motion = stage.motion
    if not isinstance(motion, Carry) or stage.relief is None:
        return []
    relief = stage.relief
    apart = np.ones(len(relief.xyz_m), dtype=bool) if stage.own is None else ~stage.own
    put = stage.put if stage.put is not None else np.zeros(len(apart), dtype=bool)
    if stage.support_m is not None:
        # What it is lifted off stays there.
        under = len(stage.support_m)
        relief = relief.with_expected(stage.support_m)
        apart, put = np.append(apart, np.ones(under, dtype=bool)), np.append(put, np.zeros(under, dtype=bool))
    # What was seen beside its old place left room for it there; what the plan itself put there does not.
    others = apart & np.isnan(relief.px[:, 0]) if stage.restored else apart
    place_z_m, placed = float(motion.end_m[2]), _placed(motion, stage)
    checks = free_checks(placed, place_z_m, relief, others, stage.meant, stage.level, limits, put)
    return checks + (_drop(placed, place_z_m, relief, apart) if stage.stated else [])


def still_free_checks(stage: Stage, view: View, limits: Limits) -> list[GateCheck]:
    """The same for an action that comes later, by the depth of a picture that was taken just before it."""
    motion = stage.motion
    if not isinstance(motion, Carry) or stage.relief is None or stage.restored:
        return []
    relief = Relief.of(view)
    if relief is None:
        return []
    others = np.ones(len(relief.xyz_m), dtype=bool)
    if stage.own is not None and stage.own.any():
        others = ~relief.inside(outline(stage.relief.xyz_m[stage.own, :2], 2 * OFF_M))
    placed, place_z_m = _placed(motion, stage), float(motion.end_m[2])
    checks = free_checks(placed, place_z_m, relief, others, stage.meant, False, limits)
    return checks + (_drop(placed, place_z_m, relief, others) if stage.stated else [])


def _placed(way: Carry, stage: Stage) -> Array:
    """What the thing will cover of the table, as points from above, shape (M, 2) [m]."""
    offsets = stage.carried.offsets_m if stage.carried is not None else None
    if offsets is None:
        angles = np.linspace(0, 2 * np.pi, 12, endpoint=False)
        offsets = 0.01 * np.column_stack([np.cos(angles), np.sin(angles)])
    c, s = np.cos(way.yaw_rad), np.sin(way.yaw_rad)
    return np.asarray(offsets @ np.array([[c, s], [-s, c]]) + way.end_m[:2])


def free_checks(
    placed: Array,
    z_m: float,
    relief: Relief,
    others: Array,
    meant: Any | None,
    level: bool,
    limits: Limits,
    put: Array | None = None,
) -> list[GateCheck]:
    """Whether a thing that covers `placed`, shape (M, 2) [m], finds room at a height.

    Args:
        placed: Its points from above.
        z_m: Height of the surface that it is put on [m].
        relief: What is seen.
        others: Which points are not the thing itself, shape (N,) bool.
        meant: What it may touch.
        level: Whether what is round the place must not lie lower.
        limits: What lies outside the workspace is not looked at.
        put: Which points belong to things that the plan has put there: they take room on what is meant too, shape (N,) bool.
    """
    shape = outline(placed, relief.spacing_m)
    nearby, under = _under(placed, relief, others)
    if meant is not None:
        free = _within(relief.xyz_m[under, :2], meant)
        under[under] = ~free if put is None else ~free | put[under]
    specks = max(LEAST_SPECKS, int(SPECKS_SHARE * nearby.sum()))
    heights = np.sort(relief.xyz_m[under, 2])[::-1]
    top = float(heights[specks]) if len(heights) > specks else z_m
    room = z_m + PROUD_M - top
    value = "free" if len(heights) <= specks else f"{top:z.3f} m is the highest there"
    limit = f"at most {z_m + PROUD_M:.3f} m"
    checks = [GateCheck(None, "place is free", room >= 0, value, limit, f"{room:+.3f} m")]
    if level:
        checks += _level(shape, z_m, relief, others, limits)
    return checks


def _under(placed: Array, relief: Relief, others: Array) -> tuple[Array, Array]:
    """Which points lie near a thing that covers `placed`, and which of them under it; both of shape (N,) bool."""
    nearby = others & relief.inside(outline(placed, relief.spacing_m).buffer(relief.cell_m))
    under = nearby.copy()
    under[nearby] = covered(placed, relief.xyz_m[nearby, :2], relief.cell_m)
    return nearby, under


def _drop(placed: Array, z_m: float, relief: Relief, others: Array) -> list[GateCheck]:
    """Whether a thing comes to rest where it is let go: something that is seen under it is about as high."""
    heights = relief.xyz_m[_under(placed, relief, others)[1], 2]
    if not len(heights):
        return []
    top = float(heights.max())
    room = top + AGREE_M - z_m
    value = f"let go at {z_m:z.3f} m, where {top:z.3f} m is the highest"
    return [GateCheck(None, "drop", room >= 0, value, f"at most {top + AGREE_M:.3f} m", f"{room:+.3f} m")]


def _level(shape: Any, z_m: float, relief: Relief, others: Array, limits: Limits) -> list[GateCheck]:
    low_x, low_y, high_x, high_y = shape.bounds
    width = max(LEAST_AROUND_M, AROUND_SHARE * min(high_x - low_x, high_y - low_y) / 2, 2 * relief.cell_m)
    ring = shape.buffer(width).difference(shape.buffer(relief.cell_m / 2))
    points = relief.xyz_m[others & relief.inside(ring)]
    low, high = np.array(limits.low_m[:2]), np.array(limits.high_m[:2])
    points = points[((points[:, :2] >= low) & (points[:, :2] <= high)).all(axis=1)]
    if not len(points):
        return [GateCheck(None, "place is level", False, "nothing is seen round it", "depth round the place")]
    share = float((points[:, 2] >= z_m - PROUD_M).mean())
    value = f"{100 * share:.0f} % of what is round it is as high"
    margin = f"{100 * (share - LEVEL_SHARE):+.0f} %"
    return [
        GateCheck(None, "place is level", share >= LEVEL_SHARE, value, f"at least {100 * LEVEL_SHARE:.0f} %", margin)
    ]


def taken_checks(stage: Stage) -> list[GateCheck]:
    """Whether something that the plan names, and has not moved, lies where a thing is to go."""
    if not stage.taken:
        return []
    return [GateCheck(None, "place is open", False, f"the {stage.taken} lies there", "moved away before")]


def way_checks(stage: Stage, pieces: Sequence[Piece], tool_radius_m: float) -> list[GateCheck]:
    """Whether what is seen is lower than what passes over it."""
    relief = stage.relief
    if relief is None or not len(relief.xyz_m):
        return []
    if isinstance(stage.motion, Carry | Slide):
        checks = [_level_way(piece) for piece in pieces if piece.check]
        return checks + (_pushed(stage.motion, stage, relief, tool_radius_m) if isinstance(stage.motion, Slide) else [])
    return [_free_way(pieces)] if pieces else []


def _level_way(piece: Piece) -> GateCheck:
    """Nothing under a level way is as high as the lowest point of what passes."""
    low = float(min(piece.start_m[2], piece.end_m[2])) - piece.hanging_m
    tops = np.sort(piece.top_m[~piece.meant])[::-1]
    top = float(tops[min(LEAST_SPECKS, len(tops) - 1)]) if len(tops) else -np.inf
    room = low - PROUD_M - top
    value = "nothing seen" if not len(tops) else f"{top:z.3f} m is the highest there"
    return GateCheck(None, piece.check, room >= 0, value, f"below {low - PROUD_M:.3f} m", f"{room:+.3f} m")


def _pushed(slide: Slide, stage: Stage, relief: Relief, tool_radius_m: float) -> list[GateCheck]:
    """The tool comes down on free ground, and meets nothing on its way that the plan does not push."""
    way = slide.end_m[:2] - slide.start_m[:2]
    length = float(np.linalg.norm(way))
    if length < 1e-6:
        return []
    lands = relief.near(slide.start_m[:2] - way / length * tool_radius_m, tool_radius_m)
    if stage.own is not None:
        lands &= ~stage.own
    heights = np.sort(relief.xyz_m[lands, 2])[::-1]
    top = float(heights[LEAST_SPECKS]) if len(heights) > LEAST_SPECKS else float(slide.start_m[2])
    room = float(slide.start_m[2]) + PUSHED_M - top
    value = f"{top:z.3f} m is the highest there"
    limit = f"at most {float(slide.start_m[2]) + PUSHED_M:.3f} m"
    return [GateCheck(None, "push starts on free ground", room >= 0, value, limit, f"{room:+.3f} m")]


def _free_way(pieces: Sequence[Piece]) -> GateCheck:
    """A tool that moves freely stays above what is seen, but for what it is sent to."""
    room = min(piece.clearance_m for piece in pieces) + PROUD_M
    value = "nothing seen" if not np.isfinite(room) else f"{room - PROUD_M:+.3f} m over what is seen"
    margin = f"{room:+.3f} m" if np.isfinite(room) else ""
    return GateCheck(None, "under the way", bool(room >= 0), value, f"at least {-PROUD_M:.3f} m", margin)


def least_clearance_m(stage: Stage) -> float:
    """How much lower than what passes over it the checks of the way want what is seen to lie [m]."""
    return PROUD_M if isinstance(stage.motion, Carry | Slide) else -PROUD_M


def _within(points: Array, shape: Any) -> Array:
    return np.asarray(shapely.contains_xy(shape, points[:, 0], points[:, 1]))
