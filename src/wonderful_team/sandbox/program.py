"""run_program: run a model's program that calls functions of the host, without a value or a call that leaves the worker.

A function that is called prints what it was called with, as a line of text, and takes its answer from a list that the program was
started with. Where the list has no answer yet, the program is stopped; its caller finds the answer and runs it again from the start. Programs
are small, and get the same clock and the same random numbers each time, so they ask the same again.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pydantic_monty

from wonderful_team.sandbox.errors import SandboxError
from wonderful_team.sandbox.explained import explained
from wonderful_team.sandbox.returned import cut
from wonderful_team.sandbox.run import MAX_CODE_CHARACTERS
from wonderful_team.sandbox.worker import WorkerLostError, discarded_output, in_worker

MAX_CALLS = 100
"""Most calls of host functions in one program."""
MAX_PRINTED_CHARACTERS = 4_000
"""Most of what a program prints that goes back to its author; the Trajectory Generators pass on at most 2,000."""
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
        arguments: Plain JSON values, as untrusted as the program.
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
    failed: list[Exception] = []

    def run(interpreter: Any) -> str:
        nonlocal output
        output, failed[:] = discarded_output(), []
        interpreter.feed_run(
            prelude, inputs={"_answers": given, "_unanswered": sorted(unanswered)}, print_callback=discarded_output()
        )
        try:
            interpreter.feed_run(code, print_callback=output)
        except (pydantic_monty.MontySyntaxError, pydantic_monty.MontyRuntimeError) as error:
            failed.append(error)
        return str(output.output)

    try:
        text = in_worker(run, timeout_s)
    except WorkerLostError as error:
        raise SandboxError(f"the program had to be stopped from outside: {cut(str(error), 200)}") from error
    except pydantic_monty.MontyError as error:
        raise SandboxError(f"the program could not be run: {cut(str(error), 200)}") from error
    calls, printed = _read(text, functions)
    if len(calls) > MAX_CALLS:
        raise SandboxError(f"the program calls more than {MAX_CALLS} functions")
    asked = [number for number, call in enumerate(calls, start=1) if call.function not in unanswered]
    if len(asked) > len(given):
        return ProgramRun(calls[: asked[len(given)]], printed, waits=True)
    if failed:
        raise SandboxError(cut(explained(failed[0], code, _AUTHORS_FILE))) from failed[0]
    return ProgramRun(calls, printed, waits=False)


def _names(parameters: str) -> str:
    return ", ".join(part.partition("=")[0].strip() for part in parameters.split(",") if part.strip())


def _read(text: str, functions: Mapping[str, str]) -> tuple[tuple[HostCall, ...], str]:
    """The calls, and what else was printed. A program may print what looks like a call: then it has called."""
    calls, said = list[HostCall](), list[str]()
    for line in text.split("\n"):
        if not line.startswith(_MARK):
            said += [line] if line.strip() else []
            continue
        try:
            name, arguments = json.loads(line[len(_MARK) :], parse_constant=_no_number)
        except (ValueError, TypeError, RecursionError):
            raise SandboxError(
                f"call {len(calls) + 1} of a function: its values are not plain finite numbers, texts and lists"
            ) from None
        if not isinstance(name, str) or name not in functions or not isinstance(arguments, list):
            raise SandboxError(f"call {len(calls) + 1} is of no function that there is; valid: {', '.join(functions)}")
        calls.append(HostCall(name, tuple(arguments)))
    return tuple(calls), cut("\n".join(said), MAX_PRINTED_CHARACTERS)


def _no_number(text: str) -> float:
    raise ValueError(f"{text} is no finite number")
