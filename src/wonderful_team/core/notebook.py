"""How photos, plans and trials show themselves in a notebook: escaped words, the picture inside, no script."""

from __future__ import annotations

import base64
import html
import struct
import zlib
from collections.abc import Iterable, Sequence

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.text import visible
from wonderful_team.redaction import redact

WIDTH_PX = 720
"""Pictures are made no wider than this: a notebook keeps every one."""
_CARD = (
    "display:inline-block;max-width:760px;border:1px solid rgba(128,128,128,.4);border-radius:8px;"
    "padding:10px 14px;line-height:1.45"
)
_LINE = "margin:3px 0;font-family:ui-monospace,monospace;font-size:.85em;white-space:pre-wrap"


def card(title: str, lines: Iterable[str] = (), pictures: Sequence[tuple[Array, str]] = ()) -> str:
    """One result as HTML: a title, pictures with their captions, lines of text; every word escaped."""
    parts = [f"<b>{_safe(title)}</b>"]
    if pictures:
        shown = "".join(_figure(rgb, caption) for rgb, caption in pictures)
        parts.append(f'<div style="display:flex;flex-wrap:wrap;gap:10px;margin:8px 0">{shown}</div>')
    parts += [f'<div style="{_LINE}">{_safe(line)}</div>' for line in lines]
    return f'<div style="{_CARD}">{"".join(parts)}</div>'


def png_bytes(rgb: Array) -> bytes:
    """An image, shape (H, W, 3), uint8, as PNG, with the standard library alone."""
    height, width = rgb.shape[:2]
    rows = np.concatenate([np.zeros((height, 1), np.uint8), rgb.reshape(height, width * 3)], axis=1)
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(rows.tobytes(), 6)), (b"IEND", b""))
    coded = (
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(coded)


def _figure(rgb: Array, caption: str) -> str:
    small = _smaller(rgb)
    coded = base64.b64encode(png_bytes(small)).decode("ascii")
    image = (
        f'<img src="data:image/png;base64,{coded}" width="{small.shape[1]}" alt="{_safe(caption)}" '
        'style="max-width:100%;height:auto;border-radius:6px">'
    )
    return f'<figure style="margin:0">{image}<figcaption style="opacity:.7">{_safe(caption)}</figcaption></figure>'


def _smaller(rgb: Array) -> Array:
    """At most WIDTH_PX wide: blocks of whole pixels are averaged."""
    step = -(-rgb.shape[1] // WIDTH_PX)
    if step == 1:
        return np.ascontiguousarray(rgb)
    height, width = rgb.shape[0] // step * step, rgb.shape[1] // step * step
    blocks = rgb[:height, :width].reshape(height // step, step, width // step, step, 3)
    return np.ascontiguousarray(blocks.mean(axis=(1, 3)).round().astype(np.uint8))


def _safe(text: str) -> str:
    return html.escape(visible(redact(text)), quote=True)
