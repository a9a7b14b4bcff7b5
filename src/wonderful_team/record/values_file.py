"""Frozen values to JSON and back without loss: dataclasses carry their class name, floats keep every digit."""

from __future__ import annotations

import base64
import io
import math
import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
from PIL import Image

from wonderful_team.core.later import is_later
from wonderful_team.core.values import View
from wonderful_team.images import OWN_FORMATS, open_picture
from wonderful_team.images.png import fast_png

WRITTEN = {"Critique": "Doubt"}
"""Classes that files call by the name of an earlier release."""


def encode(value: Any) -> Any:
    """A JSON-ready copy. A View keeps its pixels as PNG text; its depth and camera are left out.

    Raises:
        TypeError: A type that has no JSON form.
    """
    match value:
        case None | bool() | int() | str() | float():
            return value
        case np.generic():
            return value.item()
        case np.ndarray():
            return value.tolist()
        case Mapping():
            return {str(key): encode(item) for key, item in value.items()}
        case tuple() | list():
            return [encode(item) for item in value]
        case View():
            return {
                "type": "View",
                "id": value.id,
                "camera_name": value.camera_name,
                "time_s": value.time_s,
                "png": _png_text(value.rgb),
            }
    if is_dataclass(value):
        return {
            "type": written_name(type(value)),
            **{item.name: encode(getattr(value, item.name)) for item in fields(value)},
        }
    raise TypeError(f"no JSON form for {type(value).__name__}")


def written_name(kind: Any) -> str:
    """What files call a class."""
    name = str(getattr(kind, "__name__", ""))
    return WRITTEN.get(name, name)


def decode(value: Any, hint: Any, where: str = "") -> Any:
    """The value of type `hint` that `encode` wrote.

    Raises:
        ValueError: The JSON does not fit the type; names the place.
    """
    place = where or "top"
    origin, arguments = get_origin(hint), get_args(hint)
    if hint is Any:
        return value
    if hasattr(origin, "__value__"):
        # From numpy 2.5 on, which needs Python 3.12, NDArray is an alias by the `type` statement: what it stands for counts.
        origin = get_origin(origin.__value__)
    if origin is Literal:
        return _require(value in arguments, value, place, f"one of {', '.join(map(repr, arguments))}")
    if origin in (Union, types.UnionType):
        return _decode_union(value, arguments, place)
    if origin is tuple:
        return _decode_tuple(value, arguments, place)
    if origin is not None and isinstance(origin, type) and issubclass(origin, Mapping):
        _require(isinstance(value, Mapping), value, place, "an object")
        return {key: decode(item, arguments[1], f"{place}.{key}") for key, item in value.items()}
    if origin is np.ndarray:
        return _decode_array(value, place)
    if hint is View:
        return _decode_view(value, place)
    if is_dataclass(hint):
        return _decode_dataclass(value, hint, place)
    return _decode_plain(value, hint, place)


def _decode_array(value: Any, place: str) -> Any:
    _require(isinstance(value, list), value, place, "a list of numbers")
    array = np.asarray(value)
    _require(array.dtype.kind in "if" or array.size == 0, value, place, "a list of numbers")
    _require(bool(np.isfinite(array).all()), value, place, "finite numbers")
    return array.astype(np.float64)


def _decode_plain(value: Any, hint: Any, place: str) -> Any:
    if hint is float:
        number = isinstance(value, int | float) and not isinstance(value, bool)
        _require(number and math.isfinite(value), value, place, "a finite number")
        return value  # a whole number stays one, so that hashes over the text stay the same
    if hint is type(None):
        return _require(value is None, value, place, "null")
    names = {bool: "true or false", int: "a whole number", str: "text"}
    fits = isinstance(value, hint) and not (hint is int and isinstance(value, bool))
    return _require(fits, value, place, names.get(hint, str(hint)))


def _decode_union(value: Any, arguments: tuple[Any, ...], place: str) -> Any:
    if value is None and type(None) in arguments:
        return None
    named = value.get("type") if isinstance(value, Mapping) else None
    for option in arguments:
        if is_dataclass(option) and written_name(option) == named:
            return decode(value, option, place)
    errors = []
    for option in arguments:
        if option is not type(None) and not is_dataclass(option):
            try:
                return decode(value, option, place)
            except ValueError as error:
                errors.append(str(error))
    known = ", ".join(option.__name__ for option in arguments if is_dataclass(option) and isinstance(option, type))
    raise ValueError(errors[0] if errors else f"{place}: unknown type {named!r}; valid: {known}")


def _decode_tuple(value: Any, arguments: tuple[Any, ...], place: str) -> tuple[Any, ...]:
    _require(isinstance(value, list), value, place, "a list")
    if len(arguments) == 2 and arguments[1] is Ellipsis:
        return tuple(decode(item, arguments[0], f"{place}[{index}]") for index, item in enumerate(value))
    _require(len(value) == len(arguments), value, place, f"a list of {len(arguments)}")
    pairs = zip(value, arguments, strict=True)
    return tuple(decode(item, argument, f"{place}[{index}]") for index, (item, argument) in enumerate(pairs))


def _decode_dataclass(value: Any, kind: Any, place: str) -> Any:
    name = written_name(kind)
    _require(isinstance(value, Mapping) and value.get("type") == name, value, place, f"an object of type {name!r}")
    hints = _hints(kind)
    names = [item.name for item in fields(kind)]
    missing = [item.name for item in fields(kind) if item.name not in value and not is_later(item)]
    foreign = [key for key in value if key not in (*names, "type")]
    if missing or foreign:
        raise ValueError(f"{place}: {name} lacks {missing or 'nothing'} and has unknown {foreign or 'nothing'}")
    return kind(**{key: decode(value[key], hints[key], f"{place}.{key}") for key in names if key in value})


def _decode_view(value: Any, place: str) -> View:
    _require(isinstance(value, Mapping) and value.get("type") == "View", value, place, "an object of type 'View'")
    try:
        with open_picture(io.BytesIO(base64.b64decode(value["png"])), OWN_FORMATS) as image:
            rgb = np.asarray(image.convert("RGB"), dtype=np.uint8)
        return View(value["id"], value["camera_name"], float(value["time_s"]), rgb)
    except (KeyError, OSError, TypeError, Image.DecompressionBombError) as error:
        raise ValueError(f"{place}: picture cannot be read: {error}") from error


@cache
def _hints(kind: Any) -> dict[str, Any]:
    return get_type_hints(kind)


def _png_text(rgb: Any) -> str:
    return base64.b64encode(fast_png(rgb)).decode("ascii")


def _require(fits: bool, value: Any, place: str, wanted: str) -> Any:
    if not fits:
        shown = repr(value)
        raise ValueError(f"{place}: expected {wanted}, got {shown[:80]}{'…' if len(shown) > 80 else ''}")
    return value
