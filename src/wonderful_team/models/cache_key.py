"""What makes two requests the same for the cache: everything that can change the answer, and nothing else."""

from __future__ import annotations

import hashlib
import inspect
import json
import threading
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from wonderful_team._version import __version__
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.pictures import Picture, picture_hash
from wonderful_team.core.protocols import Model
from wonderful_team.core.values import Part, Request
from wonderful_team.errors import ConfigError
from wonderful_team.images import Ticks
from wonderful_team.images.drawn import drawn_hash

KEY_VERSION = 1
"""Raise it when the same request must no longer find answers kept by an older release."""

_lock = threading.Lock()
_schemas: WeakKeyDictionary[type[Any], str] = WeakKeyDictionary()
_depths: WeakKeyDictionary[Picture, str] = WeakKeyDictionary()


def request_key(request: Request, model: Model, repeat: int = 0) -> str:
    """The key of a request to a model: 64 hex digits.

    It holds the words, the drawn pictures, the answer's schema, the model's identity (name, server, settings), and
    `sample`, `attempt` with its feedback, and `repeat`, so that independent samples stay independent. It does not hold
    the request's id, time-outs or concurrency. A model that draws pictures itself (it has `ticks`) sees only what is
    drawn; any other may read marks, frames and depth as data, so they are in its key.

    Raises:
        ConfigError: The model's `identity` is not made of JSON values.
    """
    ticks = getattr(model, "ticks", None)
    reads_data = not isinstance(ticks, Ticks)
    seen = ticks if isinstance(ticks, Ticks) else Ticks.PIXELS
    held = {
        "version": KEY_VERSION,
        "model": model_identity(model),
        "repeat": repeat,
        "sample": request.sample,
        "attempt": request.attempt,
        "feedback": request.feedback,
        "previous": _plain(request.previous),
        "contract": request.contract,
        "schema": _schema(request.output),
        "system": request.system,
        "parts": [_part(part, seen, reads_data) for part in request.parts],
    }
    text = json.dumps(held, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def model_identity(model: Model) -> Any:
    """What tells a model's answers from another's: its `identity`, else its name, class and code.

    Raises:
        ConfigError: `identity` is not made of JSON values.
    """
    stated = getattr(model, "identity", None)
    if stated is not None:
        try:
            return json.loads(json.dumps(to_jsonable(stated), sort_keys=True))
        except (TypeError, ValueError) as error:
            raise ConfigError(
                f"model {getattr(model, 'name', type(model).__name__)!r}: its identity must be made of JSON values: {error}"
            ) from error
    kind = type(model)
    return {
        "name": str(getattr(model, "name", kind.__name__)),
        "class": f"{kind.__module__}.{kind.__qualname__}",
        "code": _code(kind),
        "wonderful_team": __version__,
    }


@lru_cache(maxsize=64)
def _code(kind: type[Any]) -> str:
    """Hash of the source that a class stands in: its package when it has one, else its file; "" when unknown."""
    try:
        file = Path(inspect.getfile(kind))
    except (TypeError, OSError):
        return ""
    in_package = (file.parent / "__init__.py").is_file()
    files = sorted(file.parent.rglob("*.py")) if in_package else [file]
    digest = hashlib.sha256()
    for source in files:
        try:
            digest.update(source.name.encode() + b"\0" + source.read_bytes())
        except OSError:
            continue
    return digest.hexdigest()[:16]


def _part(part: Part, ticks: Ticks, reads_data: bool) -> Any:
    if not isinstance(part, Picture):
        said = [part.text, part.says]
        return said if part.picture is None else [*said, part.picture.name, list(part.picture.size_px)]
    shown: dict[str, Any] = {"name": part.name, "size_px": list(part.size_px), "drawn": drawn_hash(part, ticks)}
    if reads_data:
        shown["clean"] = part.hash
        shown["marks"] = to_jsonable(part.marks)
        shown["frame"] = to_jsonable(part.frame)
        shown["depth"] = _depth_hash(part)
    return shown


def _depth_hash(picture: Picture) -> str:
    if picture.depth_m is None:
        return ""
    with _lock:
        known = _depths.get(picture)
    if known is None:
        known = picture_hash(np.asarray(picture.depth_m))
        with _lock:
            _depths[picture] = known
    return known


def _schema(output: type[Any]) -> str:
    """Hash of the answer's JSON schema."""
    with _lock:
        known = _schemas.get(output)
    if known is None:
        text = json.dumps(output.model_json_schema(), sort_keys=True)
        known = hashlib.sha256(text.encode()).hexdigest()[:16]
        with _lock:
            _schemas[output] = known
    return known


def _plain(value: Any) -> Any:
    """The last, invalid answer as JSON values; what has none is taken as text."""
    match value:
        case Mapping():
            return {str(key): _plain(item) for key, item in value.items()}
        case list() | tuple():
            return [_plain(item) for item in value]
        case float():
            return repr(value)
    try:
        return to_jsonable(value)
    except TypeError:
        return repr(value)
