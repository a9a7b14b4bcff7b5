"""The files of one run folder. A run may have cost money and moved a robot: a file that cannot be written never ends it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path

from wonderful_team.core.filesystem import append_private, make_private_folder, write_private
from wonderful_team.errors import FileNotWrittenError


class RunFiles:
    """Writes into a run folder; what cannot be written is kept in memory, and tried once more at the end.

    Raises:
        FileNotWrittenError: The folder cannot be made.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._waiting: dict[str, bytes] = {}
        self._lines: dict[str, str] = {}
        self._why: dict[str, str] = {}
        make_private_folder(folder)

    @property
    def unwritten(self) -> tuple[str, ...]:
        """What of the run is not on disk, and why: one sentence for each file."""
        return tuple(self._why.values())

    @property
    def missing(self) -> tuple[str, ...]:
        """The files that are not on disk as they should be, relative to the folder."""
        return tuple(self._why)

    def write(self, name: str, content: bytes) -> bool:
        """Write a file, now or at the end; whether it is written."""
        self._waiting.pop(name, None)
        written = self.attempt(name, lambda: write_private(self.folder / name, content))
        if not written:
            self._waiting[name] = content
        return written

    def append(self, name: str, text: str) -> None:
        """Add to a file; once that failed, all that follows waits with it, in its order."""
        text = self._lines.pop(name, "") + text
        if not self.attempt(name, lambda: append_private(self.folder / name, text)):
            self._lines[name] = text

    def remove(self, name: str) -> None:
        """Want a file no longer: nothing of it waits or is missing. One that cannot be deleted stays."""
        self._lines.pop(name, None)
        self._why.pop(name, None)
        with contextlib.suppress(OSError):
            (self.folder / name).unlink(missing_ok=True)

    def attempt(self, name: str, write: Callable[[], object]) -> bool:
        """Whether something could be written; if not, the reason is kept."""
        try:
            write()
        except FileNotWrittenError as error:
            self._why[name] = str(error)
            return False
        self._why.pop(name, None)
        return True

    def failed(self, error: FileNotWrittenError) -> None:
        """Keep why a file could not be written that somebody else writes."""
        self._why[error.path.name] = str(error)

    def try_again(self) -> None:
        """Write what waits: a disk may have room again."""
        for name, content in list(self._waiting.items()):
            self.write(name, content)
        for name in list(self._lines):
            self.append(name, "")
