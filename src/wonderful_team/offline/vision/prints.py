"""What is printed in a picture, read by an OCR engine: prices and ranks alone, and never as words to act on."""

from __future__ import annotations

import math
import re
import threading
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Picture
from wonderful_team.errors import MissingExtraError

LONGEST_PX = 1920
"""Smaller pictures are enlarged to this for the engine, which misses small print [px]."""
LEAST_SIDE_PX = 320
"""The engine enlarges smaller crops to this by itself [px]; its own 736 costs four times as much and reads no better."""
CUT_PX = 2
"""A line so near to the edge of a crop may go on beyond it [px of the picture]."""
SURE = 0.6
"""Lines that the engine is less sure of are left out (0 to 1)."""
TOGETHER = 0.8
"""Lines whose gap is less than this share of their height belong to one card."""
AS_HIGH = 1.8
"""Lines of a card are at most so many times as high as each other."""
_NUMBER = r"(\d+(?:[.,]\d{1,2})?)"
_CURRENCY = r"(?:[$€£]|usd|eur|s(?=\d))"
_PRICE = re.compile(
    rf"(?:{_CURRENCY}\s*{_NUMBER}|{_NUMBER}\s*(?:€|£|usd|eur|ct))(?:\s*(?:each|a piece))?", re.IGNORECASE
)
_OFF = re.compile(rf"[-−–~]\s*{_NUMBER}\s*%|{_NUMBER}\s*%\s*(?:off|discount|less)", re.IGNORECASE)
_FOR = re.compile(r"(\d+)\s*for\s*(\d+)", re.IGNORECASE)
_PIECES = re.compile(rf"(\d+)\s*for\s*{_CURRENCY}\s*{_NUMBER}", re.IGNORECASE)
_FREE = re.compile(r"buy\s*(\d+|one)\s*,?\s*get\s*(\d+|one)\s*free|bogo", re.IGNORECASE)
_HALF = re.compile(r"half\s*(?:price|off)", re.IGNORECASE)
_RANK = re.compile(r"(?:no\.?|nr\.?|#|rank|place)?\s*([1-9]\d?)\s*[a-z]{0,2}\.?", re.IGNORECASE)
"""A number decides; what stands behind it in small letters ("st", "rd") is often misread."""
_ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth")
_lock = threading.Lock()
_engine: list[Any] = []
_read: OrderedDict[tuple[str, tuple[float, ...]], list[tuple[str, Box, float]]] = OrderedDict()
_KEPT = 512
"""So many parts of pictures are not read again."""


@dataclass(frozen=True)
class Card:
    """Lines of print that belong together, from top to bottom.

    Attributes:
        box: Where they stand [px of the picture].
    """

    lines: tuple[str, ...]
    box: Box

    @property
    def price(self) -> float | None:
        """What one piece costs by the card after its discounts; None where it states no price."""
        pieces = next((found for line in self.lines if (found := _PIECES.search(line))), None)
        if pieces is not None:
            return _value(pieces[2]) / max(1, int(pieces[1]))
        prices = [found for line in self.lines if (found := _PRICE.fullmatch(line.strip()))]
        if len(prices) != 1:
            return None
        return _value(prices[0][1] or prices[0][2]) * math.prod(_paid(line) for line in self.lines)

    @property
    def rank(self) -> int | None:
        """The place in an order that it states, from 1; None where it states none."""
        if len(self.lines) != 1:
            return None
        word = self.lines[0].strip().lower()
        if word in _ORDINALS:
            return _ORDINALS.index(word) + 1
        found = _RANK.fullmatch(word)
        return int(found[1]) if found else None


def read_cards(picture: Picture, around: Sequence[Box]) -> tuple[Card, ...]:
    """Everything that is printed in some parts of a picture, each looked at closely: in a whole picture small print is missed.

    Looking twice at the same pixels costs nothing.

    Args:
        picture: Its pixels; marks are not read.
        around: The parts [px of the picture].

    Raises:
        MissingExtraError: No OCR engine is installed.
    """
    with _lock:
        return _cards(_lines(picture, around))


def _lines(picture: Picture, around: Sequence[Box]) -> list[tuple[str, Box]]:
    """Every line once, as it was read most surely."""
    lines: list[tuple[str, Box]] = []
    found = sorted((line for box in around for line in _known_lines(picture, box)), key=lambda line: -line[2])
    for text, box, _ in found:
        if not any(known.contains(box.centre) or box.contains(known.centre) for _, known in lines):
            lines.append((text, box))
    return lines


def _known_lines(picture: Picture, part: Box) -> list[tuple[str, Box, float]]:
    """`_lines_in`, read once."""
    key = (picture.hash, part.as_tuple)
    if key not in _read:
        _read[key] = _lines_in(picture, part)
        while len(_read) > _KEPT:
            _read.popitem(last=False)
    return _read[key]


def _lines_in(picture: Picture, part: Box) -> list[tuple[str, Box, float]]:
    """Lines wholly inside a part of the picture, and how sure the engine is of each."""
    shown = part.intersection(picture.frame.valid)
    if shown is None or min(shown.width, shown.height) < 1:
        return []
    x0, y0, x1, y1 = (round(value) for value in shown.as_tuple)
    zoom = max(1.0, LONGEST_PX / max(picture.size_px))
    crop = cv2.resize(np.asarray(picture.rgb)[y0:y1, x0:x1], None, fx=zoom, fy=zoom, interpolation=cv2.INTER_CUBIC)
    said = _ocr()(crop[..., ::-1])
    if said.txts is None:
        return []
    inner = Box(x0, y0, x1, y1).grown(-CUT_PX, -CUT_PX, -CUT_PX, -CUT_PX)
    lines = []
    for text, corners, score in zip(said.txts, said.boxes, said.scores, strict=True):
        box = Box.bounding([(x0 + float(x) / zoom, y0 + float(y) / zoom) for x, y in corners])
        if score >= SURE and inner.contains((box.x0, box.y0)) and inner.contains((box.x1, box.y1)):
            lines.append((str(text), box, float(score)))
    return lines


def _ocr() -> Any:
    if not _engine:
        try:
            from rapidocr import RapidOCR
        except ImportError as error:
            raise MissingExtraError("offline reads print with an OCR engine", "ocr") from error
        sizes = {"Det.limit_side_len": LEAST_SIDE_PX, "Det.limit_type": "min"}
        _engine.append(RapidOCR(params={"Global.use_cls": False, "Global.log_level": "error", **sizes}))
    return _engine[0]


def _cards(lines: list[tuple[str, Box]]) -> tuple[Card, ...]:
    """Lines under each other and close together make one card."""
    cards: list[Card] = []
    for text, box in sorted(lines, key=lambda line: line[1].y0):
        for at, card in enumerate(cards):
            across = min(box.x1, card.box.x1) - max(box.x0, card.box.x0)
            height = card.box.height / len(card.lines)
            alike = max(box.height, height) < AS_HIGH * min(box.height, height)
            if alike and across > 0 and abs(box.y0 - card.box.y1) < TOGETHER * box.height:
                cards[at] = Card((*card.lines, text), Box.bounding([*card.box.corners, *box.corners]))
                break
        else:
            cards.append(Card((text,), box))
    return tuple(cards)


def _paid(line: str) -> float:
    """The share of the price that is to be paid by what a line offers; 1 where it offers nothing."""
    if found := _OFF.search(line):
        return max(0.0, 1 - _value(found[1] or found[2]) / 100)
    if found := _FREE.search(line):
        bought, free = (1 if word in (None, "one") else int(word) for word in (found[1], found[2]))
        return bought / max(1, bought + free)
    if found := _FOR.fullmatch(line.strip()):
        taken, charged = int(found[1]), int(found[2])
        return charged / taken if 0 < charged <= taken else 1.0
    return 0.5 if _HALF.search(line) else 1.0


def _value(digits: str) -> float:
    return float(digits.replace(",", "."))
