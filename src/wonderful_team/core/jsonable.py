"""Turn our frozen values into plain JSON values. Images become their hash and size: pixels live in files of their own."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from wonderful_team.core.later import is_later
from wonderful_team.errors import ConfigError, reading

JSON_LIMIT_BYTES = 1_000_000_000
"""Largest JSON file that is read."""


def read_json(path: Path, what: str, valid: str = "") -> Any:
    """What a JSON file holds.

    Args:
        path: The file.
        what: What it is, for messages, such as "camera file".
        valid: What would be valid, for messages.

    Raises:
        ConfigError: Missing, unreadable, too large, nested too deeply, or not JSON in UTF-8.
    """
    name = f"{what} {str(path)!r}"
    with reading(name, valid):
        size = path.stat().st_size
        if size > JSON_LIMIT_BYTES:
            raise ConfigError(f"{name} has {size} bytes; at most {JSON_LIMIT_BYTES} are read")
        text = path.read_text(encoding="utf-8")
        try:
            return json.loads(text)
        except ValueError as error:
            raise ConfigError(f"{name} is not JSON: {error}{'; valid: ' + valid if valid else ''}") from error


def to_jsonable(value: Any, *, later: bool = True) -> Any:
    """A JSON-ready copy of a value.

    With `later` False, fields that earlier releases did not have are left out.

    Dataclasses become objects; those with a `kind` class attribute (steps, actions) carry it. Marks and places carry
    their class name as `type`. Arrays become lists, uint8 images their shape alone.

    Raises:
        TypeError: A type that has no JSON form.
    """
    match value:
        case None | bool() | int() | str():
            return value
        case float():
            return round(value, 9)
        case np.generic():
            return to_jsonable(value.item(), later=later)
        case np.ndarray():
            return (
                {"image": list(value.shape)}
                if value.ndim >= 2 and value.dtype == np.uint8
                else to_jsonable(value.tolist(), later=later)
            )
        case Mapping():
            return {str(key): to_jsonable(item, later=later) for key, item in value.items()}
        case tuple() | list():
            return [to_jsonable(item, later=later) for item in value]
        case type():
            return value.__name__
    if hasattr(value, "model_dump"):
        return value.model_dump(mode="json")
    if is_dataclass(value):
        return _dataclass_to_json(value, later)
    raise TypeError(f"no JSON form for {type(value).__name__}")


def _dataclass_to_json(value: Any, later: bool) -> dict[str, Any]:
    shown: dict[str, Any] = {"type": type(value).__name__}
    kind = getattr(type(value), "kind", None)
    if isinstance(kind, str):
        shown["kind"] = kind
    for item in fields(value):
        content = getattr(value, item.name)
        if not later and is_later(item):
            continue
        if item.name in ("rgb", "depth_m") and isinstance(content, np.ndarray):
            shown[item.name] = {"image": list(content.shape)}
        else:
            shown[item.name] = to_jsonable(content, later=later)
    if hasattr(value, "hash") and isinstance(value.hash, str):
        shown["hash"] = value.hash
    return shown
