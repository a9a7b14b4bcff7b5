"""Keep-out regions as shapes on the table (metres) or in the picture (pixels), and how near a path comes to them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from shapely import LineString, Polygon
from shapely import Point as ShapelyPoint

from wonderful_team.geometry import Box, Camera
from wonderful_team.geometry.arrays import Array
from wonderful_team.types import KeepOut, Limits


def table_height_m(limits: Limits) -> float:
    """Height of the table in the base frame [m]: zero where the workspace holds it, else its lowest height."""
    low, high = limits.low_m[2], limits.high_m[2]
    return 0.0 if low <= 0.0 <= high else low


def region_m(region: KeepOut, camera: Camera | None, table_z_m: float) -> Any | None:
    """The region on the table, in metres, as a polygon that reaches up without end.

    A region in pixels is followed down the camera's rays to the table. None when no camera can place it there.
    """
    if region.unit == "m":
        return Polygon(region.box.corners)
    if camera is None:
        return None
    try:
        corners = camera.on_plane(np.array(region.box.corners), table_z_m)[:, :2]
    except ValueError:
        return None  # a ray of the region never meets the table
    return Polygon(corners)


def region_px(region: KeepOut, camera: Camera | None, table_z_m: float) -> Any | None:
    """The region in pixels of the main view; None for metres that no camera can place there."""
    if region.unit == "px":
        return Polygon(region.box.corners)
    if camera is None:
        return None
    flat = np.column_stack([np.array(region.box.corners), np.full(4, table_z_m)])
    try:
        return Polygon(camera.project(flat))
    except ValueError:
        return None  # a part of it lies behind the camera


def distance(path: Array, region: Any) -> float:
    """Least distance between a path seen from above, shape (N, 2), and a region; 0 when it enters. Exact."""
    corners = np.asarray(path, dtype=np.float64)[:, :2]
    shape = ShapelyPoint(corners[0]) if len(corners) == 1 else LineString(corners)
    return float(region.distance(shape))


def outlines(regions: Iterable[KeepOut], limits: Limits | None, camera: Camera | None) -> list[dict[str, Any]]:
    """Corners [px of the main view] of keep-out regions and of the workspace, for drawing; what no camera places is
    left out.
    """
    drawn = []
    if limits is not None and camera is not None:
        table = KeepOut("workspace", Box(*limits.low_m[:2], *limits.high_m[:2]), "m")
        drawn.append(("workspace", table))
    drawn += [("keep_out", region) for region in regions]
    table_z_m = table_height_m(limits) if limits is not None else 0.0
    found = []
    for kind, region in drawn:
        shape = region_px(region, camera, table_z_m)
        if shape is not None:
            corners = [[round(x, 2), round(y, 2)] for x, y in shape.exterior.coords[:-1]]
            found.append({"kind": kind, "name": region.name, "corners_px": corners})
    return found
