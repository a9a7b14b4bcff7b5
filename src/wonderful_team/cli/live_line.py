"""A line on a terminal that moves while models think: who is asked, and for how long already."""

from __future__ import annotations

import os
import shutil
import threading
import time
from collections.abc import Callable
from typing import TextIO

import click

from wonderful_team.core.protocols import Event
from wonderful_team.core.text import visible

FRAMES = "⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏"
EVERY_S = 0.12
CLEAR = "\r\x1b[K"
_ENDS = frozenset({"answer", "invalid", "failed"})


def moves(stream: TextIO) -> bool:
    """Whether a stream is a terminal on which a line can be written again."""
    return stream.isatty() and os.environ.get("TERM", "") not in ("", "dumb")


class LiveLine:
    """Shows which roles have been asked and for how long; gone as soon as nobody thinks or it is closed.

    Args:
        stream: A terminal; nothing else may write on it between `pause` and the next event.
        clock: Seconds.
    """

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic) -> None:
        self._stream, self._clock = stream, clock
        self._lock = threading.Lock()
        self._asked: dict[tuple[str, int], tuple[str, float]] = {}
        self._shown, self._ticks = False, 0
        self._closed = threading.Event()
        self._thread: threading.Thread | None = None

    def on_event(self, event: Event) -> None:
        """Follow who is thinking."""
        if event.kind == "request":
            request = event.content
            with self._lock:
                self._asked[request.id, request.sample] = (request.role, self._clock())
            self._start()
        elif event.kind in _ENDS:
            request = event.content[0]
            with self._lock:
                self._asked.pop((request.id, request.sample), None)
                if not self._asked:
                    self._clear()
        elif event.kind == "done":
            self.close()

    def pause(self) -> None:
        """Clear the line, so that another can be written."""
        with self._lock:
            self._clear()

    def close(self) -> None:
        """Clear the line and stop; safe to call twice."""
        self._closed.set()
        with self._lock:
            self._asked.clear()
            self._clear()
        if self._thread is not None:
            self._thread.join(timeout=1.0)

    def text(self) -> str:
        """Who thinks, since when; "" when nobody does."""
        if not self._asked:
            return ""
        roles = list(dict.fromkeys(role for role, _ in self._asked.values()))
        seconds = self._clock() - min(since for _, since in self._asked.values())
        return f"{FRAMES[self._ticks % len(FRAMES)]} {', '.join(roles)} thinking, {seconds:.1f} s"

    def _start(self) -> None:
        if self._thread is None and not self._closed.is_set():
            # A daemon: whatever ends the program, nobody waits for a line on a screen.
            self._thread = threading.Thread(target=self._run, name="live line", daemon=True)
            self._thread.start()

    def _run(self) -> None:
        while not self._closed.wait(EVERY_S):
            with self._lock:
                self._draw()

    def _draw(self) -> None:
        text = self.text()
        if not text or self._closed.is_set():
            return
        self._ticks += 1
        # Cut to the width, so that it never wraps; some terminals say 0 columns.
        width = shutil.get_terminal_size().columns
        self._write(CLEAR + click.style(visible(text)[: width - 1], dim=True))
        self._shown = True

    def _clear(self) -> None:
        if self._shown:
            self._write(CLEAR)
            self._shown = False

    def _write(self, text: str) -> None:
        try:
            self._stream.write(text)
            self._stream.flush()
        except (OSError, ValueError):  # the terminal went away
            self._closed.set()
