"""The progress line: one line on stderr for each stage, with the time since the start, and the cost at the end."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import click

from wonderful_team.interfaces import Event
from wonderful_team.types import Usage

NAME_WIDTH = 12


class Named(Protocol):
    """What knows its name and its model's."""

    @property
    def name(self) -> str: ...

    @property
    def model_name(self) -> str: ...


def _to_stderr(line: str) -> None:
    """A terminal that is gone is no reason to leave a robot where it is: signals say what to do."""
    with contextlib.suppress(OSError):
        click.echo(line, err=True)


class Progress:
    """Prints what happens while it happens.

    Args:
        write: Takes one line.
        clock: Seconds; its first reading is the start.

    Attributes:
        kept: How many answers came from the cache.
    """

    def __init__(
        self,
        write: Callable[[str], None] = lambda line: _to_stderr(line),
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._write, self._clock, self._start = write, clock, clock()
        self.kept = 0

    @property
    def seconds(self) -> float:
        """Since the start."""
        return self._clock() - self._start

    def header(self, team: Named) -> None:
        """Say which model and method are at work."""
        self._write(f"model {team.model_name}   method {team.name}")

    def note(self, text: str) -> None:
        """A line without a time."""
        self._write(text)

    def on_event(self, event: Event) -> None:
        """Print a line for the events that a person waits for."""
        match event.kind:
            case "stage":
                self.line(event.name, _text(event.content))
            case "gate":
                count = len(event.content.checks)
                said = f"admitted ({count} checks)" if event.content.admitted else "refused:"
                self.line("gate", f"{event.name}: {said}")
                for reason in event.content.reasons:
                    self._write(f"{'':9}{'':<{NAME_WIDTH}} {reason}")
            case "execute":
                planned, report = event.content
                self.line(
                    "execute",
                    f"action {event.name} {planned.step.kind}: " + ("ran" if report.executed else f"{report.fault}"),
                )
            case "warning":
                self.line("warning", str(event.content))
            case "answer":
                self.kept += event.content[1].provenance == "cached"

    def line(self, name: str, text: str) -> None:
        """One line: time, name, text."""
        self._write(f"{self.seconds:5.1f} s  {name:<{NAME_WIDTH}} {text}")


def cost_line(usage: Usage, seconds: float, kept: int = 0) -> str:
    """What it cost, in one line; `kept` answers came from the cache and cost nothing."""
    parts = [f"{usage.calls} call{'s' if usage.calls != 1 else ''}", f"{usage.pictures} pictures"]
    parts.append(f"{usage.tokens:,} tokens")
    parts.append("cost unknown (no price for this model)" if usage.usd is None else f"{usage.usd:.4f} USD")
    if kept:
        parts.append(f"{kept} answer{'s' * (kept != 1)} from the cache")
    return ", ".join([*parts, f"{seconds:.1f} s"])


def _text(content: Any) -> str:
    return str(content.get("text", "")) if isinstance(content, Mapping) else str(content)
