"""What a command prints: a result as text, or one JSON document with a schema version."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import click

from wonderful_team.core.text import visible, visible_json
from wonderful_team.redaction import redact, redact_all

SCHEMA_VERSION = 1
WRONG_USE = 2
COLOURS: dict[str, dict[str, Any]] = {
    "INJECTED": {"fg": "yellow", "bold": True},
    "CAUGHT": {"fg": "green", "bold": True},
    "SUCCESS": {"fg": "green", "bold": True},
    "PLAN": {"bold": True},
    "FAILURE": {"fg": "red", "bold": True},
    "ERROR": {"fg": "red", "bold": True},
    "REFUSED": {"fg": "red", "bold": True},
}
"""Colour of a line's first word on a terminal; click leaves colours out elsewhere. NO_COLOR switches them off."""


def print_document(
    command: str, exit_code: int, result: Mapping[str, Any], error: Mapping[str, Any] | None = None
) -> None:
    """Write the one JSON document of a command to stdout.

    Args:
        command: Which command made it.
        exit_code: How it ends.
        result: What it found; empty when it failed before there was anything.
        error: type, message and stage; None when all went well.
    """
    held = {
        "schema_version": SCHEMA_VERSION,
        "command": command,
        "exit_code": exit_code,
        "result": dict(result),
        "error": None if error is None else dict(error),
    }
    click.echo(visible_json(json.dumps(redact_all(held), indent=2, ensure_ascii=False)))


def say(text: str, *, err: bool = False) -> None:
    """Print text of one or several lines: what it holds of hidden characters is shown as escapes."""
    click.echo("\n".join(map(_coloured, visible(redact(text), layout=True).split("\n"))), err=err)


def finish(
    command: str,
    *,
    text: str,
    result: Mapping[str, Any],
    as_json: bool,
    code: int,
    last_line: str = "",
    unwritten: Sequence[str] = (),
) -> int:
    """Print a result on stdout; the last line (the page) on stderr when stdout is JSON.

    Args:
        command: Which one ends.
        text: The result for people.
        result: The result for machines.
        as_json: Which of them is printed.
        code: The exit code; 2 in the place of 0 when something could not be written.
        last_line: Printed after it.
        unwritten: Which files could not be written, and why: the result stands all the same.

    Returns:
        The exit code, for the command to return.
    """
    error = None
    if unwritten:
        code = code or WRONG_USE
        error = {"type": "FileNotWrittenError", "message": "; ".join(unwritten), "stage": None}
    if as_json:
        print_document(command, code, result, error)
    else:
        say(text)
    if last_line:
        say(last_line, err=as_json)
    for why in unwritten:
        say(f"error: {why}", err=True)
    return code


def _coloured(line: str) -> str:
    first, space, rest = line.partition(" ")
    return click.style(first, **COLOURS[first]) + space + rest if first in COLOURS and not no_colour() else line


def no_colour() -> bool:
    """Whether the user wants no colours (https://no-color.org)."""
    return bool(os.environ.get("NO_COLOR"))
