"""Names for shapes: an outline compared with drawn ideals of the canonical shapes and of letters, at any rotation."""

from __future__ import annotations

import string
from functools import cache

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.offline.description import SHAPES
from wonderful_team.offline.vision.outlines import Forms, Outline, overlaps, polar_form

_SIDE = 160
"""Side of the square that ideals are drawn in [px]."""


def _canvas() -> Array:
    return np.zeros((_SIDE, _SIDE), np.uint8)


def _polygon(points: list[tuple[float, float]]) -> Array:
    """Fill a polygon whose coordinates run from -1 to 1."""
    image = _canvas()
    scaled = np.array([[(x * 0.42 + 0.5) * _SIDE, (y * 0.42 + 0.5) * _SIDE] for x, y in points])
    cv2.fillPoly(image, [np.round(scaled * 16).astype(np.int32)], 1, shift=4)
    return image


def _regular(sides: int, inner: float | None = None) -> Array:
    """A regular polygon, or a star when `inner` gives the radius of its inner corners."""
    count = sides * (2 if inner else 1)
    return _polygon(
        [
            (
                (inner if inner and k % 2 else 1.0) * np.sin(2 * np.pi * k / count),
                -(inner if inner and k % 2 else 1.0) * np.cos(2 * np.pi * k / count),
            )
            for k in range(count)
        ]
    )


def _ellipse(ratio: float) -> Array:
    image = _canvas()
    cv2.ellipse(image, (80, 80), (64, max(2, round(64 / ratio))), 0, 0, 360, 1, cv2.FILLED, cv2.LINE_AA)
    return image


def _box(ratio: float) -> Array:
    return _polygon([(-1, -1 / ratio), (1, -1 / ratio), (1, 1 / ratio), (-1, 1 / ratio)])


def _cross(width: float) -> Array:
    image = _polygon([(-1, -width), (1, -width), (1, width), (-1, width)])
    return np.asarray(image | image.T)


def _heart(depth: float) -> Array:
    t = np.linspace(0, 2 * np.pi, 90)
    x = np.sin(t) ** 3
    y = -(13 * np.cos(t) - 5 * np.cos(2 * t) * depth - 2 * np.cos(3 * t) - np.cos(4 * t)) / 16
    return _polygon([(float(a), float(b)) for a, b in zip(x, y, strict=True)])


def _flower(petals: int, wave: float) -> Array:
    t = np.linspace(0, 2 * np.pi, 180)
    r = (1 - wave) + wave * np.cos(petals * t)
    return _polygon([(float(a), float(b)) for a, b in zip(r * np.sin(t), -r * np.cos(t), strict=True)])


def _lobes(petals: int, size: float) -> Array:
    """Round petals round a middle."""
    image = _canvas()
    for k in range(petals):
        angle = 2 * np.pi * k / petals
        centre = (80 + 64 * (1 - size) * np.sin(angle), 80 - 64 * (1 - size) * np.cos(angle))
        cv2.circle(image, (round(centre[0]), round(centre[1])), round(64 * size), 1, cv2.FILLED)
    cv2.circle(image, (80, 80), round(64 * (1 - size)), 1, cv2.FILLED)
    return image


def _corner_piece(width: float, second: float = 1.0) -> Array:
    return _polygon(
        [(-1, -1), (-1 + 2 * width, -1), (-1 + 2 * width, 1 - 2 * width), (-1 + 2 * second, 1 - 2 * width),
         (-1 + 2 * second, 1), (-1, 1)]
    )  # fmt: skip


def _crescent(shift: float) -> Array:
    image = _ellipse(1.0)
    cv2.circle(image, (round(80 + 64 * shift), 80), 62, 0, cv2.FILLED, cv2.LINE_AA)
    return image


def _pan(handle: float) -> Array:
    """A disc with a handle so many times its radius long."""
    image = _canvas()
    cv2.circle(image, (52, 80), 40, 1, cv2.FILLED)
    cv2.line(image, (52, 80), (round(86 + 40 * handle), 80), 1, 14)
    return image


@cache
def ideals() -> tuple[tuple[str, ...], Forms]:
    """Names and polar forms of the drawn ideals."""
    drawn: list[tuple[str, Array]] = [
        ("square", _box(1.0)),
        *(("rectangle", _box(ratio)) for ratio in (1.4, 1.8)),
        *(("long", _box(ratio)) for ratio in (2.6, 3.6, 5.0)),
        *(("long", _ellipse(ratio)) for ratio in (2.6, 3.6)),
        ("circle", _ellipse(1.0)),
        *(("oval", _ellipse(ratio)) for ratio in (1.3, 1.6, 2.0)),
        ("triangle", _regular(3)),
        ("triangle", _polygon([(0, -1), (0.6, 1), (-0.6, 1)])),
        ("triangle", _polygon([(-1, -1), (1, 1), (-1, 1)])),
        *(("diamond", _polygon([(0, -1), (wide, 0), (0, 1), (-wide, 0)])) for wide in (0.72, 0.56)),
        *((name, _regular(sides)) for name, sides in (("pentagon", 5), ("hexagon", 6))),
        *(("star", _regular(sides, inner)) for sides, inner in ((5, 0.38), (5, 0.52), (6, 0.55), (4, 0.4))),
        *(("heart", _heart(depth)) for depth in (1.0, 0.7)),
        *(("cross", _cross(width)) for width in (0.33, 0.24, 0.42)),
        *(("flower", _flower(n, w)) for n in (5, 6, 8) for w in (0.12, 0.2)),
        *(("flower", _lobes(n, s)) for n, s in ((4, 0.45), (5, 0.4), (6, 0.34), (8, 0.27))),
        *(("l-shape", _corner_piece(*size)) for size in ((0.33,), (0.45,), (0.33, 0.67), (0.25,))),
        *(("pan", _pan(handle)) for handle in (0.9, 1.3)),
        *(("crescent", _crescent(shift)) for shift in (0.35, 0.6)),
    ]
    return tuple(name for name, _ in drawn), Forms.of(np.stack([polar_form(image > 0)[0] for _, image in drawn]))


@cache
def letters() -> tuple[str, Forms, tuple[bool, ...]]:
    """Capital letters, their polar forms in several hands and which are holed; I and O have no outline of their own."""
    names, forms = "", []
    holed: list[bool] = []
    for letter in (name for name in string.ascii_uppercase if name not in "IO"):
        # Two typefaces, one of them in two weights, each narrower and wider: C and G differ less than two hands of G.
        hands = [polar_form(cv2.resize(image, None, fx=wide, fy=1) > 127) for image in _written(letter) for wide in (0.8, 1, 1.25)]  # fmt: skip
        names += letter * len(hands)
        forms += [polar for polar, _ in hands]
        holed += [hands[0][1] > 0] * len(hands)  # thick strokes may close a hole
    return names, Forms.of(np.stack(forms)), tuple(holed)


def _written(letter: str) -> list[Array]:
    size, font = _SIDE + 40, ImageFont.load_default(120)
    images = [Image.new("L", (size, size), 0) for _ in range(2)]
    for image, weight in zip(images, (2, 6), strict=True):
        ImageDraw.Draw(image).text((100, 100), letter, fill=255, font=font, anchor="mm", stroke_width=weight)
    other = np.zeros((size, size), np.uint8)
    cv2.putText(other, letter, (50, 150), cv2.FONT_HERSHEY_SIMPLEX, 4.0, 255, 20, cv2.LINE_AA)
    return [*map(np.asarray, images), other]


HOLES_SHOW = 1000.0
"""A letter of more pixels shows its holes."""
OTHER_HOLES = 0.85
"""What is left of the likeness to a letter that has holes where this has none, or the other way round."""


def shape_scores(outline: Outline) -> tuple[dict[str, float], dict[str, float]]:
    """How well each canonical shape fits, and each letter, 0 to 1."""
    names, forms = ideals()
    found, _ = overlaps(outline.outer, forms)
    best = dict.fromkeys(SHAPES, 0.0)
    for name, iou in zip(names, found, strict=True):
        best[name] = max(best[name], float(iou))
    glyphs, letter_forms, holed = letters()
    letter_ious, _ = overlaps(outline.polar, letter_forms)
    per_letter: dict[str, float] = {}
    clear = outline.filled_area > HOLES_SHOW
    for glyph, iou, hole in zip(glyphs, letter_ious, holed, strict=True):
        fit = float(iou) * (OTHER_HOLES if clear and hole != (outline.holes > 0) else 1.0)
        per_letter[glyph] = max(per_letter.get(glyph, 0.0), fit)
    # Convex letters (D, B) resemble plain shapes: a letter must have notches or holes.
    notched = float(np.clip((0.97 - outline.solidity) / 0.05, 0, 1)) if outline.holes == 0 else 1.0
    best["letter"] = max(per_letter.values()) * (0.8 + 0.2 * notched)
    best["ring"] = max(best["circle"], best["oval"])
    best["frame"] = max(best[name] for name in ("square", "rectangle", "pentagon", "hexagon", "diamond"))
    scores = {name: float(np.clip((iou - 0.62) / 0.34, 0, 1)) for name, iou in best.items()}
    _adjust(scores, outline)
    return scores, {glyph: float(np.clip((iou - 0.5) / 0.5, 0, 1)) for glyph, iou in per_letter.items()}


def _adjust(scores: dict[str, float], outline: Outline) -> None:
    """Weigh the template scores with plain measurements of the outline. In place."""
    open_inside = float(np.clip((outline.hole_share - 0.03) / 0.06, 0, 1))
    for name in ("ring", "frame"):
        scores[name] *= open_inside
    for name in scores:
        if name not in ("ring", "frame", "letter"):
            scores[name] *= 1 - 0.7 * open_inside
    spread = float(outline.profile.std() / max(outline.profile.mean(), 1e-6))
    wobble = _symmetry(outline.profile)
    scores["circle"] *= float(np.clip((0.075 - spread) / 0.035, 0.2, 1))
    scores["ring"] *= float(np.clip((0.12 - spread) / 0.04, 0.3, 1))
    scores["frame"] *= float(np.clip((spread - 0.05) / 0.03, 0.3, 1))
    scores["long"] = max(scores["long"], 0.9 * float(np.clip((outline.aspect - 1.9) / 0.6, 0, 1)))
    for sides, name in ((3, "triangle"), (5, "pentagon"), (6, "hexagon"), (4, "square")):
        strongest = int(np.argmax(wobble[2:9])) + 2
        scores[name] *= 1.0 if strongest == sides or name in ("triangle", "square") else 0.6
    for name in ("pentagon", "hexagon"):
        scores[name] *= float(np.clip((outline.solidity - 0.93) / 0.03, 0.3, 1))
    scores["square"] *= float(np.clip((1.28 - outline.aspect) / 0.12, 0, 1))
    scores["flower"] *= float(np.clip((0.965 - outline.solidity) / 0.025, 0.2, 1)) * float(
        np.clip((outline.solidity - 0.7) / 0.1, 0, 1)
    )
    scores["star"] *= float(np.clip((0.95 - outline.solidity) / 0.08, 0.1, 1))
    scores["bowl"] = 0.5 * max(scores["circle"], scores["ring"])


def _symmetry(profile: Array) -> Array:
    """Strength of each n-fold symmetry of the outer edge, index = n."""
    return np.asarray(np.abs(np.fft.rfft(profile - profile.mean())) / len(profile))
