"""Every write of a command fails once: the k-th time that something is opened for writing, written, closed, renamed, made or committed.

`sweep(...)` runs a command once to count those points, then once for each of them with that one failing, and says what gave way. As SQLite is
tested: https://www.sqlite.org/testing.html (I/O error testing).
"""

from __future__ import annotations

import builtins
import contextlib
import errno
import io
import os
import re
import sqlite3
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

CODES = (errno.ENOSPC, errno.EROFS, errno.EACCES, errno.EIO)
"""A full disk, a read-only one, no right to write, a broken one."""
WRITES = ("INSERT", "UPDATE", "DELETE", "BEGIN IMMEDIATE", "COMMIT", "CREATE", "ALTER", "VACUUM", "PRAGMA journal_mode")
"""How statements of SQLite begin that write."""


@dataclass
class Faults:
    """Counts the points at which files under `places` are written to, and lets one of them fail.

    Attributes:
        fail_at: Number of the point that fails, from 1; 0 for none.
        lasting: All that follow fail too, as on a disk that stays full.
        code: What the machine says.
        points: Which there were: what was done to which file.
        failed: The file whose write failed; "" when none has.
    """

    places: Sequence[Path]
    fail_at: int = 0
    lasting: bool = False
    code: int = errno.ENOSPC
    points: list[str] = field(default_factory=list)
    failed: str = ""

    def point(self, what: str, path: object) -> None:
        """One point; raises OSError when it is the one that fails."""
        name = os.fsdecode(path) if isinstance(path, str | bytes | os.PathLike) else ""
        if not name or not any(Path(os.path.abspath(name)).is_relative_to(place) for place in self.places):
            return
        self.points.append(f"{what} {name}")
        number = len(self.points)
        if number == self.fail_at or (self.lasting and 0 < self.fail_at < number):
            self.failed = self.failed or name
            raise OSError(self.code, os.strerror(self.code), name)

    def statement(self, path: Path, text: str) -> None:
        """One statement of SQLite; raises what SQLite raises for the same."""
        if not text.lstrip().upper().startswith(tuple(word.upper() for word in WRITES)):
            return
        try:
            self.point(text.lstrip().split()[0], path)
        except OSError:
            full = self.code == errno.ENOSPC
            raise sqlite3.OperationalError("database or disk is full" if full else "disk I/O error") from None


def _writes(mode: str) -> bool:
    return any(letter in mode for letter in "wax+")


class _Fakes:
    """The functions by which this process writes, with a point in each."""

    def __init__(self, faults: Faults) -> None:
        self.faults = faults
        homes: tuple[tuple[Any, tuple[str, ...]], ...] = (
            (builtins, ("open",)),
            (io, ("open",)),
            (os, ("open", "replace", "rename", "mkdir", "fsync", "symlink", "link", "fchmod")),
            (sqlite3, ("connect",)),
        )
        self.real = {(home, name): getattr(home, name) for home, names in homes for name in names}
        self.fakes: dict[tuple[Any, str], Any] = {
            (builtins, "open"): self.opened,
            (io, "open"): self.opened,
            (os, "open"): self.os_open,
            (os, "mkdir"): self.mkdir,
            (sqlite3, "connect"): self.connect,
            **{(os, name): self.second_named(name) for name in ("replace", "rename", "symlink", "link")},
            **{(os, name): self.by_descriptor(name) for name in ("fsync", "fchmod")},
        }

    def opened(self, file: Any, mode: str = "r", *args: Any, **named: Any) -> Any:
        if isinstance(file, int) or not any(letter in mode for letter in "wax+"):
            return self.real[io, "open"](file, mode, *args, **named)
        self.faults.point("open", file)
        made = self.real[io, "open"](file, mode, *args, **named)
        _watched(made, file, self.faults)
        return made

    def os_open(self, path: Any, flags: int, *args: Any, **named: Any) -> int:
        if flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT):
            self.faults.point("os.open", path)
        return int(self.real[os, "open"](path, flags, *args, **named))

    def mkdir(self, path: Any, *args: Any, **named: Any) -> None:
        if not os.path.isdir(path):
            self.faults.point("mkdir", path)
        self.real[os, "mkdir"](path, *args, **named)

    def second_named(self, name: str) -> Callable[..., Any]:
        def called(first: Any, second: Any, *args: Any, **named: Any) -> Any:
            self.faults.point(name, second)
            return self.real[os, name](first, second, *args, **named)

        return called

    def by_descriptor(self, name: str) -> Callable[..., Any]:
        def called(number: int, *args: Any) -> Any:
            self.faults.point(name, os.readlink(f"/proc/self/fd/{number}"))
            return self.real[os, name](number, *args)

        return called

    def connect(self, path: Any, *args: Any, **named: Any) -> sqlite3.Connection:
        faults = self.faults

        class Watched(sqlite3.Connection):
            def execute(self, text: str, *values: Any) -> sqlite3.Cursor:
                faults.statement(Path(path), text)
                return super().execute(text, *values)

            def executemany(self, text: str, *values: Any) -> sqlite3.Cursor:
                faults.statement(Path(path), text)
                return super().executemany(text, *values)

        try:
            faults.point("connect", path)
        except OSError:
            raise sqlite3.OperationalError("unable to open database file") from None
        return self.real[sqlite3, "connect"](path, *args, factory=Watched, **named)  # type: ignore[no-any-return]


@contextlib.contextmanager
def injected(faults: Faults) -> Iterator[Faults]:
    """Within it this process's writes are counted, and one fails."""
    made = _Fakes(faults)
    try:
        for (home, name), fake in made.fakes.items():
            setattr(home, name, fake)
        yield faults
    finally:
        for (home, name), one in made.real.items():
            setattr(home, name, one)


def _watched(made: Any, path: Any, faults: Faults) -> None:
    """Writing to a file fails half-way, and closing it may fail too: then what was buffered is lost."""
    write, close = made.write, made.close

    def failing_write(content: Any) -> Any:
        try:
            faults.point("write", path)
        except OSError:
            write(content[: len(content) // 2])
            raise
        return write(content)

    def failing_close() -> None:
        if made.closed:
            return
        try:
            faults.point("close", path)
        except OSError:
            close()
            if "a" not in made.mode:  # what stood there before is not touched by adding to it
                with contextlib.suppress(OSError):
                    os.truncate(path, os.path.getsize(path) // 2)
            raise
        close()

    # Python's files take attributes of their own, and `with` closes them by this one.
    made.write, made.close = failing_write, failing_close


@dataclass(frozen=True)
class Outcome:
    """What a command did while one of its writes failed.

    Attributes:
        point: Which write failed, from 1, and what it was.
        code: The exit code.
        wrong: What should not be; empty when all is well.
    """

    point: str
    code: int
    wrong: tuple[str, ...]


@dataclass(frozen=True)
class Ended:
    """How one run of a command ended."""

    code: int
    out: str
    err: str
    faults: Faults
    folder: Path


Command = Callable[[Path, Faults], "tuple[int, str, str]"]
"""Runs a command whose files all lie in the folder, within `injected`; returns exit code, stdout and stderr."""
Check = Callable[[Ended], "list[str]"]

DOCUMENTED = frozenset({0, 1, 2, 3, 4, 5, 6, 7})


def sweep(
    command: Command,
    folders: Callable[[], Path],
    check: Check,
    *,
    every: int = 1,
    first: int = 1,
    lasting: bool = False,
) -> tuple[int, list[Outcome]]:
    """Fail the write points of a command one after the other.

    Args:
        command: What is run.
        folders: Makes a new, empty folder for each run.
        check: Finds what is wrong with a run, beyond what holds for all commands.
        every: Take every n-th point.
        first: The first point taken.
        lasting: All writes after it fail too.

    Returns:
        How many points there are, and what came of those taken.
    """
    place = folders()
    faults = Faults([place])
    command(place, faults)
    count = len(faults.points)
    outcomes = []
    for number in range(first, count + 1, every):
        place = folders()
        faults = Faults([place], number, lasting, CODES[number % len(CODES)])
        code, out, err = command(place, faults)
        wrong = problems(Ended(code, out, err, faults, place)) + check(Ended(code, out, err, faults, place))
        what = faults.points[number - 1] if len(faults.points) >= number else "not reached"
        outcomes.append(Outcome(f"{number} {what}", code, tuple(wrong)))
    return count, outcomes


def problems(ended: Ended) -> list[str]:
    """What is wrong with any command whose write failed."""
    found = []
    if ended.code not in DOCUMENTED:
        found.append(f"exit code {ended.code} is not documented")
    if "Traceback" in ended.out + ended.err:
        found.append("a traceback")
    if "defect of wonderful-team" in ended.err:
        found.append("called a defect")
    parts = [path for path in ended.folder.rglob(".*.part")]
    if parts and not ended.faults.lasting:
        found.append(f"left behind: {parts[0].name}")
    return found


def names_the_file(ended: Ended) -> bool:
    """Whether what was printed names the file that could not be written, or the folder or store that it belongs to."""
    path = Path(ended.faults.failed)
    told = (ended.out + ended.err).replace("\\\\", "\\")
    # A file is written beside its place first: `.NAME.PID.part`, or `.latest-PID` for the link.
    name = re.sub(r"^\.(.*?)(?:\.\d+\.part|-\d+)$", r"\1", path.name)
    return name in told
