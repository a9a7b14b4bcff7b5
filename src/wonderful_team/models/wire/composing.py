"""A request as a model is sent it: its words in the model's own unit, its pictures drawn, its schema, and the way back."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeAlias, cast

import numpy as np
from pydantic import BaseModel

from wonderful_team.contracts import Question, Tolerance
from wonderful_team.core.geometry import Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Axes, Picture
from wonderful_team.core.values import Request, SentPicture, Words
from wonderful_team.images import line_width_px
from wonderful_team.images.captions import axes_words, size_words
from wonderful_team.models.conventions import PIXELS, Convention, Size
from wonderful_team.models.wire.coding import Encoding, encoded
from wonderful_team.models.wire.form import Form, box_keys, point_keys
from wonderful_team.models.wire.reading import Reading, read_json, read_point_tags
from wonderful_team.models.wire.showing import Shown, paste, scaled_frame, sent_size, show_encoded, ticks_of
from wonderful_team.models.wire.weight import UNLIMITED, Weight, lightened, sent_bytes

Piece: TypeAlias = str | bytes


@dataclass(frozen=True, eq=False)
class Composed:
    """What goes out for one request.

    Attributes:
        system: Standing words.
        pieces: Words and the bytes of pictures (PNG or JPEG), in order.
        form: The answer's schema in the model's format.
        convention: The one in force: plain pixels where the answer holds no places.
        sizes_px: Width and height of every picture sent.
        picture_bytes: Of all pictures sent, in base64.
        notice: What was done to pictures that are too heavy, in words; "" for nothing.
        sent: The files of the request's pictures, in order; the one sheet where all stand on it.
    """

    system: str
    pieces: tuple[Piece, ...]
    form: Form
    convention: Convention
    sizes_px: tuple[tuple[int, int], ...]
    _where: Shown | None
    _canvas: tuple[int, int]
    picture_bytes: int = 0
    notice: str = ""
    sent: tuple[SentPicture, ...] = ()

    def read(self, text: str) -> Reading:
        """What a model said, as a value with our names and places in pixels of our picture.

        Raises:
            ValueError: It is no such answer; the text is for the model.
        """
        properties = frozenset(self.form.schema.get("properties", {}))
        if self.form.has_places and "{" not in text and "points" in properties:
            pairs = read_point_tags(text)
            if pairs:
                value = {"reasoning": "", "found": True, "points": pairs}
                return Reading(self.form.read(value, self.to_px), ("points read from tags",))
        reading = read_json(text, properties)
        return Reading(self.form.read(reading.value, self.to_px), reading.repairs)

    def to_px(self, values: Any) -> Array:
        """The model's numbers to pixels of the picture that the answer is about, shape (N, 2)."""
        assert self._where is not None
        return self._where.to_ours(self.convention.to_px(values, self._canvas))


def compose(
    request: Request,
    convention: Convention,
    *,
    one_picture: bool = False,
    schema_in_words: bool = False,
    limits: Weight = UNLIMITED,
    encoding: Encoding = "auto",
    tile_px: int | None = None,
) -> Composed:
    """Words, pictures and schema of a request in the terms of a model.

    Args:
        request: What is asked.
        convention: Of the model. Where the answer holds no points or boxes, plain pixels are drawn and said.
        one_picture: Paste all pictures on one sheet.
        schema_in_words: Tell the schema in words as well, for servers that do not show it to the model.
        limits: How heavy pictures may be.
        encoding: Of pictures' files (see `coding.encoded`).
        tile_px: Side of the tiles that the service counts pictures in; enlarged ones are fitted to them where nothing said or
            answered counts their pixels.
    """
    form = _form(cast(Hashable, request.output), convention)
    if not form.has_places:
        convention, form = PIXELS, _form(cast(Hashable, request.output), PIXELS)
    pictures = list(dict.fromkeys(request.pictures))
    pasted = one_picture and len(request.pictures) > 1
    files: dict[Picture, bytes] = {}
    notice = ""
    if pasted:
        sheet, shown = paste(pictures, convention)
        canvas = (sheet.shape[1], sheet.shape[0])
        one, notice = lightened({"sheet": encoded(sheet, pictures, encoding)}, {"sheet": sheet}, {"sheet": 1}, limits)
    else:
        any_size = isinstance(request.question, Question) and request.question.any_size
        fitted = tile_px if form.has_places or any_size else None
        resized = {picture: sent_size(picture, convention, fitted) for picture in pictures}
        both = [
            show_encoded(picture, convention, encoding, resized[picture], _reference(picture, resized))
            for picture in pictures
        ]
        shown, files = (
            [item for item, _ in both],
            {picture: file for picture, (_, file) in zip(pictures, both, strict=True)},
        )
        times = Counter(request.pictures)
        files, notice = lightened(files, dict(zip(pictures, (item.rgb for item in shown), strict=True)), times, limits)
    held = dict(zip(pictures, shown, strict=True))
    target = answer_picture(request) if form.has_places else None
    where = held.get(target) if target is not None else None
    if where is None and form.has_places and shown:
        where = shown[0]
    if not pasted:
        canvas = where.picture.size_px if where is not None else (1, 1)
    pieces: list[Piece] = [one["sheet"], _layout(shown)] if pasted else []
    told = False
    for part in request.parts:
        if isinstance(part, Picture):
            if pasted:
                pieces.append(f"(picture {list(held).index(part) + 1} of the sheet)")
            else:
                pieces.append(files[part])
        elif part.says == "positions" and form.has_places and part.picture in held:
            pieces.append(_positions(part.picture, held[part.picture], form, canvas, pasted))
            told = True
        else:
            pieces.append(_said(part, held, convention, pasted))
    if form.has_places and not told and where is not None:
        pieces.append(_positions(where.picture, where, form, canvas, pasted))
    if schema_in_words:
        pieces.append(f"Answer with one JSON object and nothing else. Its JSON schema:\n{form.text}")
    sizes = (canvas,) if pasted else tuple(held[picture].picture.size_px for picture in request.pictures)
    weight = sum(sent_bytes(piece) for piece in pieces if isinstance(piece, bytes))
    out = [one["sheet"]] if pasted else [files[picture] for picture in request.pictures]
    seen = [sheet] if pasted else [held[picture].rgb for picture in request.pictures]
    sent = tuple(SentPicture(*one) for one in zip(out, sizes, seen, strict=False))
    return Composed(request.system, _joined(pieces), form, convention, sizes, where, canvas, weight, notice, sent)


def _reference(picture: Picture, sizes: Mapping[Picture, Size]) -> Frame | None:
    """The frame, as it is sent, of the picture whose pixels this one's axes name; None where they name its own."""
    named = next((mark.reference for mark in picture.marks if isinstance(mark, Axes)), None)
    whose = next((other for other in sizes if named is not None and other.frame is named), None)
    return None if whose is None else scaled_frame(whose.frame, sizes[whose])


def answer_picture(request: Request) -> Picture | None:
    """The picture whose pixels the answer is given in."""
    for part in request.parts:
        if isinstance(part, Words) and part.says == "positions":
            return part.picture
    for name in ("view", "crop", "picture"):
        held = getattr(request.question, name, None)
        if isinstance(held, Picture):
            return held
    return request.pictures[0] if request.pictures else None


@lru_cache(maxsize=256)
def _form(output: Hashable, convention: Convention) -> Form:
    return Form.of(cast(type[BaseModel], output), convention)


def _said(words: Words, held: dict[Picture, Shown], convention: Convention, pasted: bool) -> str:
    """The words, with a caption's size and tick labels as they are for this model."""
    if words.says not in ("caption", "tolerance") or words.picture not in held:
        return words.text
    sent = held[words.picture].picture
    if words.says == "tolerance":
        return Tolerance.on(sent).words(line_width_px(sent))
    text = words.text.replace(size_words(words.picture.size_px), size_words(sent.size_px), 1)
    for mark in words.picture.marks:
        if isinstance(mark, Axes):
            if pasted:
                text = text.replace(
                    axes_words(mark), axes_words(Axes(sent.frame), ticks_of(convention), "the sheet"), 1
                )
            else:
                text = text.replace(axes_words(mark), axes_words(mark, ticks_of(convention)), 1)
    return text


def _positions(picture: Picture, shown: Shown, form: Form, canvas: tuple[int, int], pasted: bool) -> str:
    """How positions are to be given, in the model's unit and order."""
    convention = form.convention
    across, down = convention.span(canvas)
    which = f'picture "{picture.name}"'
    if pasted:
        corners = np.array([(0.0, 0.0), shown.picture.size_px]) + shown.origin_px
        (x0, y0), (x1, y1) = corners * (np.array([across, down]) / canvas)
        place = f"that picture spans x {x0:.4g} to {x1:.4g} and y {y0:.4g} to {y1:.4g}"
        which = f"the sheet, for what {which} shows; {place}"
    kinds = {"Point": ("point", point_keys(convention)), "Box": ("box", box_keys(convention))}
    held = [kinds[name] for name in kinds if name in form.schema.get("$defs", {})]
    written = ", ".join(f"a {kind} is [{', '.join(keys)}]" for kind, keys in held)
    return (
        f"Answer with positions in {which}: x from 0 to {across:g}, y from 0 to {down:g}, {form.describe()}. "
        f"{written[:1].upper()}{written[1:]}."
    )


def _layout(shown: Sequence[Shown]) -> str:
    """Where each picture lies on the sheet."""
    lines = ["All pictures of this request stand on this one sheet, each under its number. In sheet pixels:"]
    for number, item in enumerate(shown, start=1):
        (x0, y0), (width, height) = item.origin_px, item.picture.size_px
        name = item.picture.name
        lines.append(f'- picture {number}, "{name}": x {x0:.0f} to {x0 + width:.0f}, y {y0:.0f} to {y0 + height:.0f}')
    return "\n".join(lines)


def _joined(pieces: Sequence[Piece]) -> tuple[Piece, ...]:
    """Words that follow each other become one piece."""
    joined: list[Piece] = []
    for piece in pieces:
        if isinstance(piece, str) and joined and isinstance(joined[-1], str):
            joined[-1] = f"{joined[-1]}\n{piece}"
        else:
            joined.append(piece)
    return tuple(joined)
