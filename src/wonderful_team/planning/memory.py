"""Notebooks of the roles and the system memory of one trial, both deterministic.

System memory updates run beside the main line. They become visible only at stage borders and in order of stage and
target, never of finishing, so that requests do not depend on races.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any

from wonderful_team.contracts import MemoryEntry
from wonderful_team.core.values import Note

NOTEBOOK_LINES = 12
"""Most lines of a notebook that a request carries: the newest ones."""
REPLACED = frozenset({"WriteSteps"})
"""Questions of which only the newest answer counts: steps written anew take the place of those before."""
JUDGES_ATTEMPTS = "replanner"
"""The role whose notes are about attempts, not about one picture."""


class Notebooks:
    """One notebook per role. Work on one target writes to a branch, which only that target's requests see."""

    def __init__(self) -> None:
        self._lines: dict[tuple[str, str], list[Note | None]] = {}

    def begin(self, role: str, branch: str) -> Callable[[Note | None], None]:
        """Take the next line; what comes back writes it, or leaves it empty.

        Lines so stand in the order of asking, never of finishing.
        """
        lines = self._lines.setdefault((role, branch), [])
        lines.append(None)
        number = len(lines) - 1

        def write(note: Note | None) -> None:
            lines[number] = note

        return write

    def forget(self, branch: str) -> None:
        """Drop what all roles noted while they worked on one target: it is settled, and what was tried is stale."""
        for key in [key for key in self._lines if key[1] == branch]:
            del self._lines[key]

    def begin_plan(self) -> None:
        """Drop what was noted of single targets: a new plan numbers its targets anew."""
        for branch in {branch for _, branch in self._lines if branch}:
            self.forget(branch)

    def begin_attempt(self) -> None:
        """Drop all that was noted of an earlier picture; who judges attempts goes on knowing them.

        What has to outlive the picture is what the Memory agent keeps.
        """
        for key in [key for key in self._lines if key[0] != JUDGES_ATTEMPTS]:
            del self._lines[key]

    def read(self, role: str, branch: str) -> tuple[Note, ...]:
        """The role's own lines on the main line, then those of this branch; the newest NOTEBOOK_LINES of them."""
        lines = [*self._lines.get((role, ""), ())]
        if branch:
            lines += self._lines.get((role, branch), ())
        written = [line for line in lines if line is not None]
        newest = {line.key: line for line in written}
        standing = [line for line in written if line.key not in REPLACED or line is newest[line.key]]
        return tuple(standing[-NOTEBOOK_LINES:])


class SystemMemory:
    """What the Memory agent chose to keep."""

    def __init__(self) -> None:
        self._visible: list[Note] = []
        self._pending: list[tuple[tuple[int, int], asyncio.Task[MemoryEntry | None]]] = []

    def submit(self, order: tuple[int, int], job: Coroutine[Any, Any, MemoryEntry | None]) -> None:
        """Start an update; `order` is (stage, target) and decides where its entry will stand."""
        self._pending.append((order, asyncio.ensure_future(job)))

    async def barrier(self) -> None:
        """Wait for all updates under way and make their entries visible, in order."""
        pending, self._pending = sorted(self._pending, key=lambda item: item[0]), []
        try:
            entries = await asyncio.gather(*(task for _, task in pending))
        except BaseException:
            for _, task in pending:
                task.cancel()
            await asyncio.gather(*(task for _, task in pending), return_exceptions=True)
            raise
        for entry in entries:
            if entry is not None and entry.keep:
                self._visible = [note for note in self._visible if note.key != entry.key]
                self._visible.append(Note(entry.key, entry.summary, "memory"))

    async def cancel(self) -> None:
        """Drop updates under way."""
        pending, self._pending = self._pending, []
        for _, task in pending:
            task.cancel()
        await asyncio.gather(*(task for _, task in pending), return_exceptions=True)

    @property
    def notes(self) -> tuple[Note, ...]:
        return tuple(self._visible)

    @property
    def keys(self) -> tuple[str, ...]:
        return tuple(note.key for note in self._visible)
