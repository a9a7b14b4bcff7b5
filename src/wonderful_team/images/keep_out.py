"""Keep-out regions as shapes on the table (metres) or in the picture (pixels), and how near a path comes to them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from shapely import LineString, Polygon
from shapely import Point as ShapelyPoint

from wonderful_team.core.geometry import Box, Camera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import KeepOut, Limits


def table_height_m(limits: Limits) -> float:
    """Height of the table in the base frame [m]: zero where the workspace holds it, else its lowest height."""
    low, high = limits.low_m[2], limits.high_m[2]
    return 0.0 if low <= 0.0 <= high else low


def region_m(region: KeepOut, camera: Camera | None, table_z_m: float) -> Any | None:
    """The region on the table, in metres, as a polygon that reaches up without end.

    A region in pixels is followed down the camera's rays to the table. None when no camera can place it there: a part of
    it lies above the horizon, or what comes out is no region.
    """
    if region.unit == "m":
        return _polygon(region.box.corners)
    if camera is None:
        return None
    try:
        corners = camera.on_plane(np.array(region.box.corners), table_z_m)[:, :2]
    except ValueError:
        return None  # a ray of the region never meets the table
    return _polygon(corners)


def _polygon(corners: Any) -> Any | None:
    if not np.isfinite(np.asarray(corners, dtype=np.float64)).all():
        return None
    shape = Polygon(corners)
    return shape if shape.is_valid and 0 < shape.area < np.inf else None


def region_px(region: KeepOut, camera: Camera | None, table_z_m: float) -> Any | None:
    """The region in pixels of the main view; None for metres that no camera can place there."""
    if region.unit == "px":
        return _polygon(region.box.corners)
    if camera is None:
        return None
    flat = np.column_stack([np.array(region.box.corners), np.full(4, table_z_m)])
    try:
        return _polygon(camera.project(flat))
    except ValueError:
        return None  # a part of it lies behind the camera


def line(path: Array) -> Any:
    """A path seen from above, shape (N, 2) or (N, 3), as a shape."""
    corners = np.asarray(path, dtype=np.float64)[:, :2]
    return ShapelyPoint(corners[0]) if len(corners) == 1 else LineString(corners)


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
