"""Nothing comes near a keep-out region: not the tool, not what it carries or pushes, not on the way between two actions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from shapely import MultiPoint, unary_union

from wonderful_team.core.actions import places_of
from wonderful_team.core.geometry import Box, Camera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.motions import Carry, Leave, Slide, Stay
from wonderful_team.core.values import GateCheck, KeepOut, Limits, PlannedAction
from wonderful_team.images.keep_out import line, region_m, region_px, table_height_m
from wonderful_team.runtime.stage import Carried
from wonderful_team.runtime.sweep import Sweep, swept_path_px

UNKNOWN_REACH_M = 0.1
"""How far a carried thing of which neither a box nor depth tells the size is taken to reach from the tool [m]."""
LOAD_MARGIN_M = 0.005
"""How near the outline of what is carried or pushed may come [m]; the tool keeps its own half-width."""
UNKNOWN_REACH_SHARE = 0.1
"""The same in a picture, as a share of its shorter side."""


def keep_out_checks(
    sweep: Sweep,
    carried: Carried | None,
    regions: Sequence[KeepOut],
    camera: Camera | None,
    limits: Limits,
    tool_radius_m: float,
) -> list[GateCheck]:
    """One check for each region that has a place on the table.

    Args:
        sweep: What will run, with its path.
        carried: What is carried or pushed along it; None for the bare tool.
        regions: Where nothing may be.
        camera: Follows regions in pixels down to the table.
        limits: Gives the table's height.
        tool_radius_m: How near the tool, and what it carries, may come [m].
    """
    checks = []
    for region in regions:
        name = f"keep-out {region.name}"
        shape = region_m(region, camera, table_height_m(limits))
        if shape is None:
            if camera is not None or region.unit == "m":
                checks.append(GateCheck(None, name, False, "meets no table", "a region on the table"))
            continue
        if isinstance(sweep.motion, Leave):
            checks.append(GateCheck(None, name, False, "the way home is not known", "a way that is known"))
            continue
        if sweep.path_m is None:
            continue
        gap, margin = _gap(shape, sweep, carried, tool_radius_m)
        value = "enters it" if gap == 0 else f"{gap:.3f} m away"
        if gap and carried is not None and carried.offsets_m is None and not isinstance(sweep.motion, Slide):
            value += f", if what is carried reaches {UNKNOWN_REACH_M:.3f} m: its size is not known"
        limit = f"at least {margin:.3f} m"
        checks.append(GateCheck(None, name, gap > 0.0 and gap >= margin, value, limit, f"{gap - margin:+.3f} m"))
    return checks


def _gap(shape: Any, sweep: Sweep, carried: Carried | None, tool_radius_m: float) -> tuple[float, float]:
    """How near the tool or its load comes, whichever has less room, and what it must keep [m]."""
    assert sweep.path_m is not None
    ways = [line(sweep.path_m)] + ([line(sweep.transit_m)] if sweep.transit_m is not None else [])
    tool = float(shape.distance(unary_union(ways)))
    load = _load(sweep, carried)
    if load is None:
        return tool, tool_radius_m
    gap = float(shape.distance(load))
    least = min(LOAD_MARGIN_M, tool_radius_m)
    return (tool, tool_radius_m) if tool - tool_radius_m < gap - least else (gap, least)


def _load(sweep: Sweep, carried: Carried | None) -> Any | None:
    """What is carried or pushed covers this from above on the whole way; None without a load."""
    if carried is None:
        return None
    assert sweep.path_m is not None
    motion, offsets, path = sweep.motion, carried.offsets_m, line(sweep.path_m)
    if offsets is None or not len(offsets):
        return None if isinstance(motion, Slide) else path.buffer(UNKNOWN_REACH_M)
    if isinstance(motion, Carry) and motion.yaw_rad == 0:
        return MultiPoint(np.vstack([offsets + motion.start_m[:2], offsets + motion.end_m[:2]])).convex_hull
    if isinstance(motion, Slide):
        return _pushed(motion, offsets)
    # It turns on the way, and which way round is the robot's own doing.
    if sweep.transit_m is not None and not isinstance(motion, Carry):
        path = unary_union([path, line(sweep.transit_m)])
    return path.buffer(carried.radius_m)


def _pushed(slide: Slide, offsets: Array) -> Any:
    """What a pushed thing covers: from where it stands to where the tool stops behind it."""
    way = slide.end_m[:2] - slide.start_m[:2]
    length = float(np.linalg.norm(way))
    along = offsets @ (way / length) if length > 1e-9 else np.zeros(len(offsets))
    shift = way / length * max(0.0, length - float(along.min())) if length > 1e-9 else way
    corners = offsets + slide.start_m[:2]
    return MultiPoint(np.vstack([corners, corners + shift])).convex_hull


def keep_out_px_checks(
    planned: PlannedAction,
    regions: Sequence[KeepOut],
    camera: Camera | None,
    limits: Limits,
    held: Box | None,
    side_px: int,
    metres: bool,
) -> list[GateCheck]:
    """Regions against the pixels that an action came from, where no camera gives metres.

    Args:
        planned: The action.
        regions: Where nothing may be; those in metres need a camera.
        camera: Of the main view.
        limits: Gives the table's height.
        held: Box of what is carried [px]; None when it is not known.
        side_px: The picture's shorter side.
        metres: The action has metres, so that regions in metres were checked there.
    """
    points = np.array(swept_path_px(planned), dtype=np.float64).reshape(-1, 2)
    carries = "pick" in dict(places_of(planned.step))
    checks = []
    for region in regions:
        name = f"keep-out {region.name}"
        if metres and (region.unit == "m" or not _moves(planned)):
            continue
        shape = region_px(region, camera, table_height_m(limits))
        if shape is None:
            where = "in metres, but no camera places it" if region.unit == "m" else "no region of the picture"
            checks.append(GateCheck(None, name, False, where, "a region in px, or a camera"))
            continue
        if len(points) == 0 and not metres:
            continue
        if len(points) == 0:
            checks.append(GateCheck(None, name, False, "in pixels, but no camera places it", "a region in metres"))
            continue
        size = held
        if carries and held is None:
            size = Box.around((0.0, 0.0), 2 * UNKNOWN_REACH_SHARE * side_px, 2 * UNKNOWN_REACH_SHARE * side_px)
        gap = float(shape.distance(_swept_px(points, size if carries else None)))
        value = "enters it" if gap == 0 else f"{gap:.0f} px away"
        checks.append(GateCheck(None, name, gap > 0, value, "outside", f"{gap:+.0f} px"))
    return checks


def _moves(planned: PlannedAction) -> bool:
    return planned.action is None or not isinstance(planned.action.motion(None), Stay)


def _swept_px(points: Array, held: Box | None) -> Any:
    path = line(points)
    if held is None:
        return path
    half = np.array([held.width, held.height]) / 2
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
    return MultiPoint(np.vstack([corners + point for point in points])).convex_hull
