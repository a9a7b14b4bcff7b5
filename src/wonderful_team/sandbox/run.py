"""run_path: call a model's `path(boxes)` and check what it returns."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pydantic_monty

from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import PathPoint
from wonderful_team.sandbox.errors import SandboxError
from wonderful_team.sandbox.explained import explained
from wonderful_team.sandbox.returned import cut, describing, parsed
from wonderful_team.sandbox.worker import WorkerLostError, discarded_output, in_worker, without_value

MAX_CODE_CHARACTERS = 20_000

_AUTHORS_FILE = "<python-input-1>"
_NONE: Mapping[str, str] = MappingProxyType({})
_BUILTINS = (
    "abs all any bool dict divmod enumerate filter float int isinstance len list map max min pow range repr reversed round set "
    "sorted str sum tuple zip"
)
_EARLIER = """
def _earlier({bound}):
{body}
    return path


{name} = _earlier()
"""
"""A function that was accepted before, in a scope of its own: what it defines reaches no other code, and what other code defines does
not reach it. It has its own copy of the shapes, and of the builtins and earlier functions as they are before its author's code runs.
"""


@cache
def _shapes() -> str:
    """The text of the functions that the model's code may call."""
    return (Path(__file__).parent / "shapes.py").read_text(encoding="utf-8")


def called(code: str, earlier: Mapping[str, str]) -> dict[str, str]:
    """Those of the earlier functions whose names the code holds, and those that they call themselves, in their own order."""
    wanted, rest = {}, code
    for name, text in reversed(list(earlier.items())):
        if re.search(rf"\b{re.escape(name)}\b", rest):
            wanted[name] = text
            rest += f"\n{text}"
    return dict(reversed(list(wanted.items())))


def _beside(earlier: Mapping[str, str]) -> str:
    """The program that defines earlier functions, each able to call those before it."""
    parts, known = [], _BUILTINS.split()
    for name, code in earlier.items():
        bound = ", ".join(f"{one}={one}" for one in known)
        body = "\n".join(f"    {line}" for line in f"{_shapes()}\n{code}".split("\n"))
        parts.append(_EARLIER.format(bound=bound, body=body, name=name))
        known.append(name)
    return "".join(parts)


def run_path(
    code: str,
    boxes: Mapping[str, Box],
    *,
    earlier: Mapping[str, str] = _NONE,
    max_points: int = 20,
    timeout_s: float = 2.0,
) -> tuple[PathPoint, ...]:
    """Run code that defines `path(boxes)` and return its points; it may call the functions of `shapes.py` and earlier ones.

    The code runs in another process, without files, network, clock or packages, within bounds on time and memory.
    Nothing it does can change this process, and nothing it returns reaches this process: the worker describes the value in at
    most `PRINTED_BYTES` of text, which is parsed here as untrusted input.

    Args:
        code: Python source that defines `path(boxes)`.
        boxes: By target id; the function gets tuples (x0, y0, x1, y1) [px].
        earlier: Code of functions that were accepted before, oldest first, by the name by which this code may call each; those that
            it does not name are not run.
        max_points: Most points it may return; the least is 2.
        timeout_s: Longest time for reading the code, and again for the call [s].

    Returns:
        Points (x, y) [px], or all of them (x, y, up) for a path in the air, up in metres; finite, 2 to `max_points` of them.

    Raises:
        SandboxError: Anything that went wrong with the code or with what it returned; the text is for its author and has at
            most `MAX_ERROR_CHARACTERS`.
        SandboxUnavailableError: The workers do not run here, not even an empty program.
    """
    needed = called(code, earlier)
    for whose, text in (("the code", code), *needed.items()):
        if len(text) > MAX_CODE_CHARACTERS:
            raise SandboxError(f"{whose} has {len(text)} characters; at most {MAX_CODE_CHARACTERS} are run")
    plain = {name: box.as_tuple for name, box in boxes.items()}

    def run(interpreter: Any) -> str:
        try:
            interpreter.feed_run(without_value(_shapes() + _beside(needed)), print_callback=discarded_output())
        except (pydantic_monty.MontySyntaxError, pydantic_monty.MontyRuntimeError) as error:
            if not needed:
                raise
            raise SandboxError(
                f"{', '.join(needed)} could not be put beside this code ({cut(str(error), 200)}): write it without"
            ) from error
        interpreter.feed_run(without_value(code), print_callback=discarded_output())
        interpreter.feed_run("_returned = path(boxes)", inputs={"boxes": plain}, print_callback=discarded_output())
        described = discarded_output()
        interpreter.feed_run(describing(max_points), print_callback=described)
        return str(described.output)

    try:
        text = in_worker(run, timeout_s)
    except WorkerLostError as error:
        raise SandboxError(f"the function had to be stopped from outside: {cut(str(error), 200)}") from error
    except (pydantic_monty.MontySyntaxError, pydantic_monty.MontyRuntimeError) as error:
        raise SandboxError(cut(_explained(error, code))) from error
    except pydantic_monty.MontyError as error:
        raise SandboxError(f"the function could not be run: {cut(str(error), 200)}") from error
    return parsed(text, max_points)


def _explained(error: Any, code: str) -> str:
    """The same as for every program; or that it lacks the function."""
    own = any(frame.filename == _AUTHORS_FILE for frame in error.traceback())
    if type(error.exception()).__name__ == "NameError" and "'path'" in str(error) and not own:
        return "the code does not define a function path(boxes)"
    return explained(error, code, _AUTHORS_FILE)
