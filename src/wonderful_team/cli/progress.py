"""The progress line: one line on stderr for each stage, with the time since the start, and the cost at the end."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import click

from wonderful_team.cli.live_line import LiveLine, moves
from wonderful_team.cli.output import say
from wonderful_team.core.protocols import Event
from wonderful_team.core.text import counted, picture_names, spoken, visible
from wonderful_team.core.values import Instruction, Usage

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
        say(line, err=True)


class ProgressLine:
    """Prints what happens while it happens; on a terminal a last line moves while models think.

    Args:
        write: Takes one line.
        clock: Seconds; its first reading is the start.
        live: Whether a line may move at all; it never does where stderr is no terminal.

    Attributes:
        kept: How many answers came from the cache.
    """

    def __init__(
        self,
        write: Callable[[str], None] = lambda line: _to_stderr(line),
        clock: Callable[[], float] = time.monotonic,
        *,
        live: bool = True,
    ) -> None:
        self._out, self._clock, self._start = write, clock, clock()
        self.kept = 0
        self._pictures: dict[str, str] = {}
        self._live = LiveLine(sys.stderr, clock) if live and moves(sys.stderr) else None
        context = click.get_current_context(silent=True)
        if context is not None:
            # Also when the command ends with an error or with Ctrl-C.
            context.call_on_close(self.close)

    def close(self) -> None:
        """Let the line that moves go away."""
        if self._live is not None:
            self._live.close()

    def end(self, usage: Usage) -> None:
        """The last line of progress: what it cost."""
        self.close()
        self._write(cost_line(usage, self.seconds, self.kept))

    def _write(self, line: str) -> None:
        if self._live is not None:
            self._live.pause()
        self._out(visible(spoken(line, self._pictures)))

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

    def task(self, scene: str, instruction: Instruction) -> None:
        """Say what is to be done; from here on pictures are called by their number."""
        self._pictures = picture_names(instruction.text, instruction.slots)
        self._write(f"{scene}: {instruction.text}")

    def on_event(self, event: Event) -> None:
        """Print a line for the events that a person waits for."""
        if self._live is not None:
            self._live.on_event(event)
        match event.kind:
            case "run" if isinstance(task := (event.content or {}).get("task"), Instruction):
                self._pictures = picture_names(task.text, task.slots)
            case "stage":
                self.line(event.name, _text(event.content))
            case "gate":
                checks = counted(len(event.content.checks), "check")
                self.line(
                    "gate", f"{event.name}: " + (f"admitted ({checks})" if event.content.admitted else "refused:")
                )
                for reason in event.content.reasons:
                    self._write(f"{'':9}{'':<{NAME_WIDTH}} {reason}")
            case "execute":
                planned, report = event.content
                self.line(
                    "execute",
                    f"action {event.name} {planned.step.kind}: " + report.words,
                )
            case "warning":
                self.line("warning", str(event.content))
            case "crash":
                for line in trace_lines(event.content.trace):
                    self._write(f"    {line}")
            case "answer":
                self.kept += event.content[1].provenance == "cached"

    def line(self, name: str, text: str) -> None:
        """One line: time, name, text."""
        self._write(f"{self.seconds:5.1f} s  {name:<{NAME_WIDTH}} {text}")


TRACE_LINES = 6


def trace_lines(trace: str) -> list[str]:
    """The end of a traceback: where it was raised, and what."""
    lines = trace.rstrip().splitlines()
    return (
        lines
        if len(lines) <= TRACE_LINES
        else [f"… {len(lines) - TRACE_LINES} lines more in log.txt", *lines[-TRACE_LINES:]]
    )


def cost_line(usage: Usage, seconds: float, kept: int = 0) -> str:
    """What it cost, in one line; `kept` answers came from the cache and cost nothing."""
    parts = [counted(usage.calls, "call"), counted(usage.pictures, "picture"), counted(usage.tokens, "token")]
    parts.append("cost unknown (no price for this model)" if usage.usd is None else f"{usage.usd:.4f} USD")
    if kept:
        parts.append(f"{counted(kept, 'answer')} from the cache")
    return ", ".join([*parts, f"{seconds:.1f} s"])


def _text(content: Any) -> str:
    return str(content.get("text", "")) if isinstance(content, Mapping) else str(content)
