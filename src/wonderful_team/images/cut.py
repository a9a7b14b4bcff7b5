"""Views become pictures: the whole view, the neighbourhood of a box, the strips along its edges.

Every picture carries its exact frame. Nothing is turned or mirrored; small cuts are enlarged by a whole factor, so that
a view pixel becomes a square block and the frame's inverse is exact; what is padded is striped grey and outside
`frame.valid`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, TypeAlias

import numpy as np

from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.pictures import LineMark, Mark, Picture
from wonderful_team.core.values import View
from wonderful_team.core.values.later_picture import LaterPicture
from wonderful_team.images.resample import picture_of, whole_pixels

Edge: TypeAlias = Literal["left", "top", "right", "bottom"]
StripSide: TypeAlias = Literal["inside", "outside"]

MIN_SIDE_PX = 320
"""Short side below which a whole view is enlarged: VIMA-Bench's 256 x 128 becomes 1024 x 512, 640 x 320 stays."""
MAX_SIDE_PX = 1568
"""Longest side sent: above this, common vision-language models shrink a picture themselves."""
MIN_WINDOW_PX = 32
"""Smallest side of a crop's window [view px]: less context says nothing."""
RIM_SHARE = 0.02
"""A crop shows padding only beside a box that comes this near to the view's edge, so that the line along it can be seen: this
share of the box's longer side. Elsewhere its window is moved into the view."""
MARKED_SIDE_PX = 1280
"""Long side that whole views have at least when marks or tick labels are drawn on them."""
MAX_ASPECT = 3.0
"""Crops of long thin boxes get more margin across, up to this ratio of their sides."""
STRIP_SHARE, STRIP_MIN_PX = 0.25, 4
"""Thickness of an edge strip: this share of the box's side, at least so many view pixels."""
_SIDES: tuple[StripSide, ...] = ("inside", "outside")
_STRIP_SHORT_PX, _STRIP_LONG_PX, _STRIP_MAX_ZOOM = 112, 448, 24


def whole(
    view: View,
    name: str,
    *,
    marks: Sequence[Mark] = (),
    min_side_px: int = MIN_SIDE_PX,
    max_side_px: int = MAX_SIDE_PX,
    long_side_px: int = 0,
) -> Picture:
    """The whole view; enlarged when small, shrunk when huge.

    Args:
        view: What to show.
        name: What the words call it.
        marks: In pixels of the picture.
        min_side_px: Double until the short side has at least this many pixels, as far as the long side allows.
        max_side_px: Shrink until the long side has at most this many pixels.
        long_side_px: Enlarge until the long side has at least this many pixels, by a whole factor where one fits.
    """
    short, long = min(view.size_px), max(view.size_px)
    if long > max_side_px:
        frame = Frame.whole(view.id, view.size_px, max_side_px / long)
    else:
        doublings = max(0, math.ceil(math.log2(min_side_px / short)))
        zoom: float = min(2**doublings, int(max_side_px / long))
        if zoom * long < long_side_px:
            factor = math.ceil(long_side_px / long)
            zoom = factor if factor * long <= max_side_px else long_side_px / long
        frame = Frame.whole(view.id, view.size_px, zoom)
    return picture_of(view, frame, name).marked(*marks)


def crop(
    view: View,
    box: Box,
    name: str,
    *,
    margin: float = 0.6,
    min_side_px: int = 448,
    max_side_px: int = 1344,
    marks: Sequence[Mark] = (),
    also: Sequence[Box] = (),
) -> Picture:
    """The neighbourhood of a box, enlarged.

    Args:
        view: What to cut from.
        box: What to show, in view px.
        name: What the words call it.
        margin: How far the window reaches past the box, as a share of the box's side.
        min_side_px: Enlarge by a whole factor until the short side has at least this many pixels.
        max_side_px: The long side never has more pixels than this.
        marks: In pixels of the picture.
        also: Other boxes [view px] that the same window must show.

    Raises:
        ValueError: The box lies outside the view.
    """
    frame = crop_frame(view, (box, *also), margin=margin, min_side_px=min_side_px, max_side_px=max_side_px)
    return picture_of(view, frame, name).marked(*marks)


def crop_frame(
    view: View, boxes: Sequence[Box], *, margin: float = 0.6, min_side_px: int = 448, max_side_px: int = 1344
) -> Frame:
    """The frame of a crop round all of `boxes` [view px]."""
    box = Box.bounding([corner for item in boxes for corner in item.corners])
    bounds = Box(0, 0, *view.size_px)
    if box.intersection(bounds) is None:
        raise ValueError(f"box {box.as_tuple} lies outside view {view.id!r} of {view.size_px} px")
    longer = max(box.width, box.height) * (1 + 2 * margin)
    width = max(box.width * (1 + 2 * margin), longer / MAX_ASPECT, MIN_WINDOW_PX)
    height = max(box.height * (1 + 2 * margin), longer / MAX_ASPECT, MIN_WINDOW_PX)
    window = _into_view(Box.around(box.centre, width, height), box, bounds)
    return _window_frame(view, window, min_side_px, max_side_px)


def edge_strips(view: View, box: Box) -> dict[tuple[Edge, StripSide], Picture]:
    """Thin pictures just inside and just outside each edge of a box, the right way up, enlarged.

    Each carries a LineMark where the box's edge lies. The window ends on whole pixels, so up to one view pixel of the
    other side can show past the line. A strip that would lie outside the view is left out.

    Args:
        view: What to cut from.
        box: In view px.
    """
    strips: dict[tuple[Edge, StripSide], Picture] = {}
    bounds = Box(0, 0, *view.size_px)
    for edge, line in _edges(box).items():
        side_px = box.width if edge in ("left", "right") else box.height
        reach = max(STRIP_SHARE * side_px, STRIP_MIN_PX)
        windows = {}
        for side in _SIDES:
            depth = min(reach, side_px / 2) if side == "inside" else -reach
            window = _strip_window(box, edge, depth)
            seen = window.intersection(bounds)
            if seen is not None and min(seen.width, seen.height) >= 0.5:
                windows[side] = whole_pixels(window)
        # One factor for both sides of an edge: they are shown as one picture.
        zoom = min(map(_strip_zoom, windows.values()), default=1)
        for side, window in windows.items():
            size = (round(window.width * zoom), round(window.height * zoom))
            frame = Frame.window(view.id, view.size_px, window, size)
            start, end = (frame.point_to_picture(point) for point in line)
            picture = picture_of(view, frame, f"strip {edge} {side}")
            strips[edge, side] = picture.marked(LineMark(start, end))
    return strips


def across_edge(inside: Picture, outside: Picture, name: str) -> Picture | None:
    """What the strips on both sides of an edge show as one picture, the edge's line in it once.

    It is cut from the view when its pixels are asked for, as the strips are. None where they are no cuts of one view in one scale.
    """
    near, far = inside.frame, outside.frame
    view = inside.source if isinstance(inside, LaterPicture) else None
    same = isinstance(outside, LaterPicture) and outside.source is view
    if view is None or not same or not np.array_equal(near.T_view_picture[:2, :2], far.T_view_picture[:2, :2]):
        return None
    both = near.whole_box.corners + near.box_to_picture(far.box_to_view(far.whole_box)).corners
    window = near.box_to_view(Box.bounding(both))
    size = (round(window.width * near.scale), round(window.height * near.scale))
    picture = picture_of(view, Frame.window(view.id, view.size_px, window, size), name)
    lines = [mark for mark in inside.marks if isinstance(mark, LineMark)]
    ends = [[near.point_to_view(point) for point in (line.start, line.end)] for line in lines]
    return picture.marked(*(LineMark(*map(picture.frame.point_to_picture, line)) for line in ends))


def _edges(box: Box) -> dict[Edge, tuple[tuple[float, float], tuple[float, float]]]:
    top_left, top_right, bottom_right, bottom_left = box.corners
    return {
        "left": (top_left, bottom_left),
        "top": (top_left, top_right),
        "right": (top_right, bottom_right),
        "bottom": (bottom_left, bottom_right),
    }


def _strip_window(box: Box, edge: Edge, depth: float) -> Box:
    """The strip that reaches `depth` [view px] into the box from one edge; negative: away from it."""
    x0, y0, x1, y1 = box.as_tuple
    match edge:
        case "left":
            return Box(min(x0, x0 + depth), y0, max(x0, x0 + depth), y1)
        case "right":
            return Box(min(x1, x1 - depth), y0, max(x1, x1 - depth), y1)
        case "top":
            return Box(x0, min(y0, y0 + depth), x1, max(y0, y0 + depth))
        case "bottom":
            return Box(x0, min(y1, y1 - depth), x1, max(y1, y1 - depth))


def _strip_zoom(window: Box) -> int:
    short, long = min(window.width, window.height), max(window.width, window.height)
    zoom = max(math.ceil(_STRIP_SHORT_PX / short), math.ceil(_STRIP_LONG_PX / long))
    return max(1, min(zoom, _STRIP_MAX_ZOOM, int(MAX_SIDE_PX / long)))


def _into_view(window: Box, box: Box, bounds: Box) -> Box:
    """The window moved, and cut where it is larger, to lie in the view; a rim stays beside a box at the view's edge."""
    rim = max(RIM_SHARE * max(box.width, box.height), 1.0)
    spans = []
    for low, high, first, last, end in (
        (window.x0, window.x1, box.x0, box.x1, bounds.x1),
        (window.y0, window.y1, box.y0, box.y1, bounds.y1),
    ):
        least = min(first, -rim if first < rim else 0.0)
        most = max(last, end + rim if last > end - rim else end)
        moved = max(least - low, 0.0) or min(most - high, 0.0)
        spans.append((max(low + moved, least), min(high + moved, most)))
    (x0, x1), (y0, y1) = spans
    return whole_pixels(Box(x0, y0, x1, y1))


def _window_frame(view: View, window: Box, min_side_px: int, max_side_px: int) -> Frame:
    short, long = min(window.width, window.height), max(window.width, window.height)
    zoom = max_side_px / long if long > max_side_px else _zoom(short, long, min_side_px, max_side_px)
    size = (max(1, round(window.width * zoom)), max(1, round(window.height * zoom)))
    return Frame.window(view.id, view.size_px, window, size)


def _zoom(short: float, long: float, min_side_px: int, max_side_px: int) -> int:
    """The whole factor, two at least, that brings the short side to `min_side_px`, as far as the long side allows."""
    return max(1, min(max(math.ceil(min_side_px / short), 2), int(max_side_px / long)))
