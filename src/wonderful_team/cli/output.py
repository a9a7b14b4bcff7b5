"""What a command prints: a result as text, or one JSON document with a schema version."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import click

SCHEMA_VERSION = 1


@dataclass(frozen=True)
class Document:
    """The one JSON document of a command.

    Attributes:
        command: Which command made it.
        result: What it found; empty when it failed before there was anything.
        error: type, message and stage; None when all went well.
    """

    command: str
    result: Mapping[str, Any]
    error: Mapping[str, Any] | None = None

    def print(self, exit_code: int) -> None:
        """Write it to stdout."""
        held = {
            "schema_version": SCHEMA_VERSION,
            "command": self.command,
            "exit_code": exit_code,
            "result": dict(self.result),
            "error": None if self.error is None else dict(self.error),
        }
        click.echo(json.dumps(held, indent=2, ensure_ascii=False))


def wants_json(argv: Sequence[str]) -> bool:
    """Whether the words of a command line ask for JSON."""
    return "--json" in argv


def finish(command: str, *, text: str, result: Mapping[str, Any], as_json: bool, code: int, last_line: str = "") -> int:
    """Print a result on stdout; the last line (the page) on stderr when stdout is JSON.

    Returns:
        The exit code, for the command to return.
    """
    if as_json:
        Document(command, result).print(code)
    else:
        click.echo(text)
    if last_line:
        click.echo(last_line, err=as_json)
    return code
