"""run_path: call a model's `path(boxes)` and check what it returns."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pydantic_monty

from wonderful_team.geometry import Box
from wonderful_team.pictures import Point
from wonderful_team.sandbox.errors import SandboxError
from wonderful_team.sandbox.worker import discarded_output, session

MAX_CODE_CHARACTERS = 20_000
MAX_COORDINATE_PX = 1e6
"""Larger numbers are no pixels."""

_AUTHORS_FILE = "<python-input-0>"
_FORBIDDEN = {
    "ModuleNotFoundError": "only the math module is needed; other packages do not exist here",
    "PermissionError": "there are no files here; compute the path from the boxes alone",
    "NotImplementedError": "use plain functions, loops, lists and the math module",
    "MemoryError": "a path has a few points; build no large lists or texts",
    "RecursionError": "use a loop instead of calling a function inside itself",
    "TimeoutError": "the function did not end in time: check the loops, and do not wait",
}


def run_path(code: str, boxes: Mapping[str, Box], *, max_points: int = 20, timeout_s: float = 2.0) -> tuple[Point, ...]:
    """Run code that defines `path(boxes)` and return its points.

    The code runs in another process, without files, network, clock or packages, within bounds on time and memory.
    Nothing it does can change this process.

    Args:
        code: Python source that defines `path(boxes)`.
        boxes: By target id; the function gets tuples (x0, y0, x1, y1) [px].
        max_points: Most points it may return; the least is 2.
        timeout_s: Longest time for reading the code, and again for the call [s].

    Returns:
        Points (x, y) [px], all finite, 2 to `max_points` of them.

    Raises:
        SandboxError: Anything that went wrong with the code or with what it returned; the text is for its author.
    """
    if len(code) > MAX_CODE_CHARACTERS:
        raise SandboxError(f"the code has {len(code)} characters; at most {MAX_CODE_CHARACTERS} are run")
    plain = {name: box.as_tuple for name, box in boxes.items()}
    try:
        with session(timeout_s) as interpreter:
            interpreter.feed_run(code, print_callback=discarded_output())
            returned = interpreter.feed_run("path(boxes)", inputs={"boxes": plain}, print_callback=discarded_output())
    except pydantic_monty.MontyCrashedError as error:
        raise SandboxError(f"the function had to be stopped from outside: {_first_line(str(error))}") from error
    except (pydantic_monty.MontySyntaxError, pydantic_monty.MontyRuntimeError) as error:
        raise SandboxError(_explained(error, code)) from error
    except pydantic_monty.MontyError as error:
        raise SandboxError(f"the function could not be run: {_first_line(str(error))}") from error
    return checked_points(returned, max_points)


def checked_points(returned: Any, max_points: int) -> tuple[Point, ...]:
    """What a function returned, as points.

    Raises:
        SandboxError: Not a list of 2 to `max_points` pairs of finite numbers.
    """
    if not isinstance(returned, list | tuple):
        raise SandboxError(f"path(boxes) must return a list of (x, y), it returned {_shortened(returned)}")
    if not 2 <= len(returned) <= max_points:
        raise SandboxError(f"path(boxes) returned {len(returned)} points; 2 to {max_points} are allowed")
    return tuple(_checked_point(point, number) for number, point in enumerate(returned, start=1))


def _checked_point(point: Any, number: int) -> Point:
    if not isinstance(point, list | tuple) or len(point) != 2:
        raise SandboxError(f"point {number} must be a pair (x, y), it is {_shortened(point)}")
    for value in point:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise SandboxError(f"point {number} must hold two numbers, it is {_shortened(point)}")
        # Compared before any conversion: an integer may be too large for a float.
        if not (isinstance(value, int) or math.isfinite(value)) or abs(value) > MAX_COORDINATE_PX:
            raise SandboxError(f"point {number} is {_shortened(point)}; both numbers must be finite pixels")
    return float(point[0]), float(point[1])


def _explained(error: Any, code: str) -> str:
    """The exception, the line of the author's code where it arose, and what would be valid."""
    message = str(error)
    kind = type(error.exception()).__name__
    if kind == "NameError" and "'path'" in message and not any(f.filename == _AUTHORS_FILE for f in error.traceback()):
        return "the code does not define a function path(boxes)"
    text = message if message.startswith(kind) else f"{kind}: {message}"
    lines = [frame.line for frame in error.traceback() if frame.filename == _AUTHORS_FILE]
    source = code.splitlines()
    if lines and 1 <= lines[-1] <= len(source):
        text += f"\nin line {lines[-1]}: {source[lines[-1] - 1].strip()[:200]}"
    return text + (f"\n{_FORBIDDEN[kind]}" if kind in _FORBIDDEN else "")


def _first_line(text: str) -> str:
    return text.splitlines()[0][:200] if text else "no reason given"


def _shortened(value: Any, depth: int = 0) -> str:
    if isinstance(value, int) and abs(value) > MAX_COORDINATE_PX:
        return "a very large number"
    if isinstance(value, list | tuple):
        # A list may hold itself.
        inside = ", ".join(_shortened(item, depth + 1) for item in value[:4]) if depth < 2 else "..."
        return f"({inside}{', ...' if len(value) > 4 else ''})"
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."
