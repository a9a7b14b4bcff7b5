"""An answer's JSON schema in the model's own format, and the way back: places become pixels of our picture at once."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel

from wonderful_team.contracts import BoxPx, PointPx
from wonderful_team.models.conventions import Convention

Json = dict[str, Any]
ToPx = Callable[[Sequence[Sequence[float]]], Any]

_POINT, _BOX = "#/$defs/PointPx", "#/$defs/BoxPx"
_UNIT_WORDS = {
    "pixels": "in pixels",
    "thousandths": "in thousandths of width and height (0 to 1000)",
    "percent": "in percent of width and height (0 to 100)",
    "unit": "as shares of width and height (0 to 1)",
}
_CORNERS = (("x0", "y0", "x1", "y1"), ("x1", "y1", "x2", "y2"), ("x_min", "y_min", "x_max", "y_max"), ("xmin", "ymin", "xmax", "ymax"))  # fmt: skip


@dataclass(frozen=True)
class Form:
    """The schema of one kind of answer as one model writes it.

    Attributes:
        schema: JSON schema to send.
        has_places: The answer holds points or boxes.
    """

    convention: Convention
    schema: Json
    has_places: bool
    _ours: Json = field(repr=False)

    @classmethod
    def of(cls, output: type[BaseModel], convention: Convention) -> Form:
        """The form of `output` (a pydantic model) for a model that speaks `convention`."""
        ours = output.model_json_schema()
        schema = copy.deepcopy(ours)
        defs = schema.get("$defs", {})
        has_places = "PointPx" in defs or "BoxPx" in defs
        for name, count in (("PointPx", 2), ("BoxPx", 4)):
            if name in defs:
                defs[name] = _native(convention, count)
        for node in (schema, *defs.values()):
            _rename(node, convention)
        _untitle(schema)
        _renamed_defs(schema)
        return cls(convention, schema, has_places, ours)

    @property
    def text(self) -> str:
        """The schema in one line, for models that must be told it in words."""
        return json.dumps(self.schema, separators=(",", ":"), ensure_ascii=False)

    def describe(self) -> str:
        """Unit and order of places, in one sentence."""
        order = "x before y" if self.convention.order == "xy" else "y before x"
        return f"{_UNIT_WORDS[self.convention.unit]}, {order}, counted right and down from the top-left corner"

    def read(self, value: Any, to_px: ToPx) -> Any:
        """The value with our names, and with places in pixels of our picture.

        Args:
            value: Parsed JSON as the model wrote it.
            to_px: The model's pairs of numbers, in its order, to pixels (x, y), shape (N, 2).

        Raises:
            ValueError: A place is not written as the schema says; the text is for the model.
        """
        return _read(value, self._ours, self._ours.get("$defs", {}), self.convention, to_px, "answer")


def point_keys(convention: Convention) -> tuple[str, str]:
    """Names of a point's two numbers, in the model's order."""
    return convention.shape.point_keys or (("x", "y") if convention.order == "xy" else ("y", "x"))


def box_keys(convention: Convention) -> tuple[str, str, str, str]:
    """Names of a box's four numbers, in the model's order."""
    xy = convention.order == "xy"
    return convention.shape.box_keys or (("x1", "y1", "x2", "y2") if xy else ("ymin", "xmin", "ymax", "xmax"))


def _native(convention: Convention, count: int) -> Json:
    """Schema of a point (2 numbers) or a box (4 numbers)."""
    keys: tuple[str, ...] = point_keys(convention) if count == 2 else box_keys(convention)
    what = f"[{', '.join(keys)}] {_UNIT_WORDS[convention.unit]}, from the top-left corner"
    named = convention.shape.point_keys if count == 2 else convention.shape.box_keys
    if named is None:
        return {"type": "array", "items": {"type": "number"}, "minItems": count, "maxItems": count, "description": what}
    return {
        "type": "object",
        "properties": {key: {"type": "number"} for key in named},
        "required": list(named),
        "additionalProperties": False,
        "description": what,
    }


def _kind(node: Any) -> str:
    """point, box or "": what a property holds, perhaps nullable."""
    options = node.get("anyOf", [node]) if isinstance(node, dict) else []
    refs = {option.get("$ref") for option in options if isinstance(option, dict)}
    return "point" if _POINT in refs else "box" if _BOX in refs else ""


def _native_name(name: str, kind: str, convention: Convention) -> str:
    if name == "point" and kind == "point":
        return convention.shape.point
    return convention.shape.box if name == "box" and kind == "box" else name


def _rename(node: Json, convention: Convention) -> None:
    properties = node.get("properties")
    if not properties:
        return
    names = {name: _native_name(name, _kind(sub), convention) for name, sub in properties.items()}
    node["properties"] = {names[name]: sub for name, sub in properties.items()}
    if "required" in node:
        node["required"] = [names.get(name, name) for name in node["required"]]


def _renamed_defs(schema: Json) -> None:
    """Definitions of places are called Point and Box: the model's numbers need not be pixels."""
    names = {"PointPx": "Point", "BoxPx": "Box"}
    if "$defs" in schema:
        schema["$defs"] = {names.get(name, name): node for name, node in schema["$defs"].items()}
    _repointed(schema, {_POINT: "#/$defs/Point", _BOX: "#/$defs/Box"})


def _repointed(node: Any, references: Mapping[str, str]) -> None:
    if isinstance(node, dict):
        if node.get("$ref") in references:
            node["$ref"] = references[node["$ref"]]
        for sub in node.values():
            _repointed(sub, references)
    elif isinstance(node, list):
        for sub in node:
            _repointed(sub, references)


def _untitle(node: Any) -> None:
    """Drop the titles that pydantic makes up of field names, and the docstrings of objects stay."""
    if isinstance(node, dict):
        if isinstance(node.get("title"), str):
            node.pop("title")
        for sub in node.values():
            _untitle(sub)
    elif isinstance(node, list):
        for sub in node:
            _untitle(sub)


def _options(node: Json, defs: Json) -> list[Json]:
    """The alternatives of a node, references followed (places stay references)."""
    if "$ref" in node and node["$ref"] not in (_POINT, _BOX):
        return _options(defs[node["$ref"].rpartition("/")[2]], defs)
    found: list[Json] = []
    for key in ("anyOf", "oneOf", "allOf"):
        for sub in node.get(key, ()):
            found += _options(sub, defs)
    return found or [node]


def _fitting(value: Any, node: Json, defs: Json, convention: Convention) -> Json:
    """The alternative that a value seems to be meant for."""
    options = _options(node, defs)
    if isinstance(value, Mapping):
        for option in options:
            properties = option.get("properties", {})
            consts = {key: sub["const"] for key, sub in properties.items() if "const" in sub}
            names = {_native_name(key, _kind(sub), convention) for key, sub in properties.items()} | set(properties)
            if properties and all(value.get(k) == c for k, c in consts.items()) and set(value) <= names:
                return option
    solid = [option for option in options if option.get("type") != "null"]
    return solid[0] if solid else options[0]


def _read(value: Any, node: Json, defs: Json, convention: Convention, to_px: ToPx, where: str) -> Any:
    if value is None:
        return None
    option = _fitting(value, node, defs, convention)
    reference = option.get("$ref")
    if reference in (_POINT, _BOX):
        return _place(value, reference == _BOX, convention, to_px, where)
    kind = option.get("type")
    if isinstance(value, str) and kind in ("object", "array"):
        value = _decoded(value)
    if kind == "array" and isinstance(value, list):
        inner = option.get("items", {})
        return [_read(item, inner, defs, convention, to_px, f"{where}[{i}]") for i, item in enumerate(value)]
    if kind == "object" and isinstance(value, Mapping):
        result = {}
        native = {_native_name(key, _kind(sub), convention): key for key, sub in option.get("properties", {}).items()}
        for name, item in value.items():
            ours = native.get(name, name)
            sub = option.get("properties", {}).get(ours, {})
            result[ours] = _read(item, sub, defs, convention, to_px, f"{where}.{name}")
        return result
    return value


def _decoded(text: str) -> Any:
    """A nested object or list that was written as a string."""
    try:
        inner = json.loads(text)
    except (ValueError, RecursionError):
        return text
    return inner if isinstance(inner, dict | list) else text


def _place(value: Any, is_box: bool, convention: Convention, to_px: ToPx, where: str) -> Json:
    count, keys = (4, box_keys(convention)) if is_box else (2, point_keys(convention))
    numbers = _numbers(_decoded(value) if isinstance(value, str) else value, keys, convention)
    if numbers is None or len(numbers) != count:
        raise ValueError(f"{where}: expected [{', '.join(keys)}] {_UNIT_WORDS[convention.unit]}, got {_short(value)}")
    if not all(math.isfinite(number) for number in numbers):
        raise ValueError(f"{where}: every number must be finite, got {_short(value)}")
    pairs = [numbers[i : i + 2] for i in range(0, count, 2)]
    px = [float(number) for pair in to_px(pairs) for number in pair]
    return dict(zip(("x0", "y0", "x1", "y1") if is_box else ("x", "y"), px, strict=True))


def _numbers(value: Any, keys: Sequence[str], convention: Convention) -> list[float] | None:
    """The numbers of a place in the model's order, from an array or an object with its own or our names."""
    if isinstance(value, Mapping):
        in_order = list(keys)
        if not set(in_order) <= set(value):
            named = next((n for n in (*_CORNERS, ("x", "y")) if len(n) == len(keys) and set(n) <= set(value)), None)
            if named is None:
                inner = [item for item in value.values() if isinstance(item, list)]
                return _numbers(inner[0], keys, convention) if len(inner) == 1 else None
            in_order = list(named)
            if convention.order == "yx":
                in_order = [in_order[i ^ 1] for i in range(len(in_order))]
        value = [value[key] for key in in_order]
    if not isinstance(value, list | tuple):
        return None
    if len(value) == 1 and isinstance(value[0], list | tuple):
        value = value[0]
    elif len(value) == 2 and all(isinstance(item, list | tuple) and len(item) == 2 for item in value):
        value = [*value[0], *value[1]]
    try:
        return [float(item) for item in value if not isinstance(item, bool)]
    except (TypeError, ValueError):
        return None


def _short(value: Any) -> str:
    text = json.dumps(value, default=str)
    return text if len(text) <= 80 else text[:77] + "..."


__all__ = ["BoxPx", "Form", "PointPx", "ToPx", "box_keys", "point_keys"]
