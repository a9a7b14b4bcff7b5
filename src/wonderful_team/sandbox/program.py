"""run_program: run a model's program that calls functions of the host, without a value or a call that leaves the worker.

A function that is called prints what it was called with, as a line of text, and takes its answer from a list that the program was
started with. Where the list has no answer yet, the program is stopped; its caller finds the answer and runs it again from the start. Programs
are small, and get the same clock and the same random numbers each time, so they ask the same again.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pydantic_monty

from wonderful_team.sandbox.errors import SandboxError
from wonderful_team.sandbox.explained import explained
from wonderful_team.sandbox.returned import cut
from wonderful_team.sandbox.run import MAX_CODE_CHARACTERS
from wonderful_team.sandbox.worker import WorkerLostError, discarded_output, in_worker, without_value

MAX_CALLS = 100
"""Most calls of host functions in one program."""
MAX_PRINTED_CHARACTERS = 4_000
"""Most of what a program prints that goes back to its author; the Trajectory Generators pass on at most 2,000."""
MAX_NUMBER = 1e12
"""Larger numbers are no quantity of anything on a table."""
MAX_TEXT_CHARACTERS = 1_000
"""Longest text in a call: names and descriptions."""
MAX_DEPTH = 8
"""Most lists and dictionaries inside each other in a call."""
_MARK = "\x1d"
"""Begins the line of a call."""
_AUTHORS_FILE = "<python-input-1>"

_PRELUDE = """
import json as _json
_made, _asked = [], []


def _call(name, given):
    print('\\n{mark}' + _json.dumps([name, given]))
    _made.append(0)
    if len(_made) > {most}:
        raise KeyboardInterrupt('a program may call at most {most} functions')
    if name in _unanswered:
        return None
    _asked.append(0)
    if len(_asked) > len(_answers):
        raise KeyboardInterrupt('waits for an answer')
    answer = _answers[len(_asked) - 1]
    if 'error' in answer:
        raise ValueError(answer['error'])
    return answer['value']
"""


@dataclass(frozen=True)
class HostCall:
    """A call of one of the host's functions.

    Attributes:
        arguments: One for each parameter: plain JSON values, numbers finite, within the bounds above; else as untrusted as the program.
    """

    function: str
    arguments: tuple[Any, ...]


@dataclass(frozen=True)
class ProgramRun:
    """How far a program came.

    Attributes:
        calls: In order; where it waits, the last one has no answer yet.
        printed: What it printed itself.
        waits: It goes on once the last call is answered.
    """

    calls: tuple[HostCall, ...]
    printed: str
    waits: bool


def run_program(
    code: str,
    functions: Mapping[str, str],
    answers: Sequence[Mapping[str, Any]] = (),
    *,
    unanswered: frozenset[str] = frozenset(),
    timeout_s: float = 2.0,
) -> ProgramRun:
    """Run a program as far as its calls are answered.

    It runs as `run_path` runs its code: in another process, without files, network, clock or packages, within bounds on time and memory.

    Args:
        code: Python source.
        functions: Parameters of each function of the host, as they stand in a `def`, by its name.
        answers: To its calls so far, in order: {"value": plain JSON value}, or {"error": text} which is raised as a ValueError.
        unanswered: Functions whose calls are kept and return None at once.
        timeout_s: Longest time for one run [s].

    Raises:
        SandboxError: Anything that went wrong with the program; the text is for its author.
        SandboxUnavailableError: The workers do not run here, not even an empty program.
    """
    if len(code) > MAX_CODE_CHARACTERS:
        raise SandboxError(f"the program has {len(code)} characters; at most {MAX_CODE_CHARACTERS} are run")
    given = [dict(answer) for answer in answers]
    prelude = _PRELUDE.format(mark="\\x1d", most=MAX_CALLS) + "".join(
        f"\n\ndef {name}({parameters}):\n    return _call({name!r}, [{_names(parameters)}])\n"
        for name, parameters in functions.items()
    )
    output = discarded_output()
    failed: list[Any] = []

    def run(interpreter: Any) -> str:
        nonlocal output
        output, failed[:] = discarded_output(), []
        interpreter.feed_run(
            prelude, inputs={"_answers": given, "_unanswered": sorted(unanswered)}, print_callback=discarded_output()
        )
        try:
            interpreter.feed_run(without_value(code), print_callback=output)
        except (pydantic_monty.MontySyntaxError, pydantic_monty.MontyRuntimeError) as error:
            failed.append(error)
        return str(output.output)

    try:
        text = in_worker(run, timeout_s)
    except WorkerLostError as error:
        raise SandboxError(f"the program had to be stopped from outside: {cut(str(error), 200)}") from error
    except pydantic_monty.MontyError as error:
        raise SandboxError(f"the program could not be run: {cut(str(error), 200)}") from error
    try:
        calls, printed = _read(text, functions)
    except SandboxError:
        # What it printed may be cut off in the middle of a call; then the reason is that it printed too much.
        if failed and type(failed[0].exception()).__name__ != "KeyboardInterrupt":
            raise SandboxError(cut(explained(failed[0], code, _AUTHORS_FILE))) from failed[0]
        raise
    asked = [number for number, call in enumerate(calls, start=1) if call.function not in unanswered]
    if len(asked) > len(given):
        return ProgramRun(calls[: asked[len(given)]], printed, waits=True)
    if failed:
        raise SandboxError(cut(explained(failed[0], code, _AUTHORS_FILE))) from failed[0]
    return ProgramRun(calls, printed, waits=False)


def _names(parameters: str) -> str:
    return ", ".join(_parameters(parameters))


def _parameters(parameters: str) -> list[str]:
    return [part.partition("=")[0].strip() for part in parameters.split(",") if part.strip()]


def _read(text: str, functions: Mapping[str, str]) -> tuple[tuple[HostCall, ...], str]:
    """The calls, and what else was printed. A program may print what looks like a call: then it has called."""
    calls, said = list[HostCall](), list[str]()
    for line in text.split("\n"):
        if not line.startswith(_MARK):
            said += [line] if line.strip() else []
            continue
        if len(calls) == MAX_CALLS:
            raise SandboxError(f"the program calls more than {MAX_CALLS} functions")
        calls.append(_call(line[len(_MARK) :], functions, len(calls) + 1))
    return tuple(calls), cut("\n".join(said), MAX_PRINTED_CHARACTERS)


def _call(text: str, functions: Mapping[str, str], number: int) -> HostCall:
    """One call, checked: a program can print any line, whatever its functions would print."""
    try:
        name, arguments = json.loads(text, parse_constant=_no_number)
        plain = _is_plain(arguments)
    except (ValueError, TypeError, RecursionError):
        plain = False
    if not plain:
        raise SandboxError(
            f"call {number} of a function: its values are not plain finite numbers, texts and lists (numbers up to {MAX_NUMBER:g}, texts "
            f"of up to {MAX_TEXT_CHARACTERS} characters, up to {MAX_DEPTH} lists inside each other)"
        )
    if not isinstance(name, str) or name not in functions or not isinstance(arguments, list):
        raise SandboxError(f"call {number} is of no function that there is; valid: {', '.join(functions)}")
    if len(arguments) != len(_parameters(functions[name])):
        raise SandboxError(f"call {number} gives {name}({functions[name]}) {len(arguments)} values")
    return HostCall(name, tuple(arguments))


def _is_plain(value: Any, depth: int = 0) -> bool:
    """Whether a parsed JSON value is within the bounds; a text of half a character cannot be written to a file."""
    match value:
        case None | bool():
            return True
        case int() | float():
            return -MAX_NUMBER <= value <= MAX_NUMBER and math.isfinite(value)
        case str():
            return len(value) <= MAX_TEXT_CHARACTERS and not any("\ud800" <= one <= "\udfff" for one in value)
        case list():
            return depth < MAX_DEPTH and all(_is_plain(one, depth + 1) for one in value)
        case dict():
            return depth < MAX_DEPTH and all(_is_plain(one, depth + 1) for pair in value.items() for one in pair)
    return False


def _no_number(text: str) -> float:
    raise ValueError(f"{text} is no finite number")
