"""Ask a detector, whoever wrote it: what comes back are detections in order, or an error that names the detector and the value."""

from __future__ import annotations

import asyncio
import inspect
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.interrupts import in_thread
from wonderful_team.core.pictures import checked_rgb
from wonderful_team.core.protocols import Detector
from wonderful_team.core.values import Detection
from wonderful_team.errors import DetectorCodeError, code_of

WITHIN_S = 300.0
"""Longest time for one look at a picture, loading of weights included."""
MOST = 1000
"""Most detections of one look: more is a detector without a threshold."""
OVER_PX = 1.0
"""Rounding may push an edge this far out of the picture; it is cut there [px]."""


async def detect(
    detector: Detector, rgb: Array, words: Sequence[str], *, within_s: float = WITHIN_S
) -> tuple[Detection, ...]:
    """What a detector finds, in the order of the words, the surest first; a plain `detect` runs in a thread.

    Args:
        detector: Anything with `detect(rgb, words)`.
        rgb: Shape (H, W, 3), uint8.
        words: What to look for.
        within_s: Longest time [s].

    Raises:
        DetectorCodeError: It raised something of its own, did not come back in time, or returned no detections.
    """
    asked = tuple(dict.fromkeys(words))
    picture, whose = checked_rgb(rgb), f"detector {name_of(detector)!r}"
    try:
        found = await asyncio.wait_for(_looked(detector, picture, asked, whose), within_s)
    except TimeoutError as error:
        raise DetectorCodeError(f"{whose} did not come back within {within_s:g} s") from error
    return checked_detections(found, picture, asked, whose)


async def _looked(detector: Detector, rgb: Array, words: tuple[str, ...], whose: str) -> Any:
    with code_of(f"detect() of {whose}", DetectorCodeError):
        if inspect.iscoroutinefunction(detector.detect):
            return await detector.detect(rgb, words)
        found = await in_thread(detector.detect, rgb, words, name="detector")
        return await found if inspect.isawaitable(found) else found


def checked_detections(found: Any, rgb: Array, words: Sequence[str], whose: str) -> tuple[Detection, ...]:
    """What was returned, as detections that fit the picture and the question.

    Args:
        found: What `detect` returned.
        rgb: The picture, shape (H, W, 3).
        words: What it was asked for.
        whose: Begins messages, as in "detector 'mine'".

    Raises:
        DetectorCodeError: Something else than that; names the detector and the value.
    """
    if isinstance(found, str | bytes | Mapping) or not isinstance(found, Sequence):
        raise DetectorCodeError(f"{whose} returned a {type(found).__name__}; valid: a list of wt.Detection")
    if len(found) > MOST:
        raise DetectorCodeError(f"{whose} returned {len(found)} detections; valid: at most {MOST} for one picture")
    settled = [_checked(one, number, rgb, words, whose) for number, one in enumerate(found, start=1)]
    order = {text: place for place, text in enumerate(words)}
    return tuple(sorted(settled, key=lambda one: (order[one.words], -one.score, one.box.as_tuple)))


def _checked(one: Any, number: int, rgb: Array, words: Sequence[str], whose: str) -> Detection:
    said = f"{whose}, detection {number}"
    if not isinstance(one, Detection):
        raise DetectorCodeError(f"{said} is a {type(one).__name__}; valid: a wt.Detection(words, box, score, mask)")
    if one.words not in words:
        raise DetectorCodeError(f"{said} is for {one.words!r}, which was not asked for; valid: {', '.join(words)}")
    height, width = rgb.shape[:2]
    if one.mask is not None and one.mask.shape != (height, width):
        raise DetectorCodeError(
            f"{said} ({one.words!r}) has a mask of shape {one.mask.shape}; valid: {(height, width)}, the picture's"
        )
    view = Box(0, 0, width, height)
    inside = one.box.intersection(view)
    over = max(-one.box.x0, -one.box.y0, one.box.x1 - width, one.box.y1 - height)
    if inside is None or over > OVER_PX:
        edges = ", ".join(f"{edge:.1f}" for edge in one.box.as_tuple)
        raise DetectorCodeError(
            f"{said} ({one.words!r}) has the box ({edges}) px; valid: within the picture, "
            f"0 to {width} px across and 0 to {height} px down"
        )
    return one if inside == one.box else replace(one, box=inside)


def name_of(detector: Detector) -> str:
    """What records call it."""
    return str(getattr(detector, "name", type(detector).__name__))


def identity_of(detector: Detector) -> dict[str, str]:
    """What a record says of it: its name, and what it offers under `setting` (weights, revision, thresholds, device)."""
    setting = getattr(detector, "setting", {})
    told = {str(key): str(value) for key, value in setting.items()} if isinstance(setting, Mapping) else {}
    return {"name": name_of(detector), **told}


def found_words(detections: Sequence[Detection], words: Sequence[str]) -> str:
    """What was found, in one line: "red block 2 (0.91, 0.40), mug none"."""
    parts = []
    for text in dict.fromkeys(words):
        scores = [f"{one.score:.2f}" for one in detections if one.words == text]
        shown = ", ".join(scores[:3]) + (f" and {len(scores) - 3:,} more" if len(scores) > 3 else "")
        parts.append(f"{text}: {f'{len(scores)} ({shown})' if scores else 'none'}")
    return "; ".join(parts)
