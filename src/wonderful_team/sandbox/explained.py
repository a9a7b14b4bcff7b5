"""What went wrong in a model's code, as text for its author."""

from __future__ import annotations

from typing import Any

from wonderful_team.sandbox.returned import cut

_FORBIDDEN = {
    "ModuleNotFoundError": "only the math module is needed; other packages do not exist here",
    "PermissionError": "there are no files here; compute with what is given alone",
    "NotImplementedError": "use plain functions, loops, lists and the math module",
    "MemoryError": "a few points are enough; build no large lists or texts",
    "RecursionError": "use a loop instead of calling a function inside itself",
    "TimeoutError": "the code did not end in time: check the loops, and do not wait",
}


def explained(error: Any, code: str, file: str) -> str:
    """The exception, the line of the author's code where it arose, and what would be valid.

    Args:
        error: Of the interpreter.
        code: The author's.
        file: What the interpreter calls it.
    """
    message = cut(str(error))
    kind = type(error.exception()).__name__
    text = message if message.startswith(kind) else f"{kind}: {message}"
    lines = [frame.line for frame in error.traceback() if frame.filename == file]
    source = code.splitlines()
    if lines and 1 <= lines[-1] <= len(source):
        text += f"\nin line {lines[-1]}: {source[lines[-1] - 1].strip()[:200]}"
    return text + (f"\n{_FORBIDDEN[kind]}" if kind in _FORBIDDEN else "")
