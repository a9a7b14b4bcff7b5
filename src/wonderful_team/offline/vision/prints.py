"""What is printed in a picture, read by an OCR engine: prices and ranks alone, and never as words to act on."""

from __future__ import annotations

import math
import re
import threading
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Picture
from wonderful_team.errors import MissingExtraError

LONGEST_PX = (1600, 1920)
"""Smaller pictures are enlarged for the engine, which misses small print: to one size after the other, as it misses other lines in each."""
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
_read: OrderedDict[str, tuple[Card, ...]] = OrderedDict()
_KEPT = 16


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


def read_cards(picture: Picture) -> tuple[Card, ...]:
    """Everything that is printed in a picture; looking twice at the same pixels costs nothing.

    Raises:
        MissingExtraError: No OCR engine is installed.
    """
    with _lock:
        if picture.hash not in _read:
            _read[picture.hash] = _cards(_lines(picture))
            while len(_read) > _KEPT:
                _read.popitem(last=False)
        return _read[picture.hash]


def _lines(picture: Picture) -> list[tuple[str, Box]]:
    """Every line that is read in some size, once."""
    lines: list[tuple[str, Box]] = []
    for longest in LONGEST_PX:
        for text, box in _lines_at(picture, max(1.0, longest / max(picture.size_px))):
            if not any(known.contains(box.centre) or box.contains(known.centre) for _, known in lines):
                lines.append((text, box))
    return lines


def _lines_at(picture: Picture, zoom: float) -> list[tuple[str, Box]]:
    width, height = picture.size_px
    size = (round(width * zoom), round(height * zoom))
    said = _ocr()(cv2.resize(np.asarray(picture.rgb), size, interpolation=cv2.INTER_CUBIC)[..., ::-1])
    if said.txts is None:
        return []
    read = zip(said.txts, said.boxes, said.scores, strict=True)
    return [
        (str(text), Box.bounding([(float(x), float(y)) for x, y in np.asarray(corners) / zoom]))
        for text, corners, score in read
        if score >= SURE and picture.frame.valid.contains(tuple(np.mean(corners, axis=0) / zoom))
    ]


def _ocr() -> Any:
    if not _engine:
        try:
            from rapidocr import RapidOCR
        except ImportError as error:
            raise MissingExtraError("offline reads print with an OCR engine", "ocr") from error
        _engine.append(RapidOCR(params={"Global.use_cls": False, "Global.log_level": "error"}))
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
