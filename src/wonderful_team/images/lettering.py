"""Text as small coverage masks, made once per word and size with the font that ships inside Pillow."""

from __future__ import annotations

import unicodedata
from functools import lru_cache

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.redaction import redact

MAX_LABEL = 28
"""Longest label drawn, in characters; the rest becomes three dots."""


def plain(text: str) -> str:
    """The text in printable ASCII (accents dropped, other signs as ?), shortened: the built-in font has no more."""
    spelled = unicodedata.normalize("NFKD", redact(text).replace("ß", "ss"))
    kept = "".join(c for c in spelled if not unicodedata.combining(c))
    shown = "".join(c if " " <= c <= "~" else "?" for c in " ".join(kept.split()))
    return shown if len(shown) <= MAX_LABEL else shown[: MAX_LABEL - 3].rstrip() + "..."


@lru_cache(maxsize=2048)
def text_mask(text: str, size_px: int) -> Array:
    """Coverage of a line of text, 0 to 255, cut to its ink in x; its height depends on the size alone.

    Args:
        text: Printable ASCII.
        size_px: Height of the letters' body [px].

    Returns:
        Read-only mask, shape (h, w), uint8. Digits and capitals fill its height.
    """
    font = _font(size_px)
    ascent, descent = font.getmetrics()
    left, _, right, _ = font.getbbox(text or " ", anchor="ls", stroke_width=0)
    sheet = Image.new("L", (max(1, int(right - left) + 4), ascent + descent), 0)
    # A hairline stroke makes the regular cut read well at 12 px on photographs.
    ImageDraw.Draw(sheet).text(
        (2 - left, ascent), text, fill=255, font=font, anchor="ls", stroke_width=_weight(size_px)
    )
    mask = np.asarray(sheet)
    inked = np.flatnonzero(mask.any(axis=0))
    columns = slice(inked[0], inked[-1] + 1) if len(inked) else slice(0, 1)
    top = ascent - _cap_height(size_px)
    below = ascent + (max(1, descent // 2) if set(text) & set("gjpqy,;()[]{}|_/Q@$") else 0)
    mask = np.ascontiguousarray(mask[max(0, top) : below + 1, columns])
    mask.setflags(write=False)
    return mask


@lru_cache(maxsize=64)
def _font(size_px: int) -> ImageFont.FreeTypeFont:
    font = ImageFont.load_default(size_px)
    if not isinstance(font, ImageFont.FreeTypeFont):
        raise RuntimeError("Pillow was built without FreeType; install the wheel: pip install --force-reinstall pillow")
    return font


@lru_cache(maxsize=64)
def _cap_height(size_px: int) -> int:
    return int(-_font(size_px).getbbox("0H", anchor="ls")[1])


def _weight(size_px: int) -> float:
    return 0.2 if size_px < 20 else size_px / 80
