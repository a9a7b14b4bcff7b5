"""How a model behind a server speaks of places: its order, its unit, its own resize, its errors.

Written apart from the package's own conventions, so that one checks the other.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

Size = tuple[int, int]
BOX_KEYS = (
    ("x0", "y0", "x1", "y1"),
    ("x1", "y1", "x2", "y2"),
    ("x_min", "y_min", "x_max", "y_max"),
    ("xmin", "ymin", "xmax", "ymax"),
    ("left", "top", "right", "bottom"),
)


@dataclass(frozen=True)
class Speech:
    """A model's way with coordinates.

    Attributes:
        full: What a whole side counts: None for pixels, else 1000, 100 or 1.
        resize: Size of the picture as the model sees it; None for as sent.
        stretch, offset: Errors of the model, in its own unit: said = right * stretch + offset.
        clamp: Never says less than 0 or more than a whole side.
        digits: Decimals it writes.
    """

    order: Literal["xy", "yx"] = "xy"
    full: float | None = None
    resize: Callable[[Size], Size] | None = None
    stretch: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)
    clamp: bool = False
    digits: int = 1

    def place(self, x: float, y: float, size: Size) -> tuple[float, float]:
        """A pixel of the picture as it was received, as (x, y) in the model's unit."""
        seen = size if self.resize is None else self.resize(size)
        said = []
        for value, side, model_side, stretch, offset in zip((x, y), size, seen, self.stretch, self.offset, strict=True):
            whole = model_side if self.full is None else self.full
            number = value / side * whole * stretch + offset
            if self.clamp:
                number = min(max(number, 0.0), float(whole))
            said.append(round(number, self.digits))
        return said[0], said[1]

    def point(self, x: float, y: float, size: Size) -> list[float]:
        place = self.place(x, y, size)
        return list(place if self.order == "xy" else place[::-1])


def qwen25_resize(size: Size, factor: int = 28, low: int = 56 * 56, high: int = 1280 * 28 * 28) -> Size:
    """Qwen2.5-VL: both sides multiples of 28, area within a budget."""
    width, height = (max(factor, round(side / factor) * factor) for side in size)
    if width * height > high:
        shrink = math.sqrt(size[0] * size[1] / high)
        width, height = (max(factor, math.floor(side / shrink / factor) * factor) for side in size)
    elif width * height < low:
        enlarge = math.sqrt(low / (size[0] * size[1]))
        width, height = (math.ceil(side * enlarge / factor) * factor for side in size)
    return width, height


def longest_side(limit: int) -> Callable[[Size], Size]:
    """Shrunk until the longest side fits."""

    def resize(size: Size) -> Size:
        share = min(1.0, limit / max(size))
        return round(size[0] * share), round(size[1] * share)

    return resize


SPEECHES: dict[str, Speech] = {
    "pixels": Speech(),
    "gemini": Speech("yx", 1000.0, digits=0),
    "thousandths": Speech("xy", 1000.0, digits=0),
    "percent": Speech("xy", 100.0),
    "unit": Speech("xy", 1.0, digits=4),
    "qwen25": Speech("xy", None, qwen25_resize, digits=0),
    "claude": Speech("xy", None, longest_side(1568), digits=0),
}


@dataclass(frozen=True)
class Seat:
    """Where our picture lies in the picture that was received: the whole of it, or its place on a sheet.

    Attributes:
        ours: Width and height of our picture [px].
        received: Width and height of what was received [px].
        origin, size: Of our picture inside what was received [px].
    """

    ours: Size
    received: Size
    origin: tuple[float, float] = (0.0, 0.0)
    size: tuple[float, float] | None = None

    def at(self, x: float, y: float) -> tuple[float, float]:
        """A pixel of our picture in pixels of what was received."""
        width, height = self.size or self.received
        return self.origin[0] + x * width / self.ours[0], self.origin[1] + y * height / self.ours[1]


def say(value: Any, schema: Any, speech: Speech, seat: Seat, root: Mapping[str, Any] | None = None) -> Any:
    """An answer in picture pixels as the model says it, in the shape that the request's schema asks for.

    Args:
        value: JSON with points {x, y} and boxes {x0, y0, x1, y1} in pixels of our picture.
        schema: What the request asked for; None leaves the shape as it is.
        speech: Of the model.
        seat: Where the picture that coordinates refer to was received.
        root: The whole schema, for its definitions.
    """
    root = root if root is not None else (schema or {})
    schema = _settled(schema, root, value)
    if isinstance(value, Mapping) and set(value) == {"x", "y"}:
        return _shaped(speech.point(*seat.at(value["x"], value["y"]), seat.received), schema, speech, root)
    if isinstance(value, Mapping) and set(value) == {"x0", "y0", "x1", "y1"}:
        corners = (seat.at(value["x0"], value["y0"]), seat.at(value["x1"], value["y1"]))
        numbers = [number for corner in corners for number in speech.point(*corner, seat.received)]
        return _shaped(numbers, schema, speech, root)
    if isinstance(value, Mapping):
        return _object(value, schema, speech, seat, root)
    if isinstance(value, list):
        items = schema.get("items") if isinstance(schema, Mapping) else None
        return [say(item, items, speech, seat, root) for item in value]
    return value


def _object(value: Mapping[str, Any], schema: Any, speech: Speech, seat: Seat, root: Mapping[str, Any]) -> Any:
    properties = schema.get("properties", {}) if isinstance(schema, Mapping) else {}
    spare = [name for name in properties if name not in value]
    said = {}
    for name, item in value.items():
        target = name
        if properties and name not in properties:
            # The family's own key for the same thing: box -> box_2d, point -> coords ...
            target = next((other for other in spare if name in other or other in name), spare[0] if spare else name)
            spare = [other for other in spare if other != target]
        said[target] = say(item, properties.get(target), speech, seat, root)
    for name in spare:
        if name in schema.get("required", ()):
            said[name] = "" if _settled(properties[name], root, "").get("type") == "string" else None
    return {
        name: said[name] for name in (*(p for p in properties if p in said), *(s for s in said if s not in properties))
    }


def _settled(schema: Any, root: Mapping[str, Any], value: Any) -> Any:
    """The schema with $ref and anyOf resolved for this value."""
    if not isinstance(schema, Mapping):
        return {}
    if "$ref" in schema:
        name = str(schema["$ref"]).rsplit("/", 1)[-1]
        holder = root.get("$defs") or root.get("definitions") or {}
        return _settled(holder.get(name, {}), root, value)
    for word in ("anyOf", "oneOf"):
        if word in schema:
            options = [_settled(option, root, value) for option in schema[word]]
            return next((option for option in options if _suits(option, value, root)), options[0])
    if len(schema.get("allOf", ())) == 1:
        return _settled(schema["allOf"][0], root, value)
    return schema


def _suits(option: Mapping[str, Any], value: Any, root: Mapping[str, Any]) -> bool:
    kind = option.get("type")
    if value is None:
        return kind == "null"
    if isinstance(value, Mapping):
        if {"x", "y"} <= set(value) or {"x0", "y0"} <= set(value):
            return kind in ("array", "object", "string")
        named = option.get("properties", {}).get("kind")
        if named is not None and "kind" in value:
            named = _settled(named, root, value["kind"])
            return value["kind"] in (named.get("const"), *named.get("enum", ()))
        return kind == "object"
    if isinstance(value, bool):
        return kind == "boolean"
    names = {"array": list, "string": str, "number": (int, float), "integer": int}
    return kind in names and isinstance(value, names[kind])  # type: ignore[arg-type]


def _shaped(numbers: list[float], schema: Any, speech: Speech, root: Mapping[str, Any]) -> Any:
    """Numbers in the model's order, as the array or object that is asked for."""
    kind = schema.get("type")
    straight = numbers
    if speech.order == "yx":
        straight = [number for pair in zip(numbers[::2], numbers[1::2], strict=True) for number in pair[::-1]]
    if kind == "array":
        return numbers
    properties = schema.get("properties", {})
    if not properties or set(properties) == {"x", "y"} or set(properties) == set(BOX_KEYS[0]):
        keys = ("x", "y") if len(numbers) == 2 else BOX_KEYS[0]
        return dict(zip(keys, straight, strict=True))
    for keys in BOX_KEYS:
        if set(keys) <= set(properties):
            return dict(zip(keys, straight, strict=True))
    name, inner = next((n, s) for n, s in properties.items() if _settled(s, root, []).get("type") == "array")
    more = {n: "" for n in schema.get("required", ()) if n != name}
    return {name: numbers, **more}
