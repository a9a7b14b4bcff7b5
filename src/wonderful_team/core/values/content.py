"""One hash over everything that a value holds: the same content gives the same hash, on every machine."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from wonderful_team.core.later import is_later
from wonderful_team.core.pictures import pixels_hash
from wonderful_team.core.values.observation import View

_EXACT = 2**53
"""Whole numbers below it are the same as floating-point numbers, so 1 and 1.0 hash alike."""


def content_hash(value: Any, without: Sequence[str] = ()) -> str:
    """SHA-256 of a value in canonical form: 64 hex digits.

    Dataclasses count with their class and every field, views with their pixels (not with their time, depth and camera,
    which a plan file does not hold), numbers with every digit.

    Args:
        value: Frozen values, arrays, plain JSON values.
        without: Names of fields that are left out, at any depth.

    Raises:
        TypeError: A type that has no canonical form.
    """
    text = json.dumps(_canonical(value, frozenset(without)), sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def file_hash(path: Path | None) -> str:
    """SHA-256 of a file; "" when there is none."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path is not None and path.is_file() else ""


def _canonical(value: Any, without: frozenset[str]) -> Any:
    match value:
        case None | bool() | str():
            return value
        case int():
            return float(value) if abs(value) < _EXACT else value
        case float():
            return value
        case np.generic():
            return _canonical(value.item(), without)
        case np.ndarray():
            return _canonical(value.tolist(), without)
        case View():
            return {"type": "View", "id": value.id, "camera": value.camera_name, "pixels": pixels_hash(value.rgb)}
        case Mapping():
            return {str(key): _canonical(item, without) for key, item in value.items()}
        case tuple() | list():
            return [_canonical(item, without) for item in value]
    if is_dataclass(value) and not isinstance(value, type):
        named = {
            item.name: getattr(value, item.name)
            for item in fields(value)
            if item.name not in without and not (is_later(item) and getattr(value, item.name) == item.default)
        }
        return {"type": type(value).__name__, **{key: _canonical(item, without) for key, item in named.items()}}
    raise TypeError(f"no canonical form for {type(value).__name__}")
