"""What a server understood of a request, in no vendor's words, and what it says back."""

from __future__ import annotations

import base64
import binascii
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import cv2
import numpy as np

Piece: TypeAlias = "str | np.ndarray"
"""Words, or a picture: RGB, shape (H, W, 3), uint8."""


class Rejected(Exception):  # noqa: N818  a request that the vendor would refuse
    """The vendor would refuse this request: status, and a message for the vendor's own error body."""

    def __init__(self, status: int, message: str, *, code: str = "", headers: Mapping[str, str] | None = None) -> None:
        super().__init__(message)
        self.status = status
        self.message = message
        self.code = code
        self.headers = dict(headers or {})


@dataclass(frozen=True, eq=False)
class Turn:
    """One message of the conversation."""

    role: Literal["user", "assistant"]
    pieces: tuple[Piece, ...]


@dataclass(frozen=True, eq=False)
class Heard:
    """A request as a server understood it.

    Attributes:
        dialect: openai | responses | anthropic | google.
        schema: JSON schema of the answer wherever it stood: response format, tool, or the words themselves.
        schema_native: The schema stood in a field that the server can enforce.
        tool: Name of the tool that the answer must call; "" when text is wanted.
        stream: Server-sent events are wanted.
        bytes_in: Length of the body as it came.
        secret: The key that came with it.
    """

    dialect: str
    model: str
    system: str
    turns: tuple[Turn, ...]
    schema: Mapping[str, Any] | None = None
    schema_native: bool = False
    tool: str = ""
    stream: bool = False
    bytes_in: int = 0
    secret: str = ""
    body: Mapping[str, Any] = field(default_factory=dict)

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Words and pictures of all user turns, in order."""
        return tuple(piece for turn in self.turns if turn.role == "user" for piece in turn.pieces)

    @property
    def words(self) -> str:
        return "\n".join(piece for piece in self.pieces if isinstance(piece, str))

    @property
    def pictures(self) -> tuple[np.ndarray, ...]:
        return tuple(piece for piece in self.pieces if not isinstance(piece, str))


@dataclass(frozen=True)
class Reply:
    """What a model says, and how the server dresses it.

    Attributes:
        text: The answer's text; None for no answer at all (empty choices, a refusal).
        thinking: Reasoning in a field of its own, where the format has one.
        finish: stop | length | filter | refusal.
        usage: Tokens in, cached, thinking, out; None leaves the usage out of the reply.
    """

    text: str | None
    thinking: str = ""
    finish: Literal["stop", "length", "filter", "refusal"] = "stop"
    usage: tuple[int, int, int, int] | None = (1000, 0, 0, 100)


def decode_png(data: str, what: str) -> np.ndarray:
    """Base64 of a PNG or JPEG as RGB.

    Raises:
        Rejected: Not base64, or no picture.
    """
    try:
        raw = base64.b64decode(data, validate=True)
    except (binascii.Error, ValueError) as error:
        raise Rejected(400, f"{what}: not valid base64 ({error})", code="invalid_base64") from error
    if not raw:
        raise Rejected(400, f"{what}: the picture is empty", code="invalid_image")
    picture = cv2.imdecode(np.frombuffer(raw, dtype=np.uint8), cv2.IMREAD_COLOR)
    if picture is None:
        raise Rejected(400, f"{what}: could not be decoded as a picture", code="invalid_image")
    return np.ascontiguousarray(picture[:, :, ::-1])


def picture_of_data_url(url: str, what: str) -> np.ndarray:
    """The picture in a data: URL."""
    found = re.fullmatch(r"data:(image/(?:png|jpeg|gif|webp));base64,(.*)", url, re.DOTALL)
    if found is None:
        raise Rejected(
            400, f"{what}: expected a base64 data URL of a picture, got {url[:40]!r}", code="invalid_image_url"
        )
    return decode_png(found.group(2), what)


def schema_in_words(words: str) -> Mapping[str, Any] | None:
    """The JSON schema that stands in a text, if one does: the first JSON object that has properties."""
    decoder = json.JSONDecoder()
    for start in re.finditer(r"\{", words):
        try:
            value, _ = decoder.raw_decode(words, start.start())
        except ValueError:
            continue
        if isinstance(value, dict):
            inner = value.get("schema", value)
            if isinstance(inner, dict) and "properties" in inner:
                return inner
    return None
