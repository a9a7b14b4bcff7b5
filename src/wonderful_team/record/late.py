"""A record of a run that is kept only where the run did not succeed: what happened waits in memory until that is known."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Hashable, Iterator, Mapping
from pathlib import Path
from typing import Any

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.interrupts import held
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import LaterPicture, LaterView, Observation, Request, SentPicture, Trial
from wonderful_team.errors import FileNotWrittenError
from wonderful_team.record.recorder import Recorder

MOST_BYTES = 100_000_000
"""Pictures that wait in a process, in bytes. A run that would make them more is written down from then on."""

DRAWN_BYTES = 7
"""Of each pixel of a picture that is drawn later: three colours and its depth."""


class Waiting:
    """How many bytes of pictures wait, over all runs of a process."""

    def __init__(self, most_bytes: int) -> None:
        self.bytes, self._most = 0, most_bytes
        self._lock = threading.Lock()

    def take(self, count: int) -> bool:
        """Whether there is room for so many bytes; they are then counted."""
        with self._lock:
            if self.bytes + count > self._most:
                return False
            self.bytes += count
            return True

    def give_back(self, count: int) -> None:
        with self._lock:
            self.bytes -= count


_WAITING = Waiting(MOST_BYTES)


class LateRecorder:
    """A subscriber that makes a run folder once a run turns out not to have succeeded, as if it had been there all along.

    What a killed process leaves of such a run is nothing: a study runs it again.

    Args:
        begin: Makes the folder and its recorder, which is told the time by a clock.
        waiting: Counts what waits.
    """

    def __init__(self, begin: Callable[[Callable[[], float]], Recorder], waiting: Waiting = _WAITING) -> None:
        self._begin, self._waiting = begin, waiting
        self._events: list[tuple[float, Event]] = []
        self._sizes: dict[Hashable, int] = {}
        self._lock = threading.RLock()
        self._at_s: float | None = time.monotonic()
        self._last: Event | None = None
        self._warnings: dict[str, None] = {}
        self._recorder: Recorder | None = None
        self._lost: tuple[str, ...] = ()

    def on_event(self, event: Event) -> None:
        """Keep one event, in memory while there is room."""
        with held(), self._lock:
            self._last = event
            if event.kind == "warning":
                self._warnings[str(event.content)] = None
            if self._recorder is not None:
                self._recorder.on_event(event)
            elif not self._lost:
                self._events.append((time.monotonic(), event))
                # What an event holds lives as long as the event waits: its id is not given to another.
                fresh = {one: size for one, size in _held_by(event.content) if one not in self._sizes}
                if self._waiting.take(sum(fresh.values())):
                    self._sizes |= fresh
                else:
                    self.write()

    @property
    def ended(self) -> bool:
        """Whether the run's end was told."""
        return self._last is not None and self._last.kind == "done"

    @property
    def folder(self) -> Path | None:
        """The run folder; None as long as there is none."""
        return None if self._recorder is None else self._recorder.folder

    @property
    def warnings(self) -> tuple[str, ...]:
        """Every warning that was told so far, each once."""
        return tuple(self._warnings)

    @property
    def unwritten(self) -> tuple[str, ...]:
        """What of the run could not be written, and why."""
        return self._lost if self._recorder is None else self._recorder.unwritten

    def write(self) -> None:
        """Make the folder and tell its recorder all that happened so far. Without room for a folder the run itself goes on."""
        with held(), self._lock:
            if self._recorder is not None or self._lost:
                return
            try:
                recorder = self._begin(self._time_s)
                for at_s, event in self._events:
                    self._at_s = at_s
                    recorder.on_event(event)
                self._recorder = recorder
            except FileNotWrittenError as error:
                self._lost = (str(error),)
            finally:
                self._at_s = None
                self._forget()

    @property
    def recorder(self) -> Recorder | None:
        """What writes the run; None as long as nothing of it is written."""
        return self._recorder

    def close(self) -> None:
        """Write the run down unless it succeeded."""
        with held(), self._lock:
            ended = self._last.content if self._last is not None and self.ended else None
            if not (isinstance(ended, Trial) and ended.outcome == "success"):
                self.write()
            self._forget()
            if self._recorder is not None:
                self._recorder.close()

    def _forget(self) -> None:
        self._waiting.give_back(sum(self._sizes.values()))
        self._events, self._sizes = [], {}

    def _time_s(self) -> float:
        """When the event happened that is being written."""
        return time.monotonic() if self._at_s is None else self._at_s


def _held_by(content: Any) -> Iterator[tuple[Hashable, int]]:
    """The pictures and files that an event holds on to, and their bytes: what is still to be drawn counts as it will then, and is not drawn for that."""
    match content:
        case Observation():
            for view in content.views.values():
                if isinstance(view, LaterView):
                    yield id(view), DRAWN_BYTES * math.prod(view.size_px)
                else:
                    yield from _pixels(view.rgb, view.depth_m)
        case Request():
            for picture in content.pictures:
                if isinstance(picture, LaterPicture):
                    yield _cut(picture), DRAWN_BYTES * math.prod(picture.size_px)
                else:
                    yield from _pixels(picture.rgb, picture.depth_m)
        case SentPicture():
            yield id(content.file), len(content.file)
            yield from _pixels(content.rgb)
        case tuple() | list():
            for part in content:
                yield from _held_by(part)
        case Mapping():
            for part in content.values():
                yield from _held_by(part)


def _cut(picture: LaterPicture) -> Hashable:
    """The same for all pictures of one window of a view, which share their pixels."""
    if picture.source is None:
        return id(picture)
    return id(picture.source), picture.frame.T_view_picture.tobytes(), picture.size_px


def _pixels(*arrays: Array | None) -> Iterator[tuple[Hashable, int]]:
    yield from ((id(array), array.nbytes) for array in arrays if array is not None)
