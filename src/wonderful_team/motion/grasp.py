"""How two fingers that point down grip a thing: turn, width and middle, from the points that depth shows of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.geometry import Box, PlanarCamera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import Fingers, View
from wonderful_team.errors import GeometryError
from wonderful_team.motion import heights

TURNS = 60
"""Turns of the gripper that are tried, over half a turn: every 3 degrees."""
ROOM_M = 0.005
"""More than the thing's width the open fingers want between them [m]."""
TURNING_M_RAD = 0.001
"""So much narrower a grip has to be for a turn of one more radian [m]: what is round is gripped as the gripper stands."""
LOW_SHARE, LEAST_M = 0.2, 0.005
"""What is lower than this share of the thing's height, or this, is not the thing but what it stands on."""
TIP_M = 0.009
"""How far the fingertips reach below the point between them [m]."""
SPECKS = 4
"""So few points do not make a thing that a finger could meet."""
HOLES_SHARE, SPREAD_M = 0.35, 0.02
"""Depth is in doubt where more of the thing's middle has none, or where it is spread wider round the chosen point [m]."""
WINDOW_PX = 3
RAISED_M = 0.004
"""What of a box is so much higher than the support belongs to the thing in it [m]."""
STANDS_OUT_M, FLAT_SHARE = 0.012, 0.3
"""A handle stands at least so high out of what it is a handle of [m], and at least this share of the thing lies lower."""
NEAR_M = 0.16
"""How far round the point other things are looked for [m]."""


class TooWideError(GeometryError):
    """The fingers do not open that far."""


@dataclass(frozen=True, eq=False)
class Grip:
    """How a thing is gripped.

    Attributes:
        centre_m: Middle between the fingers, shape (2,) [m].
        yaw_rad: Heading of the gripper; the fingers close across it.
        width_m: Of the thing between the fingers [m].
        points: From how many points of the thing.
        support_z_m: Height of what the fingers come down to: what the thing stands on, or a plate of its own round a handle [m].
    """

    centre_m: Array
    yaw_rad: float
    width_m: float
    points: int
    support_z_m: float

    @property
    def how(self) -> str:
        """In words, for the source of the numbers."""
        turn = math.degrees(-self.yaw_rad) + 0.0
        return f"gripped across {1000 * self.width_m:.0f} mm, turned {turn:.0f} degrees clockwise, by {self.points} points of depth"


@dataclass(frozen=True, eq=False)
class Displaced:
    """A thing that was moved since the picture was taken.

    Attributes:
        was: Which pixels of the view show it, shape (H, W) bool.
        now_m: Where its points are now, shape (N, 3) [m].
    """

    was: Array
    now_m: Array


def seen_of(view: View, box: Box, support_z_m: float) -> tuple[Array, Array]:
    """Which pixels of a view show what stands in a box, shape (H, W) bool, and its points, shape (N, 3) [m]."""
    depth, camera = view.depth_m, view.camera
    assert depth is not None
    assert camera is not None
    columns, rows = np.meshgrid(np.arange(depth.shape[1]) + 0.5, np.arange(depth.shape[0]) + 0.5)
    was = (columns >= box.x0) & (columns <= box.x1) & (rows >= box.y0) & (rows <= box.y1)
    was &= np.isfinite(depth) & (depth > 0)
    points = camera.deproject(_pixels(view)[was], depth[was])
    raised = points[:, 2] > support_z_m + RAISED_M
    was[was] = raised
    return was, np.asarray(points[raised])


def grip_of(
    view: View,
    box: Box,
    px: Point,
    support_z_m: float,
    grasp_z_m: float,
    fingers: Fingers,
    displaced: Sequence[Displaced] = (),
) -> Grip:
    """How the fingers grip what shows at a pixel.

    Args:
        view: With depth and a camera that turns it into metres.
        box: Of the thing [view px].
        px: The chosen point on it.
        support_z_m: Height of what it stands on [m].
        grasp_z_m: Height at which the fingers close [m].
        fingers: Their measures.
        displaced: What does not stand any more where the view shows it.

    Raises:
        GeometryError: There is no depth, it is in doubt, the thing is too wide, or others leave no room for the fingers.
    """
    cloud = _cloud(view, box, px)
    _check_depth(view, box, px, cloud)
    whole = _own(cloud, box, px, support_z_m)
    beside = np.isfinite(cloud[..., 2])
    for one in displaced:
        beside &= ~one.was
    arrived = np.vstack([np.zeros((0, 3)), *(one.now_m for one in displaced)])
    arrived = arrived[np.linalg.norm(arrived[:, :2] - cloud[whole][0, :2], axis=1) < 2 * NEAR_M]
    try:
        return _closed(view, cloud, whole, px, support_z_m, grasp_z_m, fingers, beside, arrived)
    except TooWideError:
        found = _handle(cloud, whole, px)
        if found is None:
            raise
    top_z_m, shelf_z_m = found
    handle = _own(cloud, box, px, shelf_z_m)
    grasp_z_m = heights.grasp_z_m(top_z_m, shelf_z_m)
    return _closed(view, cloud, handle, px, shelf_z_m, grasp_z_m, fingers, beside, arrived)


def _closed(
    view: View,
    cloud: Array,
    own: Array,
    px: Point,
    support_z_m: float,
    grasp_z_m: float,
    fingers: Fingers,
    beside: Array,
    arrived: Array,
) -> Grip:
    """How the fingers close on these points; refused when they are too wide, or others leave no room."""
    mine, others = cloud[own], np.vstack([cloud[beside & ~own], arrived])
    at = mine[np.argmin(np.linalg.norm(_pixels(view)[own] - np.array(px), axis=1)), :2]
    spacing = _spacing(mine)
    found, narrowest = [], math.inf
    tip_m = max(grasp_z_m - TIP_M, support_z_m) + ROOM_M
    others = others[others[:, 2] > tip_m]
    turns = np.linspace(-math.pi / 2, math.pi / 2, TURNS, endpoint=False) if fingers.turns else np.zeros(1)
    for yaw in turns:
        low, high = _extent(mine, at, float(yaw), fingers, spacing)
        width, middle = high - low, (high + low) / 2
        narrowest = min(narrowest, width)
        if width + ROOM_M > fingers.opening_m:
            continue
        hit = _hits(others, at, float(yaw), middle, width, fingers)
        found.append((hit, width, abs(float(yaw)), float(yaw), middle))
    if not found:
        side = (
            "across its narrowest side" if fingers.turns else "where the fingers close, and the gripper does not turn"
        )
        raise TooWideError(
            f"it is {1000 * narrowest:.0f} mm wide {side} (limit {1000 * (fingers.opening_m - ROOM_M):.0f} mm): "
            "the fingers do not open that far"
        )
    free = [one for one in found if one[0] <= SPECKS]
    if not free:
        tried = (
            f"however the gripper is turned ({len(found)} turns tried)"
            if fingers.turns
            else "and the gripper does not turn"
        )
        raise GeometryError(f"other things stand where a finger would go, {tried}; move one of them away first")
    _, width, _, yaw, middle = min(free, key=lambda one: one[1] + TURNING_M_RAD * one[2])
    centre = at + middle * np.array([math.sin(yaw), -math.cos(yaw)])
    return Grip(centre, yaw, width, len(mine), support_z_m)


def _handle(cloud: Array, own: Array, px: Point) -> tuple[float, float] | None:
    """Heights of the top at the point and of the thing's own flat part round it [m]; None where nothing stands out of it."""
    top = float(np.median(_window(cloud, px)))
    lower = cloud[own][:, 2]
    lower = lower[lower < top - STANDS_OUT_M]
    if len(lower) < FLAT_SHARE * own.sum():
        return None
    return top, float(np.median(lower))


def _window(cloud: Array, px: Point) -> Array:
    """Heights that are known close to a pixel, shape (N,) [m]."""
    x, y = int(px[0]), int(px[1])
    window = cloud[max(0, y - WINDOW_PX) : y + WINDOW_PX + 1, max(0, x - WINDOW_PX) : x + WINDOW_PX + 1, 2]
    return np.asarray(window[np.isfinite(window)])


def _pixels(view: View) -> Array:
    width, height = view.size_px
    columns, rows = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    return np.dstack([columns, rows])


def _cloud(view: View, box: Box, px: Point) -> Array:
    """Point of the base frame that each pixel shows, shape (H, W, 3) [m]; NaN where unknown and far from the thing."""
    depth, camera = view.depth_m, view.camera
    if depth is None or camera is None or isinstance(camera, PlanarCamera):
        raise GeometryError("there is no depth, so how wide it is and how the gripper must turn are not known")
    cloud = np.full((*depth.shape, 3), np.nan)
    known = np.isfinite(depth) & (depth > 0)
    # A window that holds everything nearby, whatever the camera: a metre in pixels, from two points of the table.
    ends = camera.project([middle := camera.on_plane([px], 0.0)[0], middle + (0.1, 0.0, 0.0)])
    reach = 1.5 * NEAR_M / 0.1 * float(np.linalg.norm(ends[1] - ends[0])) + max(box.width, box.height)
    away = np.abs(_pixels(view) - np.array(px)).max(axis=2)
    known &= away <= reach
    cloud[known] = camera.deproject(_pixels(view)[known], depth[known])
    far = np.hypot(cloud[..., 0] - middle[0], cloud[..., 1] - middle[1]) > NEAR_M
    cloud[far] = np.nan
    return cloud


def _check_depth(view: View, box: Box, px: Point, cloud: Array) -> None:
    """Depth in doubt is refused, never guessed."""
    assert view.depth_m is not None
    half = box.scaled(0.5)
    rows = slice(max(0, int(half.y0)), max(int(half.y0) + 1, math.ceil(half.y1)))
    columns = slice(max(0, int(half.x0)), max(int(half.x0) + 1, math.ceil(half.x1)))
    inside = view.depth_m[rows, columns]
    lost = float((~(np.isfinite(inside) & (inside > 0))).mean()) if inside.size else 1.0
    if lost > HOLES_SHARE:
        raise GeometryError(
            f"depth is in doubt: {100 * lost:.0f} % of the middle of its box has none (limit {100 * HOLES_SHARE:.0f} %)"
        )
    near = _window(cloud, px)
    if not near.size:
        raise GeometryError(f"depth is in doubt: there is none round the point ({px[0]:.0f}, {px[1]:.0f}) px")
    spread = float(np.quantile(near, 0.9) - np.quantile(near, 0.1))
    if spread > SPREAD_M:
        raise GeometryError(
            f"depth is in doubt: heights round the point ({px[0]:.0f}, {px[1]:.0f}) px are spread over {1000 * spread:.0f} mm "
            f"(limit {1000 * SPREAD_M:.0f} mm); a point farther from an edge is needed"
        )


def _own(cloud: Array, box: Box, px: Point, support_z_m: float) -> Array:
    """Which pixels show the thing, shape (H, W) bool: what stands up and hangs together with the point, in the box."""
    rows, columns = np.indices(cloud.shape[:2]) + 0.5
    inside = (columns >= box.x0 - 1) & (columns <= box.x1 + 1) & (rows >= box.y0 - 1) & (rows <= box.y1 + 1)
    shown_z = np.where(inside, cloud[..., 2], np.nan)
    top = float(np.nanquantile(shown_z, 0.98)) if np.isfinite(shown_z).any() else support_z_m
    least = support_z_m + max(LEAST_M, LOW_SHARE * (top - support_z_m))
    raised = (np.nan_to_num(shown_z, nan=-1e3) > least).astype(np.uint8)
    count, labels = cv2.connectedComponents(cv2.morphologyEx(raised, cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8)))
    shown = np.where(labels > 0, np.hypot(columns - px[0], rows - px[1]), np.inf)
    nearest = np.unravel_index(int(np.argmin(shown)), shown.shape)
    if count < 2 or shown[nearest] > 2 * WINDOW_PX:
        raise GeometryError(
            f"nothing stands higher than {1000 * (least - support_z_m):.0f} mm over its support at the point "
            f"({px[0]:.0f}, {px[1]:.0f}) px: there is nothing for the fingers to close on"
        )
    return np.asarray((labels == labels[nearest]) & (raised > 0))


def _spacing(points: Array) -> float:
    """Usual distance between neighbouring points [m]: a thing is as much wider than its outermost points."""
    steps = np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1)
    return float(np.median(steps)) if len(steps) else 0.0


def _seen_from(points: Array, at: Array, yaw_rad: float) -> tuple[Array, Array]:
    """Along the gripper's heading, and across it, where the fingers close; shape (N,) each [m]."""
    away = points[:, :2] - at
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return away @ np.array([c, s]), away @ np.array([s, -c])


def _extent(mine: Array, at: Array, yaw_rad: float, fingers: Fingers, spacing: float) -> tuple[float, float]:
    """From where to where the thing reaches between the fingers [m]."""
    along, across = _seen_from(mine, at, yaw_rad)
    between = across[np.abs(along) <= fingers.breadth_m / 2]
    low, high = np.quantile(between, [0.005, 0.995]) if len(between) > 50 else (between.min(), between.max())
    return float(low) - spacing / 2, float(high) + spacing / 2


def _hits(others: Array, at: Array, yaw_rad: float, middle: float, width: float, fingers: Fingers) -> int:
    """How many points of other things stand where the fingers come down and close."""
    along, across = _seen_from(others, at, yaw_rad)
    off = np.abs(across - middle)
    beside = (off > width / 2 + ROOM_M / 2) & (off < fingers.opening_m / 2 + fingers.thickness_m + ROOM_M)
    return int((beside & (np.abs(along) <= fingers.breadth_m / 2 + ROOM_M / 2)).sum())
