"""Messages over a pipe: a short head, JSON, then raw array bytes. Nothing in a message is ever executed."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np

MAGIC = b"WTVB"
HEAD = struct.Struct(">4sII")
"""Magic, bytes of JSON, bytes of arrays."""
LARGEST_JSON = 16_000_000
LARGEST_ARRAYS = 256_000_000
DTYPES = ("uint8", "int32", "float32", "float64")

Message = tuple[dict[str, Any], dict[str, Any]]
"""What is said, and arrays by name."""


class BrokenPipeProtocol(Exception):  # noqa: N818  says what broke
    """What came is not a message."""


def write_message(stream: BinaryIO, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> None:
    """Send one message.

    Args:
        stream: Where to, opened for bytes.
        said: Plain JSON values; the key "arrays" is taken.
        arrays: Arrays by name, each of one of DTYPES.

    Raises:
        ValueError: An array of another type, or a message past the limits.
    """
    listed: list[Any] = []
    parts: list[bytes] = []
    for name, value in arrays.items():
        array = np.ascontiguousarray(value)
        if array.dtype.name not in DTYPES:
            raise ValueError(f"array {name!r} is {array.dtype.name}; sent are {DTYPES}")
        listed.append([name, array.dtype.name, list(array.shape)])
        parts.append(array.tobytes())
    head = json.dumps(dict(said, arrays=listed), allow_nan=False).encode("utf-8")
    body = b"".join(parts)
    if len(head) > LARGEST_JSON or len(body) > LARGEST_ARRAYS:
        raise ValueError(f"a message of {len(head)} + {len(body)} bytes is too large to send")
    stream.write(HEAD.pack(MAGIC, len(head), len(body)) + head + body)
    stream.flush()


def read_message(stream: BinaryIO) -> Message:
    """Receive one message.

    Raises:
        EOFError: The other side closed the pipe between two messages.
        BrokenPipeProtocol: What came is not a message, or it ended in the middle.
    """
    head = stream.read(HEAD.size)
    if not head:
        raise EOFError("the pipe was closed")
    if len(head) < HEAD.size:
        raise BrokenPipeProtocol("the pipe was closed in the middle of a message")
    magic, size, body_size = HEAD.unpack(head)
    if magic != MAGIC:
        raise BrokenPipeProtocol(f"something else was written into the pipe: {head!r}")
    if size > LARGEST_JSON or body_size > LARGEST_ARRAYS:
        raise BrokenPipeProtocol(f"a message of {size} + {body_size} bytes is larger than any that is sent")
    try:
        said = json.loads(_exactly(stream, size))
        listed = [
            (str(name), np.dtype(str(kind)), tuple(int(n) for n in shape)) for name, kind, shape in said["arrays"]
        ]
    except (ValueError, KeyError, TypeError) as error:
        raise BrokenPipeProtocol(f"a message that cannot be read: {error}") from error
    return said, _arrays(_exactly(stream, body_size), listed)


def _arrays(body: bytes, listed: list[tuple[str, Any, tuple[int, ...]]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    at = 0
    for name, kind, shape in listed:
        count = int(np.prod(shape, dtype=np.int64))
        size = count * kind.itemsize
        if kind.name not in DTYPES or min(shape, default=0) < 0 or at + size > len(body):
            raise BrokenPipeProtocol(f"array {name!r} of {kind.name} {shape} does not fit its message")
        found[name] = np.frombuffer(body, kind, count, at).reshape(shape)
        at += size
    return found


def _exactly(stream: BinaryIO, size: int) -> bytes:
    content = stream.read(size)
    if len(content) < size:
        raise BrokenPipeProtocol("the pipe was closed in the middle of a message")
    return content
