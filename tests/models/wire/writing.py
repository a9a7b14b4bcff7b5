"""Our answers as a model of a family would write them: the other way round than `Form.read`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from wonderful_team.models.conventions import Convention, Size
from wonderful_team.models.wire import Form
from wonderful_team.models.wire.form import _BOX, _POINT, Json, _fitting, _kind, _native_name


def written(form: Form, value: Any, size_px: Size) -> Any:
    """Our value (places in pixels of a picture of `size_px`) as the model would write it."""
    plain = value.model_dump() if isinstance(value, BaseModel) else value
    return _write(plain, form._ours, form._ours.get("$defs", {}), form.convention, size_px)


def _write(value: Any, node: Json, defs: Json, convention: Convention, size_px: Size) -> Any:
    if value is None:
        return None
    option = _fitting(value, node, defs, convention)
    reference = option.get("$ref")
    if reference in (_POINT, _BOX):
        names = ("x0", "y0", "x1", "y1") if reference == _BOX else ("x", "y")
        pairs = [[value[names[i]], value[names[i + 1]]] for i in range(0, len(names), 2)]
        numbers = [round(float(n), 3) for pair in convention.to_model(pairs, size_px) for n in pair]
        shape = convention.shape.box_keys if reference == _BOX else convention.shape.point_keys
        return numbers if shape is None else dict(zip(shape, numbers, strict=True))
    if isinstance(value, list | tuple):
        return [_write(item, option.get("items", {}), defs, convention, size_px) for item in value]
    if isinstance(value, Mapping):
        properties = option.get("properties", {})
        return {
            _native_name(key, _kind(properties.get(key, {})), convention): _write(
                item, properties.get(key, {}), defs, convention, size_px
            )
            for key, item in value.items()
        }
    return value
