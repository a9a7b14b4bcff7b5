"""A thing cut out and turned by numbered angles, beside how it is to lie; and how well turned cut-outs fit in pixels.

All this is for views from above, in which a turn of the thing is a turn of its picture.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import BoxMark, Picture, Point, Tiles
from wonderful_team.core.values import View
from wonderful_team.images.colours import commonest
from wonderful_team.images.resample import resampled

ROWS = 3
TILE_PX = 260
"""Longest side of a cut-out: five beside each other stay below the size at which models shrink pictures."""
ZOOMS = (8.0, 6.0, 5.0, 4.0, 3.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.25)
"""Enlargements of a cut-out. With sides that are multiples of four, whole view pixels fall on whole pixels."""
STEP_PX = 4
ROOM = 1.12
"""A cut-out reaches this far past half of the box's diagonal: turned, all of the thing stays in it."""
GAP_PX, HEAD_PX, EDGE_PX = 12, 26, 8
BACK = 236
FIT_PX = 64
"""Side at which cut-outs are compared."""
SHIFT_SHARE = 0.15
"""How far a cut-out may lie off the goal's middle, as a share of its side: boxes of turned things have other middles."""


@dataclass(frozen=True, eq=False)
class Shown:
    """A thing in a view.

    Attributes:
        at: Its middle [view px].
    """

    view: View
    at: Point


def reach_px(box: Box) -> int:
    """Half the side of a square that holds a thing in any turn [view px]."""
    return STEP_PX * max(2, math.ceil(ROOM * math.hypot(box.width, box.height) / 2 / STEP_PX))


def turn_strip(thing: Shown, goal: Shown, reach: int, turns: Sequence[float], name: str) -> Picture:
    """The goal at the left, then the thing turned clockwise by each of `turns` [degrees], in rows.

    The picture's frame is that of the goal's cut-out: `valid` is the square inside its circle.

    Args:
        thing: As it lies at first.
        goal: As it is to lie.
        reach: Half the side of what is cut out [view px].
        turns: Clockwise [degrees].
        name: What the words call the picture.
    """
    columns = math.ceil(len(turns) / ROWS)
    rows = math.ceil(len(turns) / columns)
    zoom = next((zoom for zoom in ZOOMS if 2 * reach * zoom <= TILE_PX), ZOOMS[-1])
    side = round(2 * reach * zoom)
    size = (2 * EDGE_PX + (columns + 1) * side + (columns + 1) * GAP_PX, EDGE_PX + rows * (side + HEAD_PX))
    rgb = np.full((size[1], size[0], 3), BACK, np.uint8)
    left = EDGE_PX + side + 2 * GAP_PX
    corners = [
        (left + (k % columns) * (side + GAP_PX), HEAD_PX + (k // columns) * (side + HEAD_PX)) for k in range(len(turns))
    ]
    for (x, y), turn in zip(corners, turns, strict=True):
        rgb[y : y + side, x : x + side] = _turned(thing, reach, side, turn)
    at = (EDGE_PX, HEAD_PX + (rows - 1) * (side + HEAD_PX) // 2)
    frame = _goal_frame(goal, reach, side)
    rgb[at[1] : at[1] + side, at[0] : at[0] + side] = _round(resampled(goal.view.rgb, frame), side)
    tiles = Tiles(tuple(Box(x, y, x + side, y + side) for x, y in corners))
    mark = BoxMark(Box(at[0], at[1], at[0] + side, at[1] + side), "target", "goal")
    return Picture(name, rgb, _inside(frame, goal, reach, at, size), marks=(mark, tiles))


def _goal_frame(goal: Shown, reach: int, side: int) -> Frame:
    x, y = round(goal.at[0]), round(goal.at[1])
    window = Box(x - reach, y - reach, x + reach, y + reach)
    return Frame.window(goal.view.id, goal.view.size_px, window, (side, side))


def _inside(frame: Frame, goal: Shown, reach: int, at: tuple[int, int], size: tuple[int, int]) -> Frame:
    """The strip's frame: the goal's, moved to where it stands; valid is the square of whole view pixels in its circle."""
    moved = frame.T_view_picture @ np.array([[1.0, 0, -at[0]], [0, 1.0, -at[1]], [0, 0, 1.0]])
    x, y = round(goal.at[0]), round(goal.at[1])
    half = STEP_PX * math.floor((reach - 1) / math.sqrt(2) / STEP_PX)
    square = Box(x - half, y - half, x + half, y + half).intersection(Box(0, 0, *goal.view.size_px))
    whole = Frame(frame.view_id, moved, size, Box(0, 0, *size))
    return whole if square is None else Frame(frame.view_id, moved, size, whole.box_to_picture(square))


def _turned(thing: Shown, reach: int, side: int, clockwise_deg: float) -> Array:
    return _round(_patch(thing, reach, side, clockwise_deg), side)


def _patch(thing: Shown, reach: float, side: int, clockwise_deg: float = 0.0) -> Array:
    """The square round a thing, turned about its middle, shape (side, side, 3)."""
    zoom = side / (2 * reach)
    # cv2 counts from the middle of the first pixel, and its angles grow anticlockwise.
    x, y = round(thing.at[0]) - 0.5, round(thing.at[1]) - 0.5
    move = cv2.getRotationMatrix2D((x, y), -clockwise_deg, zoom)
    move[:, 2] += side / 2 - 0.5 - np.array([x, y])
    way = cv2.INTER_LINEAR if zoom < 1 else cv2.INTER_CUBIC
    rgb = np.ascontiguousarray(thing.view.rgb)
    return np.asarray(cv2.warpAffine(rgb, move, (side, side), flags=way, borderMode=cv2.BORDER_REPLICATE))


def _round(patch: Array, side: int) -> Array:
    return np.where(_disc(side)[..., None], patch, np.uint8(BACK))


def _disc(side: int) -> Array:
    away = np.arange(side) + 0.5 - side / 2
    return np.asarray(away[:, None] ** 2 + away[None, :] ** 2 <= (side / 2) ** 2)


def turn_misfits(thing: Shown, goal: Shown, reach: int, turns: Sequence[float]) -> Array:
    """How far the thing, turned clockwise by each of `turns` [degrees], is from the goal: 0 the same, in grey levels.

    Shape (len(turns),): root of the mean squared difference inside a circle, at the shift that fits best.
    """
    wide = 1 + 2 * SHIFT_SHARE
    goal_patch = _patch(goal, reach * wide, round(FIT_PX * wide)).astype(np.float32)
    patches = (_patch(thing, reach, FIT_PX, turn).astype(np.float32) for turn in turns)
    return np.array([misfit(patch, goal_patch) for patch in patches])


def misfit(patch: Array, goal: Array) -> float:
    """Root of the mean squared difference between a square patch's circle and the part of a larger one that fits best."""
    side = patch.shape[0]
    mask = np.repeat(_disc(side)[..., None], 3, axis=2).astype(np.float32)
    apart = cv2.matchTemplate(goal.astype(np.float32), patch.astype(np.float32), cv2.TM_SQDIFF, mask=mask)
    return float(np.sqrt(max(float(apart.min()), 0.0) / mask.sum()))


def thing_alone(view: View) -> Box | None:
    """The box [view px] of the one thing that a picture shows on a plain ground; None where that is not clear.

    What touches the picture's edge belongs to the ground.
    """
    rgb = cv2.GaussianBlur(np.ascontiguousarray(view.rgb), (3, 3), 0).astype(np.int16)
    ground = commonest(rgb)
    mask = (np.abs(rgb - ground).max(axis=2) > DIFFERENT).astype(np.uint8)
    count, _, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=8)
    height, width = mask.shape
    boxes = [
        (int(area), Box(x, y, x + w, y + h))
        for x, y, w, h, area in stats[1:count]
        if x > 0 and y > 0 and x + w < width and y + h < height
    ]
    boxes.sort(key=lambda item: item[0], reverse=True)
    least = LEAST_SHARE * height * width
    if not boxes or boxes[0][0] < least or (len(boxes) > 1 and boxes[1][0] > OTHER_SHARE * boxes[0][0]):
        return None
    return boxes[0][1]


DIFFERENT = 24
"""Grey levels by which a thing differs from the ground it lies on."""
LEAST_SHARE = 0.0008
"""A smaller thing than this share of the picture is none."""
OTHER_SHARE = 0.25
"""Two things, where the second covers more than this share of the first."""
