"""How heavy pictures may be for a service, and how those that are too heavy get lighter: the same size, as JPEG.

Bytes are those that are sent: base64, four characters for three bytes of a file. A picture keeps its size in pixels, so that
positions stay what they are; colours are not thinned out (4:4:4), so that thin lines and tick labels stay sharp.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import TypeVar

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.text import counted
from wonderful_team.images import to_jpeg

K = TypeVar("K", bound=Hashable)

QUALITIES = (95, 90, 80, 70, 60, 50)
"""JPEG qualities, tried from the best on; below the last one small letters blur."""
_JPEG = b"\xff\xd8"


@dataclass(frozen=True)
class Weight:
    """Most bytes that a service takes, in base64.

    Attributes:
        picture: Of one picture; None where no limit is known.
        request: Of all pictures of a request; None where no limit is known.
    """

    picture: int | None = None
    request: int | None = None


UNLIMITED = Weight()


def media_type(file: bytes) -> str:
    """What a picture's bytes are."""
    return "image/jpeg" if file.startswith(_JPEG) else "image/png"


def sent_bytes(file: bytes) -> int:
    """How many bytes a picture has in base64."""
    return 4 * ((len(file) + 2) // 3)


def lightened(
    files: Mapping[K, bytes], pixels: Mapping[K, Array], times: Mapping[K, int], limits: Weight
) -> tuple[dict[K, bytes], str]:
    """The pictures of a request, within the limits where JPEG makes them so light; those within them stay as they are.

    Args:
        files: As they would be sent.
        pixels: What they show.
        times: How often each is sent.
        limits: Of the service.

    Returns:
        The files, and what was done in words; "" for nothing.
    """
    light, quality = dict(files), 0
    for key, file in files.items():
        if limits.picture is not None and sent_bytes(file) > limits.picture:
            light[key], used = _within(file, pixels[key], limits.picture)
            quality = min(quality or used, used)
    for step in QUALITIES:
        if limits.request is None or _total(light, times) <= limits.request:
            break
        for key, file in light.items():
            light[key] = min(file, to_jpeg(pixels[key], step), key=len)
        quality = step
    changed = sum(light[key] is not files[key] for key in files)
    if not changed:
        return light, ""
    return light, (
        f"{changed} of {counted(len(files), 'picture')} sent as JPEG (quality {quality}), the same size: "
        f"{_total(files, times)} bytes are more than the service takes ({_limit_words(limits)})"
    )


def _within(file: bytes, rgb: Array, most: int) -> tuple[bytes, int]:
    """The picture at the best quality that is light enough, or at the lowest; and the quality."""
    for quality in QUALITIES:
        made = to_jpeg(rgb, quality)
        if sent_bytes(made) <= most:
            return made, quality
    return min(file, made, key=len), QUALITIES[-1]


def _total(files: Mapping[K, bytes], times: Mapping[K, int]) -> int:
    return sum(sent_bytes(file) * times[key] for key, file in files.items())


def _limit_words(limits: Weight) -> str:
    parts = [] if limits.picture is None else [f"{limits.picture} bytes a picture"]
    parts += [] if limits.request is None else [f"{limits.request} bytes a request"]
    return ", ".join(parts)
