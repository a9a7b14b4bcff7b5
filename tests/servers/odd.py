"""A vision model with odd habits behind a server: it looks at the pixels that came, in the size that it sees them in.

It knows colours by eye, finds the coloured things that a ReadScene request lists, and says where they are in a convention of
its own. Nothing is told to it but the request.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np

from tests.servers.heard import Heard, Reply
from tests.servers.speech import Seat, Speech, say

HUES: dict[str, tuple[float, float]] = {
    "red": (-8, 8),
    "orange": (10, 21),
    "yellow": (22, 34),
    "green": (45, 75),
    "cyan": (82, 97),
    "blue": (105, 122),
    "purple": (130, 150),
}
"""Range of OpenCV's hue (0 to 180) of each colour."""
_TARGET = re.compile(r"^- (T\d+) \(object\): (\w+) (\w+)", re.MULTILINE)
_CAPTION = re.compile(r'Picture "([^"]+)" \([^)]*\)[^\n]*:\s*$')
_ANSWER_IN = re.compile(r'Answer with positions in (?:the sheet, for what )?picture "([^"]+)"')


@dataclass
class OddEyes:
    """The model.

    Attributes:
        speech: How it says where things are.
        sees: all pictures; first or last: the others are dropped without a word.
        noise: Standard deviation of its pointing, as a share of the diagonal.
        wild: Share of its answers that are anywhere.
        nonsense: Every place is anywhere.
        box_order: Which of (x0, y0, x1, y1) it writes, in order; corners, or another habit.
        obeys: It follows wishes about the form of its reply (no schema holds it).
        spoken: Requests answered, with the pictures that came.
    """

    speech: Speech = field(default_factory=Speech)
    sees: str = "all"
    noise: float = 0.0
    wild: float = 0.0
    nonsense: bool = False
    twist_box: Callable[[dict[str, float]], dict[str, float]] | None = None
    obeys: bool = False
    misses: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng(self.seed)

    def __call__(self, heard: Heard) -> Reply:
        named = _pictures_by_name(heard)
        if self.sees == "first":
            named = named[:1]
        elif self.sees == "last":
            named = named[-1:]
        wanted = _ANSWER_IN.search(heard.words)
        name = wanted.group(1) if wanted else ""
        picture = next((rgb for other, rgb in named if other == name), named[0][1])
        value, size = self._reading(heard.words, picture)
        text = json.dumps(say(value, heard.schema, self.speech, Seat(size, size)))
        if self.obeys and "READY" in heard.words:
            text = f"READY\n{text}"
        return Reply(text)

    def _reading(self, words: str, sent: np.ndarray) -> tuple[dict[str, Any], tuple[int, int]]:
        """A SceneReading in pixels of the picture as it was sent, found in the picture as the model sees it."""
        size = (sent.shape[1], sent.shape[0])
        seen = size if self.speech.resize is None else self.speech.resize(size)
        rgb = sent if seen == size else cv2.resize(sent, seen, interpolation=cv2.INTER_AREA)
        back = np.array(size) / np.array(seen)
        targets = []
        for name, colour, _shape in _TARGET.findall(words):
            box = find_colour(rgb, colour)
            if box is None or self._rng.random() < self.misses:
                targets.append({"id": name, "found": False, "box": None, "points": []})
                continue
            x0, y0, x1, y1 = self._shaken(np.array(box) * np.tile(back, 2), size)
            corners = {"x0": x0, "y0": y0, "x1": x1, "y1": y1}
            if self.twist_box is not None:
                corners = self.twist_box(corners)
            point = {"x": (x0 + x1) / 2, "y": (y0 + y1) / 2}
            targets.append({"id": name, "found": True, "box": corners, "points": [{"role": "pick", "point": point}]})
        return {"reasoning": "by colour", "targets": targets}, size

    def _shaken(self, box: np.ndarray, size: tuple[int, int]) -> np.ndarray:
        shift = self._rng.normal(0, 1, 2) * self.noise * float(np.hypot(*size))
        if self.nonsense or self._rng.random() < self.wild:
            shift = self._rng.uniform(0, 1, 2) * size - (box[:2] + box[2:]) / 2
        return box + np.tile(shift, 2)


def find_colour(rgb: np.ndarray, colour: str) -> tuple[float, float, float, float] | None:
    """Box of the largest patch of a colour (x0, y0, x1, y1) [px]; None when there is none."""
    hsv = cv2.cvtColor(np.ascontiguousarray(rgb), cv2.COLOR_RGB2HSV)
    hue, strength, value = (hsv[..., k].astype(float) for k in range(3))
    if colour == "black":
        mask = value < 60
    elif colour in HUES:
        low, high = HUES[colour]
        turned = np.where(hue > 170, hue - 180, hue) if low < 0 else hue
        mask = (turned >= low) & (turned <= high) & (strength > 130) & (value > 80)
    else:
        return None
    count, _, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    if count < 2:
        return None
    best = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    x, y, width, height, area = (int(v) for v in stats[best])
    return (float(x), float(y), float(x + width), float(y + height)) if area >= 12 else None


def _pictures_by_name(heard: Heard) -> list[tuple[str, np.ndarray]]:
    """Every picture with the name that its caption gives it, in order."""
    named, before = [], ""
    for piece in heard.pieces:
        if isinstance(piece, str):
            before = piece
            continue
        caption = _CAPTION.search(before)
        named.append((caption.group(1) if caption else "", piece))
        before = ""
    return named
