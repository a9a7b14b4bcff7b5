"""One picture of a whole plan, for the page and the README: numbered targets, points, arrows, keep-out, workspace."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from wonderful_team.core.actions import Action
from wonderful_team.core.geometry import Box, Camera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.motions import Slide
from wonderful_team.core.pictures import BoxStyle, Picture, Point, TurnMark
from wonderful_team.core.text import spoken
from wonderful_team.core.values import GroundedTarget, KeepOut, Limits, PlannedAction, View
from wonderful_team.images.arrows import bows, draw_arrows, start_label, step_colour
from wonderful_team.images.canvas import (
    BLUE,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    WHITE,
    YELLOW,
    Canvas,
    Colour,
)
from wonderful_team.images.cut import whole
from wonderful_team.images.draw import candidate_radius, draw_box, draw_strip, point_reach
from wonderful_team.images.lettering import plain
from wonderful_team.images.placing import PointLabel, label_box, label_points, paint_plates
from wonderful_team.images.turn_marks import draw_turn, stays

TARGET_COLOURS: tuple[Colour, ...] = (ORANGE, SKY, YELLOW, PURPLE, GREEN, VERMILLION)
"""Taken in turn by the targets of a plan."""
MOST_IN_WORDS = 12
"""More targets are named by their ids alone."""


def overview(
    shown: View | Picture,
    grounded: Mapping[str, GroundedTarget] | Iterable[GroundedTarget] = (),
    *,
    names: Mapping[str, str] | None = None,
    arrows: Sequence[Sequence[Point]] = (),
    turns: Sequence[TurnMark] = (),
    widths: Sequence[float] = (),
    keep_out: Sequence[KeepOut] = (),
    workspace: Limits | Box | None = None,
) -> Array:
    """A picture of what a plan is about. All coordinates are pixels of the view, whatever is shown.

    Args:
        shown: The main view, or a picture cut from it.
        grounded: Targets with boxes and points; those that were not found are left out.
        names: What the instruction's pictures are called, where a target's words speak of one as {name}.
        arrows: Moves in order, each through two or more points; `action_arrows` makes them from actions.
        turns: Things that are turned, as `action_turns` makes them from actions.
        widths: How wide a strip each of these moves sweeps, 0 for none; `swept_widths` computes them. None for all when left out.
        keep_out: Regions nothing may enter.
        workspace: Limits in metres, or a box in view px, to outline. Metres have a place in a View with a camera alone.

    Returns:
        Shape (H, W, 3), uint8: a small view is enlarged, a huge one shrunk.
    """
    picture = whole(shown, "overview", min_side_px=480) if isinstance(shown, View) else shown
    eye = shown.camera if isinstance(shown, View) else None
    canvas = Canvas.over(picture.rgb)
    named: list[_Named] = []
    for region, style, name, z_m in _regions(keep_out, workspace):
        corners = _outline(region, eye, z_m)
        if corners is not None:
            on_picture = _points(picture, corners)
            draw_box(canvas, on_picture, style)
            named += [_Named(Box.bounding(on_picture), name, VERMILLION, WHITE, is_region=True)] if name else []
    targets = grounded.values() if isinstance(grounded, Mapping) else grounded
    found = [(item, TARGET_COLOURS[k % len(TARGET_COLOURS)]) for k, item in enumerate(_found(targets))]
    # In a crowd, words would lie over the things that they name.
    called = {item.target.id: item.target.id if len(found) > MOST_IN_WORDS else _name(item, names) for item, _ in found}
    for item, colour in found:
        if item.box is not None:
            box = picture.frame.box_to_picture(item.box)
            draw_box(canvas, box.corners, "target", colour)
            named.append(_Named(box, called[item.target.id], colour, INK))
    paths = [_points(picture, arrow) for arrow in arrows if len(arrow) > 1]
    scale = 1 / float(picture.frame.T_view_picture[0, 0])
    strips = [width * scale for width, arrow in zip(widths, arrows, strict=True) if len(arrow) > 1] if widths else []
    for number, (path, width) in enumerate(zip(paths, strips, strict=False), start=1):
        draw_strip(canvas, path, width, step_colour(number))
    canvas.things += [picture.frame.box_to_picture(item.box).as_tuple for item, _ in found if item.box is not None]
    moves, turned = _moves_and_turns(picture, paths, turns)
    # What sweeps a strip goes straight; everything else bows, which leaves what lies between to be seen.
    bowed = [not width for width in strips] or [True] * len(paths)
    ways = dict(enumerate(bows(paths, canvas.size_px, bowed), start=1))
    labels = _draw_arrows(canvas, {number: ways[number] for number in moves})
    for turn in turned:
        labels += draw_turn(canvas, turn)
    for item, colour in found:
        labels += _draw_points(canvas, picture, item, colour, called[item.target.id], bool(paths))
    for number, move in moves.items():
        canvas.cross(move[-1], point_reach(canvas), step_colour(number))
    paint_plates(canvas, label_points(canvas, labels))
    for entry in named:
        label_box(canvas, entry.box, plain(entry.text), back=entry.back, colour=entry.colour, inside=entry.is_region)
    return canvas.rgb


def action_arrows(actions: Iterable[PlannedAction]) -> tuple[tuple[Point, ...], ...]:
    """One arrow per action that goes somewhere, through the pixels its numbers came from, in order [view px]."""
    paths = (tuple(source.point_px for source in action.sources) for action in actions)
    return tuple(path for path in paths if len(path) > 1)


def swept_widths(actions: Iterable[PlannedAction], blade_m: float | None, camera: Camera | None) -> tuple[float, ...]:
    """How wide a strip the tool sweeps in each of `action_arrows`, in order [view px]: 0 but for pushes of a known width."""
    moves = (planned for planned in actions if len(planned.sources) > 1)
    return tuple(swept_width(planned.action, blade_m, camera) for planned in moves)


def swept_width(action: Action | None, blade_m: float | None, camera: Camera | None) -> float:
    """How wide a strip one action sweeps, in the middle of its way [view px]; 0 where none is known."""
    motion = None if action is None else action.motion(None)
    if not isinstance(motion, Slide) or blade_m is None or camera is None:
        return 0.0
    start, end = motion.start_m, motion.end_m
    way = (end - start)[:2]
    if float(np.linalg.norm(way)) == 0:
        return 0.0
    across = np.array([-way[1], way[0], 0.0]) / np.linalg.norm(way) * blade_m / 2
    middle = (start + end) / 2
    try:
        (xa, ya), (xb, yb) = camera.project(np.array([middle - across, middle + across]))
    except ValueError:
        return 0.0  # behind the camera
    return float(math.hypot(xb - xa, yb - ya))


def _moves_and_turns(
    picture: Picture, paths: Sequence[Sequence[Point]], turns: Sequence[TurnMark]
) -> tuple[dict[int, Sequence[Point]], list[TurnMark]]:
    """Paths by their numbers, without those of things that are only turned, where the arc says so; turns [picture px]."""
    turned = {
        turn.label: replace(
            turn, corners=tuple(_points(picture, turn.corners)), centre=_points(picture, [turn.centre])[0]
        )
        for turn in turns
    }
    numbered = dict(enumerate(paths, start=1))
    still = {n for n, path in numbered.items() if str(n) in turned and stays(path, turned[str(n)])}
    return {n: path for n, path in numbered.items() if n not in still}, list(turned.values())


class _Named(NamedTuple):
    """A box [picture px] and the plate that names it."""

    box: Box
    text: str
    back: Colour
    colour: Colour
    is_region: bool = False


def _found(targets: Iterable[GroundedTarget]) -> list[GroundedTarget]:
    return [item for item in targets if item.status == "found"]


def _regions(
    keep_out: Sequence[KeepOut], workspace: Limits | Box | None
) -> Iterator[tuple[KeepOut, BoxStyle, str, float]]:
    """Regions to outline: what, in which style, under which name, at which height [m]; the workspace first."""
    if isinstance(workspace, Limits):
        table = KeepOut("", Box(*workspace.low_m[:2], *workspace.high_m[:2]), "m")
        yield table, "workspace", "", max(0.0, workspace.low_m[2])
        keep_out = (*keep_out, *(item for item in workspace.keep_out if item not in keep_out))
    elif workspace is not None:
        yield KeepOut("", workspace), "workspace", "", 0.0
    for item in keep_out:
        yield item, "keep_out", item.name, 0.0


def _draw_arrows(canvas: Canvas, ways: Mapping[int, Sequence[Point]]) -> list[PointLabel]:
    """All arrows by the numbers of their steps, a colour for each; returns the numbers, to be placed where they start."""
    draw_arrows(canvas, list(ways.values()), list(ways))
    return [start_label(canvas, path, str(number), step_colour(number)) for number, path in ways.items()]


def _name(item: GroundedTarget, names: Mapping[str, str] | None) -> str:
    return f"{item.target.id} {spoken(item.target.words, names or {})}"


def _draw_points(
    canvas: Canvas, picture: Picture, item: GroundedTarget, colour: Colour, name: str, moved: bool
) -> list[PointLabel]:
    """Where something is taken: a dot. Where it goes: a cross; once something moves, the arrows' ends get it instead.

    A target without a box is named at its points.
    """
    labels = []
    for role, point in item.points.items():
        (at,) = _points(picture, [point])
        if role in ("place", "push_end") and not moved:
            canvas.cross(at, point_reach(canvas), colour)
        elif role not in ("place", "push_end"):
            canvas.disc(at, candidate_radius(canvas) * 1.2, BLUE, WHITE)
        canvas.keep_clear(at, candidate_radius(canvas) * 1.4)
        if item.box is None:
            labels.append(PointLabel(at, plain(name), point_reach(canvas), colour, INK))
    return labels


def _outline(region: KeepOut, camera: Camera | None, z_m: float) -> tuple[Point, ...] | None:
    """Corners of a region in view px; None for metres without a camera, or behind it."""
    if region.unit == "px":
        return region.box.corners
    if camera is None:
        return None
    try:
        seen = camera.project([(x, y, z_m) for x, y in region.box.corners])
    except ValueError:
        return None  # a part of it lies behind the camera
    return tuple((float(x), float(y)) for x, y in seen) if np.isfinite(seen).all() else None


def _points(picture: Picture, points: Sequence[Point]) -> list[Point]:
    return [(float(x), float(y)) for x, y in picture.frame.to_picture(np.asarray(points, dtype=np.float64))]
