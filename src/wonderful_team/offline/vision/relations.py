"""Relations between things as the picture shows them, and superlatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.offline.description import LINE_BY_LINE, OPPOSITE
from wonderful_team.offline.vision.examples import alike_colour, alike_pattern
from wonderful_team.offline.vision.outlines import filled, largest_contour, same_form, study_outline
from wonderful_team.offline.vision.things import Look, Match, Scene, Thing

DIRECTIONS = {"left_of": (-1.0, 0.0), "right_of": (1.0, 0.0), "above": (0.0, -1.0), "below": (0.0, 1.0)}
"""Unit vectors in the picture: x right, y down."""


def relation_score(relation: str, thing: Thing, others: Sequence[Thing], scene: Scene) -> float:
    """How well a thing stands in a relation to others, 0 to 1; `between` takes two others, the rest one."""
    other = others[0]
    if relation in DIRECTIONS:
        return direction_score(relation, thing.centre, other.centre)
    distance = float(np.hypot(thing.centre[0] - other.centre[0], thing.centre[1] - other.centre[1]))
    diagonal = float(np.hypot(scene.valid.width, scene.valid.height))
    match relation:
        case "near":
            sizes = thing.radius_px + other.radius_px
            return float(np.clip(1.1 - (distance - sizes) / max(sizes, NEAR * scene.table.width), 0, 1))
        case "nearest":
            return float(np.clip(1.2 - 2.5 * distance / diagonal, 0.05, 1))
        case "far_from":
            return float(np.clip(2.5 * distance / diagonal - 0.2, 0.05, 1))
        case "on" | "inside":
            if thing.on == other.number or (thing.area_px < other.area_px and other.covers(thing.centre)):
                return 1.0
            return 0.0
        case "between":
            return _between(thing, others[0], others[1])
        case "same_colour":
            return _alike_colour(thing.look, other.look)
        case "same_pattern":
            # A texture is a surface as a whole: its colours and how they are spread.
            return _alike_colour(thing.look, other.look) * (0.4 + 0.6 * alike_pattern(thing.look, other.look))
        case "same_shape":
            one, two = _body(thing), _body(other)
            alike = same_form(study_outline(one), study_outline(two))
            # A rectangle that is nearly a square has a square's corners all the same.
            return max(alike, 0.8 * same_form(study_outline(_evened(one)), study_outline(_evened(two))))
        case _:
            raise ValueError(f"unknown relation {relation!r}")


def _alike_colour(one: Look, other: Look) -> float:
    """Likeness of two surfaces' colours, 0 to 1; the bottom of a plain tray lies in the shade of its rim."""
    alike, labs = alike_colour(one, other), [np.array(look.colours[0].lab) for look in (one, other)]
    shade = float(np.linalg.norm(labs[0])) / max(float(np.linalg.norm(labs[1])), 1.0)
    if len(one.colours) > 1 or len(other.colours) > 1 or not 1 / _RIM_SHADE < shade < _RIM_SHADE:
        return alike
    return max(alike, float(np.clip(1 - np.linalg.norm(labs[0] - shade * labs[1]) / _OTHER_COLOUR, 0, 1)))


def _body(thing: Thing) -> Array:
    """The filled mask of a thing without thin parts that stick out, such as a handle, padded."""
    size = max(3, int(0.55 * thing.radius_px / thing.zoom) | 1)
    whole = np.pad(filled(thing.mask), size).astype(np.uint8)
    opened = cv2.morphologyEx(whole, cv2.MORPH_OPEN, cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size)))
    return np.asarray(opened > 0 if opened.any() else whole > 0)


NEAR = 0.12
"""Things next to each other are no further apart than both are wide together, or this share of the table's width."""

_RIM_SHADE = 1.25
"""Ratio of light up to which two plain surfaces may be one colour."""

_OTHER_COLOUR = 15.0
"""CIELAB distance, shade apart, from which plain surfaces are of other colours."""

_EVENED_SIDE = 64
"""Side of the square that a body is stretched to [px]."""

_NEARLY_EVEN = 1.5
"""Long over short side up to which a body is stretched."""


def _evened(body: Array) -> Array:
    """A body whose tightest rectangle is stretched to a square; a clearly long one as it is."""
    rectangle = cv2.minAreaRect(largest_contour(body))
    if max(rectangle[1]) + 1 > _NEARLY_EVEN * (min(rectangle[1]) + 1):
        return body
    side, rim = _EVENED_SIDE, 8
    corners = np.array([[rim, rim + side], [rim, rim], [rim + side, rim]], np.float32)
    warp = cv2.getAffineTransform(cv2.boxPoints(rectangle)[:3].astype(np.float32), corners)
    return np.asarray(cv2.warpAffine(body.astype(np.uint8), warp, (side + 2 * rim, side + 2 * rim)) > 0)


def direction_score(relation: str, point: tuple[float, float], origin: tuple[float, float]) -> float:
    """How well a point lies in a direction of another: 1 straight, 0.5 at 45 degrees, 0 from 80 degrees on."""
    dx, dy = point[0] - origin[0], point[1] - origin[1]
    distance = float(np.hypot(dx, dy))
    if distance < 1e-6:
        return 0.0
    direction = DIRECTIONS[relation]
    angle = np.degrees(np.arccos(np.clip((dx * direction[0] + dy * direction[1]) / distance, -1, 1)))
    return float(np.clip(1.0 - max(angle - 15.0, 0.0) / 65.0, 0, 1))


def _between(thing: Thing, one: Thing, other: Thing) -> float:
    a, b, p = np.array(one.centre), np.array(other.centre), np.array(thing.centre)
    span = b - a
    length = float(np.linalg.norm(span))
    if length < 1e-6:
        return 0.0
    along = float((p - a) @ span) / length**2
    aside = float(abs(span[0] * (p - a)[1] - span[1] * (p - a)[0])) / length**2
    return float(np.clip(min(along, 1 - along) / 0.15, 0, 1) * np.clip(1.2 - 2 * aside, 0, 1))


def pick_superlative(matches: list[Match], superlative: str, ordinal: int) -> list[Match]:
    """The one (or those nearly equal) that a superlative picks among what fits; the others are dropped.

    An `ordinal` beyond what fits gives [].
    """
    placed = [match for match in matches if match.thing is not None]
    if len(placed) < ordinal:
        return []
    if superlative == "middle":
        return _middle(placed)
    if superlative in LINE_BY_LINE:
        return in_lines(placed, superlative)[ordinal - 1 : ordinal]
    keys = superlative_keys([match.thing for match in placed if match.thing is not None], superlative)
    order = np.argsort(keys, kind="stable")
    chosen = int(order[ordinal - 1])
    neighbours = [int(order[k]) for k in (ordinal - 2, ordinal) if 0 <= k < len(order)]
    measured = superlative in OPPOSITE
    scale = max(abs(keys[chosen]), 1e-6) if measured else 0.5 * placed[chosen].box.width
    lead = min((abs(keys[k] - keys[chosen]) / scale for k in neighbours), default=1.0)
    best = placed[chosen]
    sure = float(np.clip(0.5 + 5 * lead, 0, 1))
    return [replace(best, score=best.score * sure, why=f"{best.why}, {superlative} {sure:.2f}")]


APART, TOGETHER = 0.4, 0.2
"""Two lines of things are apart, two things in one line, by these shares of a thing's width."""


def in_lines(placed: list[Match], superlative: str) -> list[Match]:
    """All in the order in which a field is counted; the less certain it is in which line one lies, the lower its score."""
    across, along = (0, 1) if superlative == "column by column" else (1, 0)
    points = np.array([match.point for match in placed])
    size = float(np.median([(match.box.width, match.box.height)[across] for match in placed]))
    order = np.argsort(points[:, across], kind="stable")
    gaps = np.diff(points[order, across]) / size
    line = np.zeros(len(placed), int)
    line[order] = np.concatenate([[0], np.cumsum(gaps > (APART + TOGETHER) / 2)])
    doubtful = {
        int(line[order[k + side]]) for k in np.flatnonzero((gaps > TOGETHER) & (gaps < APART)) for side in (0, 1)
    }
    counted = np.lexsort((points[:, along], line))
    return [replace(placed[k], score=placed[k].score * (0.5 if int(line[k]) in doubtful else 1.0)) for k in counted]


OUTER = 1 / 3
"""A side or corner of the table is the part nearer to its edges than this share of the table's width and height."""
CORNER = 1 / 4
"""The same for what is said to lie in a corner."""


def shares_from(scene: Scene, point: tuple[Any, Any], wishes: str) -> list[Any]:
    """How far a point (or each of many) is from a side, both sides of a corner or the middle of the table, as shares of it."""
    table = scene.table
    x, y = (point[0] - table.x0) / table.width, (point[1] - table.y0) / table.height
    shares = {
        "leftmost": x,
        "rightmost": 1 - x,
        "topmost": y,
        "bottommost": 1 - y,
        "middle": np.maximum(abs(x - 0.5), abs(y - 0.5)),
    }
    return [shares[wish] for wish in wishes.split()]


def is_at(scene: Scene, point: tuple[Any, Any], wishes: str, within: float = OUTER) -> Any:
    """Whether a point (or each of many) lies at that side, corner or middle of the table."""
    return np.maximum.reduce(shares_from(scene, point, wishes)) <= within


def pick_in_corner(scene: Scene, matches: list[Match], corner: str) -> list[Match]:
    """What lies in a corner of the table, the nearest to it first."""
    there = [match for match in matches if is_at(scene, match.box.centre, corner, CORNER)]
    return sorted(there, key=lambda match: sum(shares_from(scene, match.box.centre, corner)))[:1]


def superlative_keys(things: Sequence[Thing], superlative: str) -> list[float]:
    """Sort keys of several things: the smallest is picked; where heights do not show, the taller one is the larger one."""
    if superlative in ("tallest", "shortest") and any(_tall(thing) is None for thing in things):
        superlative = "largest" if superlative == "tallest" else "smallest"
    return [_superlative_key(thing, superlative) for thing in things]


def _superlative_key(thing: Thing, superlative: str) -> float:
    measure = _MEASURES.get(superlative)
    return -_MEASURES[_LEAST[superlative]](thing) if measure is None else measure(thing)


def _light(thing: Thing) -> float:
    """Mean lightness of a thing's colours."""
    light = sum(colour.lab[0] * colour.share for colour in thing.look.colours)
    return light / max(sum(colour.share for colour in thing.look.colours), 1e-6)


_MEASURES: dict[str, Callable[[Thing], float]] = {
    "smallest": lambda thing: thing.area_px,
    "leftmost": lambda thing: thing.centre[0],
    "topmost": lambda thing: thing.centre[1],
    "darkest": _light,
    "shortest": lambda thing: _tall(thing) or 0.0,
}
_LEAST = {"largest": "smallest", "rightmost": "leftmost", "bottommost": "topmost", "nearest": "topmost",
          "lightest": "darkest", "tallest": "shortest"}  # fmt: skip
"""The measure that a superlative is the most of; the picture's bottom is nearest to the viewer."""


def _tall(thing: Thing) -> float | None:
    """How tall a thing is, by its measured height or by what a second view shows of its side; None when neither is known."""
    return thing.height_m if thing.height_m is not None else thing.tall_px


def _middle(matches: list[Match]) -> list[Match]:
    """The middle one along the direction in which the things are spread."""
    if len(matches) < 3:
        return matches if len(matches) == 1 else []
    points = np.array([match.thing.centre for match in matches if match.thing is not None])
    spread = points - points.mean(axis=0)
    axis = 0 if spread[:, 0].std() >= 0.7 * spread[:, 1].std() else 1
    order = np.argsort(points[:, axis], kind="stable")
    return [matches[int(order[len(order) // 2])]] if len(order) % 2 else []
