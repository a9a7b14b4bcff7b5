"""Turn our frozen values into plain JSON values. Images become their hash and size: pixels live in files of their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np


def to_jsonable(value: Any) -> Any:
    """A JSON-ready copy of a value.

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
            return to_jsonable(value.item())
        case np.ndarray():
            return (
                {"image": list(value.shape)}
                if value.ndim >= 2 and value.dtype == np.uint8
                else to_jsonable(value.tolist())
            )
        case Mapping():
            return {str(key): to_jsonable(item) for key, item in value.items()}
        case tuple() | list():
            return [to_jsonable(item) for item in value]
        case type():
            return value.__name__
    if hasattr(value, "model_dump"):
        return value.model_dump(mode="json")
    if is_dataclass(value):
        return _dataclass_to_json(value)
    raise TypeError(f"no JSON form for {type(value).__name__}")


def _dataclass_to_json(value: Any) -> dict[str, Any]:
    shown: dict[str, Any] = {"type": type(value).__name__}
    kind = getattr(type(value), "kind", None)
    if isinstance(kind, str):
        shown["kind"] = kind
    for item in fields(value):
        content = getattr(value, item.name)
        if item.name in ("rgb", "depth_m") and isinstance(content, np.ndarray):
            shown[item.name] = {"image": list(content.shape)}
        else:
            shown[item.name] = to_jsonable(content)
    if hasattr(value, "hash") and isinstance(value.hash, str):
        shown["hash"] = value.hash
    return shown
