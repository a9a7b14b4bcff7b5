"""Pictures inside the page: each stands once, as a data URI, and is shown wherever it is used."""

from __future__ import annotations

import base64
import io
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import cv2
import numpy as np
from markupsafe import Markup, escape
from PIL import Image

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.heap import stay_low
from wonderful_team.core.text import PLACEHOLDER, recorded_names
from wonderful_team.images import OWN_FORMATS, open_picture, to_jpeg
from wonderful_team.pages.variants import Bases, Patch
from wonderful_team.record.picture_store import AS_IT_IS_BYTES, PAGE_BYTES, PAGE_QUALITY, AtHand

MOST_BYTES = PAGE_BYTES
"""Beyond, pictures get coarser, not fewer."""
_LEVELS = ((2000, 92), (1400, 82), (1000, 72), (640, 60), (400, 45), (240, 35))
_LOSSLESS_BELOW_PX = 300 * 300
_OPENED_BYTES = 24_000_000
"""So much of what was decoded is kept until it is coded."""
_SAMPLED = 10
"""About so many pictures tell how large all will be."""


@dataclass(frozen=True)
class Shown:
    """A picture that the page holds.

    Attributes:
        number: Names it inside the page.
        size_px: Width, height of the file.
        file: Relative to the run folder.
    """

    number: int
    size_px: tuple[int, int]
    file: str


_Part: TypeAlias = tuple[Shown, Patch | None]
"""A picture, or a place of one."""


class Album:
    """All pictures of one page.

    Args:
        folder: The run folder.
        files: From hash to file, as the record says.
        at_hand: Pixels of its files, and PNG files turned into JPEG already, as `_quickly` does it.
    """

    def __init__(self, folder: Path, files: dict[str, str], at_hand: AtHand | None = None) -> None:
        self._folder = folder
        self._files = files
        self._at_hand = at_hand or AtHand()
        self._shown: dict[str, Shown | None] = {}
        self._opened: dict[int, Array] = {}

    def get(self, key: str | None) -> Shown | None:
        """The picture with that hash, taken into the page; None when its file is missing."""
        if key is None:
            return None
        if key not in self._shown:
            self._shown[key] = self._open(key)
        return self._shown[key]

    def _open(self, key: str) -> Shown | None:
        file = self._files.get(key)
        if file is None:
            return None
        path = (self._folder / file).resolve()
        if not path.is_relative_to(self._folder.resolve()):
            return None
        try:
            with open_picture(path, OWN_FORMATS) as image:
                return Shown(len(self._shown) + 1, image.size, file)
        except OSError:
            return None

    def image(self, key: str | None, alt: str, css: str = "") -> Markup:
        """The picture as it is, no wider than its file says; words in its place when the file is missing."""
        shown = self.get(key)
        if shown is None:
            return Markup('<span class="missing">picture missing: {}</span>').format(alt)
        width, height = shown.size_px
        return Markup(
            '<svg class="picture {}" viewBox="0 0 {} {}" width="{}" role="img" aria-label="{}"><title>{}</title>'
            '<use href="#p{}"/></svg>'
        ).format(css, width, height, width, alt, alt, shown.number)

    def definitions(self) -> Markup:
        """Every picture once, to be referred to; of one that is another with a few changes, the changes alone."""
        taken = [shown for shown in self._shown.values() if shown is not None]
        variants = self._variants(taken)
        parts = [
            (shown, patch)
            for shown in taken
            for patch in (variants[shown.number][1] if shown.number in variants else (None,))
        ]
        for coded in self._ways(parts):
            if sum(len(code) for _, code in coded) <= MOST_BYTES:
                break
        held: dict[int, list[Markup]] = {shown.number: [] for shown in taken}
        for (shown, patch), (kind, code) in zip(parts, coded, strict=True):
            held[shown.number].append(_held(shown, patch, kind, code))
        self._opened.clear()
        lines = []
        for number, pieces in held.items():
            if number in variants:
                base = Markup('<use href="#p{}"/>').format(variants[number][0])
                pieces = [Markup('<g id="p{}">{}{}</g>').format(number, base, Markup("").join(pieces))]
            lines += pieces
        return Markup("\n").join(lines)

    def _variants(self, taken: Sequence[Shown]) -> dict[int, tuple[int, tuple[Patch, ...]]]:
        """From a picture's number to that of the one that it is a variant of, and where it differs."""
        bases, found = Bases(), dict[int, tuple[int, tuple[Patch, ...]]]()
        sizes = Counter(shown.size_px for shown in taken)
        for shown in taken:
            if sizes[shown.size_px] > 1 and (self._folder / shown.file).stat().st_size > AS_IT_IS_BYTES:
                variant = bases.place(shown.number, self._pixels(shown))
                if variant is not None:
                    found[shown.number] = variant
        return found

    def _pixels(self, shown: Shown, patch: Patch | None = None) -> Array:
        rgb = self._opened.get(shown.number)
        if rgb is None:
            rgb = self._at_hand.pixels.get(shown.file)
        if rgb is None:
            stay_low()
            with open_picture(self._folder / shown.file, OWN_FORMATS) as opened:
                # Nothing is copied that need not be: a page of a long run decodes many.
                rgb = np.asarray(opened if opened.mode == "RGB" else opened.convert("RGB"))
            while self._opened and sum(one.nbytes for one in self._opened.values()) + rgb.nbytes > _OPENED_BYTES:
                self._opened.pop(next(iter(self._opened)))
            self._opened[shown.number] = rgb
        return rgb if patch is None else rgb[patch[1] : patch[3], patch[0] : patch[2]]

    def _ways(self, parts: Sequence[_Part]) -> Iterator[list[tuple[str, bytes]]]:
        """All parts coded in one way, then in coarser ones: without the ways after which they would be too large, never none."""
        ways: list[Callable[[_Part], tuple[str, bytes]]] = [self._quickly]
        ways += [partial(self._coarser, side, quality) for side, quality in _LEVELS]
        few = range(0, len(parts), max(1, len(parts) // _SAMPLED))
        for number, way in enumerate(ways, start=1):
            tried = {place: way(parts[place]) for place in few}
            reckoned = sum(len(code) for _, code in tried.values()) * len(parts) / max(1, len(few))
            if reckoned <= MOST_BYTES or number == len(ways):
                yield [tried.get(place) or way(part) for place, part in enumerate(parts)]

    def _quickly(self, part: _Part) -> tuple[str, bytes]:
        """Small pictures and JPEG files as they are, others as JPEG: a fifth of the time of WebP, and twice its size."""
        shown, patch = part
        path = self._folder / shown.file
        kind = "jpeg" if shown.file.endswith(".jpg") else "png"
        if patch is None and (kind == "jpeg" or path.stat().st_size <= AS_IT_IS_BYTES):
            return kind, path.read_bytes()
        if patch is None and shown.file in self._at_hand.coded:
            return "jpeg", self._at_hand.coded[shown.file]
        return "jpeg", to_jpeg(self._pixels(shown, patch), PAGE_QUALITY)

    def _coarser(self, most_px: int, quality: int, part: _Part) -> tuple[str, bytes]:
        shown, patch = part
        rgb = self._pixels(shown, patch)
        lossless = shown.size_px[0] * shown.size_px[1] < _LOSSLESS_BELOW_PX and quality > 70
        # A changed place as coarse as the picture that it belongs to.
        scale = min(1.0, most_px / max(shown.size_px))
        if scale < 1:
            size = max(1, round(scale * rgb.shape[1])), max(1, round(scale * rgb.shape[0]))
            rgb = np.asarray(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA))
        buffer = io.BytesIO()
        Image.fromarray(np.ascontiguousarray(rgb)).save(
            buffer, format="WEBP", quality=quality, lossless=lossless, method=0
        )
        return "webp", buffer.getvalue()


def _held(shown: Shown, patch: Patch | None, kind: str, code: bytes) -> Markup:
    """A picture of the page, or a changed place of one."""
    text = Markup(base64.b64encode(code).decode("ascii"))  # noqa: S704  its letters need no escape
    if patch is None:
        return Markup(
            '<image id="p{}" width="{}" height="{}" preserveAspectRatio="none" href="data:image/{};base64,{}"/>'
        ).format(shown.number, *shown.size_px, kind, text)
    x0, y0, x1, y1 = patch
    return Markup(
        '<image x="{}" y="{}" width="{}" height="{}" preserveAspectRatio="none" href="data:image/{};base64,{}"/>'
    ).format(x0, y0, x1 - x0, y1 - y0, kind, text)


def text_in_svg(x: float, y: float, text: str, css: str, size: float) -> Markup:
    """A line of text in a drawing, escaped."""
    return Markup('<text x="{}" y="{}" class="{}" font-size="{}">{}</text>').format(
        f"{x:.2f}", f"{y:.2f}", css, f"{size:.2f}", escape(text)
    )


def pictured(
    text: str | Markup, record: dict[str, Any], album: Album, show: Callable[[str, str], Markup] | None = None
) -> Markup:
    """A text with the instruction's pictures in the place of their names, small enough for a line.

    `show` draws one in another way, from its hash and what people call it.
    """
    said = record["planner"]["instruction"]
    slots, names = said["slots"] if said is not None else {}, recorded_names(said)

    def shown(name: str) -> str | None:
        slot = slots.get(name)
        if slot is None:
            return None
        key = next(iter(slot["views"].values()))
        return album.image(key, names[name], "inline") if show is None else show(key, names[name])

    return Markup(PLACEHOLDER.sub(lambda found: shown(found[1]) or found[0], str(escape(text))))  # noqa: S704  escaped
