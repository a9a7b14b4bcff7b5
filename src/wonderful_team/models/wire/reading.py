"""The JSON in what a model said: fences, thinking and prose around it, and JSON inside JSON, are repaired and said so."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import Any

_THINKING = re.compile(r"<(think|thinking|thought|reasoning)>.*?</\1>", re.DOTALL | re.IGNORECASE)
_OPEN_END = re.compile(r"^.*</(think|thinking|thought|reasoning)>", re.DOTALL | re.IGNORECASE)
_FENCE = re.compile(r"```[a-zA-Z]*\s*\n?(.*?)```", re.DOTALL)
_POINT_TAG = re.compile(r"<points?\b([^>]*)>", re.IGNORECASE)
_PAIR = re.compile(r"\bx(\d*)\s*=\s*\"([-\d.]+)\"\s+y\1\s*=\s*\"([-\d.]+)\"")
_COORDS = re.compile(r"coords\s*=\s*\"([^\"]*)\"")
_MOST_STARTS = 200
_MOST_DEPTH = 50
"""No question's answer is nested deeper than ten; deeper values would exhaust whatever walks them."""


@dataclass(frozen=True)
class Reading:
    """A JSON value and what had to be repaired to get it."""

    value: Any
    repairs: tuple[str, ...] = ()


def read_json(text: str, keys: frozenset[str] = frozenset()) -> Reading:
    """The JSON object in a model's words.

    Args:
        text: What the model said.
        keys: Names that the object should have: they tell it from others in the text.

    Raises:
        ValueError: There is none, it holds NaN or Infinity, or is nested too deeply; the text is for the model.
    """
    stripped = text.strip().lstrip("\ufeff")
    if not stripped:
        raise ValueError("the answer is empty; expected one JSON object")
    value, repairs = _found(stripped, keys)
    for _ in range(2):
        if isinstance(value, str):
            found, inner = _parsed(value.strip())
            if not found:
                break
            value = inner
            repairs.append("double-encoded JSON decoded")
    if isinstance(value, list) and len(value) == 1 and isinstance(value[0], dict):
        value = value[0]
        repairs.append("a list round the answer dropped")
    if isinstance(value, dict) and keys and len(value) == 1:
        (name, inner) = next(iter(value.items()))
        if name not in keys and isinstance(inner, dict):
            value = inner
            repairs.append(f"the wrapper {name!r} round the answer dropped")
    if not isinstance(value, dict):
        raise ValueError(f"expected one JSON object, got {type(value).__name__}")
    _check_depth(value)
    return Reading(_encodable(value), tuple(repairs))


def _found(text: str, keys: frozenset[str]) -> tuple[Any, list[str]]:
    """The value in a model's words, and what had to be left out or taken as it is."""
    found, value = _parsed(text)
    if found:
        return value, [] if _is_strict(text) else [_CONTROL]
    cleaned = _OPEN_END.sub("", _THINKING.sub("", text)).strip()
    repairs = ["thinking before the answer dropped"] if cleaned != text else []
    found, value = _parsed(cleaned)
    if not found:
        return _embedded(cleaned, keys), [*repairs, "text round the JSON dropped"]
    return value, repairs if _is_strict(cleaned) else [*repairs, _CONTROL]


def encodable(text: str) -> str:
    """The text without lone surrogates: JSON can hold them as escapes, but no file or terminal can."""
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace")


def _check_depth(value: Any) -> None:
    level = [value]
    for _ in range(_MOST_DEPTH):
        level = [
            inner
            for outer in level
            for inner in (outer.values() if isinstance(outer, dict) else outer)
            if isinstance(inner, dict | list)
        ]
        if not level:
            return
    raise ValueError(f"the JSON is nested deeper than {_MOST_DEPTH} levels; expected an object of the form asked for")


def _encodable(value: Any) -> Any:
    match value:
        case str():
            return encodable(value)
        case dict():
            return {encodable(name): _encodable(item) for name, item in value.items()}
        case list():
            return [_encodable(item) for item in value]
    return value


def read_point_tags(text: str) -> list[list[float]]:
    """The numbers of Molmo's tags: `<point x="1" y="2">`, `<points x1= y1= x2= …>` or `coords="1 1 2"`, in its own unit."""
    pairs: list[list[float]] = []
    for tag in _POINT_TAG.finditer(text):
        pairs += [[float(x), float(y)] for _, x, y in _PAIR.findall(tag.group(1))]
        for coords in _COORDS.findall(tag.group(1)):
            numbers = [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", coords)]
            # Each point is preceded by its number; a frame number may stand before all.
            numbers = numbers[1:] if len(numbers) % 3 == 1 else numbers
            step, first = (3, 1) if len(numbers) % 3 == 0 else (2, 0)
            pairs += [numbers[i + first : i + first + 2] for i in range(0, len(numbers), step)]
    return pairs


def _no_constant(name: str) -> Any:
    raise _NotANumberError(name)


class _NotANumberError(Exception):
    pass


_CONTROL = "control characters in a text taken as they are"
_DECODER = json.JSONDecoder(parse_constant=_no_constant, strict=False)
"""Takes line breaks and the like inside texts: models write them, and servers that enforce schemas let some through."""


def _is_strict(text: str) -> bool:
    """Whether JSON that could be read has all control characters of its texts written as escapes."""
    try:
        json.loads(text)
    except (ValueError, RecursionError):
        return False
    return True


def _parsed(text: str) -> tuple[bool, Any]:
    try:
        return True, _DECODER.decode(text)
    except _NotANumberError as constant:
        raise ValueError(f"{constant} is not a valid number; every number must be finite") from None
    except (ValueError, RecursionError):
        return False, None


def _embedded(text: str, keys: frozenset[str]) -> Any:
    """The object inside prose: of a fence if there is one, with the names that are expected, the last of these."""
    for fenced in reversed(_FENCE.findall(text)):
        found, value = _parsed(fenced.strip())
        if found:
            return value
    candidates: list[tuple[int, int, Any]] = []
    position = text.find("{")
    for _ in range(_MOST_STARTS):
        if position < 0:
            break
        try:
            value, end = _DECODER.raw_decode(text, position)
        except _NotANumberError as constant:
            raise ValueError(f"{constant} is not a valid number; every number must be finite") from None
        except (ValueError, RecursionError):
            position = text.find("{", position + 1)
            continue
        candidates.append((len(keys & set(value)), end, value))
        position = text.find("{", end)
    if not candidates:
        start = "the JSON is cut off or malformed" if "{" in text else "there is no JSON in it"
        raise ValueError(f"{start}; expected one JSON object and nothing else")
    return max(candidates, key=lambda candidate: candidate[:2])[2]
