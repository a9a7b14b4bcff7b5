"""Check a JSON body against a vendor's own request types (TypedDicts, pydantic models), to the letter."""

from __future__ import annotations

import collections.abc
import types
import typing
from functools import cache
from typing import Any, get_args, get_origin

import typing_extensions
from pydantic import BaseModel, ValidationError

from tests.servers.heard import Rejected

_WRAPPERS = (typing_extensions.Required, typing_extensions.NotRequired, typing.Annotated, typing_extensions.ReadOnly)
_LISTS = (list, collections.abc.Iterable, collections.abc.Sequence)


class Misfit(Exception):  # noqa: N818
    """A value does not fit a type; `depth` says how far the check came."""

    def __init__(self, path: str, problem: str) -> None:
        super().__init__(f"{path}: {problem}")
        self.depth = path.count(".") + path.count("[")


def check_body(body: Any, kind: Any) -> None:
    """Check a whole body.

    Raises:
        Rejected: It does not fit; names the place.
    """
    try:
        fit(body, kind, "body")
    except Misfit as error:
        raise Rejected(400, f"Invalid request: {error}", code="invalid_type") from error


def fit(value: Any, kind: Any, path: str) -> None:
    """Raise Misfit when a JSON value is not of a type. Unknown keys of a TypedDict are refused."""
    origin = get_origin(kind)
    if kind is Any or kind is object or isinstance(kind, typing.TypeVar):
        return
    if origin in _WRAPPERS:
        fit(value, get_args(kind)[0], path)
    elif origin in (typing.Union, types.UnionType):
        _fit_union(value, get_args(kind), path)
    elif typing_extensions.is_typeddict(kind):
        _fit_dict(value, kind, path)
    elif isinstance(kind, type) and issubclass(kind, BaseModel):
        _fit_model(value, kind, path)
    elif origin in _LISTS or getattr(origin, "__name__", "") == "SequenceNotStr":
        for index, item in enumerate(_of(value, list, path)):
            fit(item, get_args(kind)[0], f"{path}[{index}]")
    elif origin in (dict, collections.abc.Mapping):
        for key, item in _of(value, dict, path).items():
            fit(item, get_args(kind)[1], f"{path}.{key}")
    elif origin is typing.Literal:
        if value not in get_args(kind):
            raise Misfit(path, f"{value!r} is none of {get_args(kind)}")
    else:
        _fit_plain(value, kind, path)


def _of(value: Any, kind: type, path: str) -> Any:
    if not isinstance(value, kind):
        raise Misfit(path, f"expected {kind.__name__}, got {type(value).__name__}")
    return value


def _fit_model(value: Any, kind: type[BaseModel], path: str) -> None:
    try:
        kind.model_validate(value)
    except ValidationError as error:
        raise Misfit(path, str(error.errors(include_url=False, include_input=False)[:2])) from error


def _fit_plain(value: Any, kind: Any, path: str) -> None:
    if kind in (None, type(None)):
        good = value is None
    elif kind is bool:
        good = isinstance(value, bool)
    elif kind is int:
        good = isinstance(value, int) and not isinstance(value, bool)
    elif kind is float:
        good = isinstance(value, int | float) and not isinstance(value, bool)
    elif kind in (str, dict, list):
        good = isinstance(value, kind)
    else:
        # Files, paths and the like: the SDK turns them into something else before they are sent.
        good = False
    if not good:
        raise Misfit(path, f"expected {getattr(kind, '__name__', kind)}, got {type(value).__name__}")


def _fit_union(value: Any, members: tuple[Any, ...], path: str) -> None:
    best: Misfit | None = None
    for member in members:
        try:
            fit(value, member, path)
        except Misfit as error:
            if best is None or error.depth > best.depth:
                best = error
        else:
            return
    assert best is not None
    raise best


def _fit_dict(value: Any, kind: Any, path: str) -> None:
    if not isinstance(value, dict):
        raise Misfit(path, f"expected an object, got {type(value).__name__}")
    hints = _hints(kind)
    # What tells members of a union apart comes first, so that a wrong member fails at its root.
    for name in ("type", "role"):
        if name in hints and name in value:
            fit(value[name], hints[name], f"{path}.{name}" if len(hints) > 1 else path)
    unknown = [name for name in value if name not in hints]
    if unknown:
        raise Misfit(path, f"unknown field {unknown[0]!r}")
    for name, hint in hints.items():
        # Where annotations are texts, the class itself does not know which keys are required.
        required = get_origin(hint) is typing_extensions.Required or (
            name in kind.__required_keys__ and get_origin(hint) is not typing_extensions.NotRequired
        )
        if required and name not in value:
            raise Misfit(path, f"missing required field {name!r}")
    for name, item in value.items():
        if name not in ("type", "role"):
            fit(item, hints[name], f"{path}.{name}")


@cache
def _hints(kind: Any) -> dict[str, Any]:
    return typing_extensions.get_type_hints(kind, include_extras=True)
