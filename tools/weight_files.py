"""Files of weights as others read them: safetensors, and GGUF."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Numbers: TypeAlias = npt.NDArray[np.float32]
Tensors: TypeAlias = dict[str, Numbers]


def write_safetensors(path: Path, tensors: Tensors) -> None:
    """https://huggingface.co/docs/safetensors: length and JSON of the head, then the numbers."""
    head: dict[str, Any] = {"__metadata__": {"format": "pt"}}
    at = 0
    for name, tensor in tensors.items():
        head[name] = {"dtype": "F32", "shape": tensor.shape, "data_offsets": [at, at + tensor.nbytes]}
        at += tensor.nbytes
    words = json.dumps(head).encode()
    words += b" " * (-len(words) % 8)
    path.write_bytes(struct.pack("<Q", len(words)) + words + b"".join(tensor.tobytes() for tensor in tensors.values()))


def write_gguf(path: Path, said: Mapping[str, Any], tensors: Tensors) -> None:
    """https://github.com/ggml-org/ggml/blob/master/docs/gguf.md, version 3: what is said of the model, where its numbers are, the numbers."""
    parts = [b"GGUF", struct.pack("<IQQ", 3, len(tensors), len(said))]
    for name, value in said.items():
        kind, raw = packed(value)
        parts += [text(name), struct.pack("<I", kind), raw]
    numbers, at = [], 0
    for name, tensor in tensors.items():
        raw = np.ascontiguousarray(tensor, np.float32).tobytes()
        raw += bytes(-len(raw) % 32)
        parts += [
            text(name),
            struct.pack(f"<I{tensor.ndim}Q", tensor.ndim, *reversed(tensor.shape)),
            struct.pack("<IQ", 0, at),
        ]
        numbers.append(raw)
        at += len(raw)
    head = b"".join(parts)
    path.write_bytes(head + bytes(-len(head) % 32) + b"".join(numbers))


def packed(value: Any) -> tuple[int, bytes]:
    """A value's kind and bytes: unsigned, integer in a list, number, truth, text, list."""
    match value:
        case bool():
            return 7, struct.pack("<?", value)
        case int():
            return 4, struct.pack("<I", value)
        case float():
            return 6, struct.pack("<f", value)
        case str():
            return 8, text(value)
    if isinstance(value[0], int):
        return 9, struct.pack(f"<IQ{len(value)}i", 5, len(value), *value)
    kind = packed(value[0])[0]
    return 9, struct.pack("<IQ", kind, len(value)) + b"".join(packed(item)[1] for item in value)


def text(words: str) -> bytes:
    raw = words.encode()
    return struct.pack("<Q", len(raw)) + raw
