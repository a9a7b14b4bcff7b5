"""Files of ours: readable by their owner alone, text without keys; and whether a file lies on a network file system."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
from collections.abc import Callable, Iterator
from pathlib import Path

from wonderful_team.errors import FileNotWrittenError
from wonderful_team.redaction import redact

_NETWORK = frozenset(
    "9p afs afpfs beegfs ceph cifs davfs gcsfuse glusterfs gpfs lustre ncpfs nfs orangefs rclone s3fs smb smbfs sshfs vboxsf "
    "virtiofs".split()
)
"""Types of mount, without `fuse.` before and a version after, on which SQLite's locks and shared memory cannot be relied on."""


def network_file_system(path: Path, mounts: str | None = None) -> str | None:
    """The kind of network file system that a path lies on; None on a local disk, or where the system does not tell.

    Args:
        path: The file, which need not exist yet.
        mounts: Text of /proc/mounts; read from the system if not given.
    """
    if mounts is None:
        try:
            mounts = Path("/proc/mounts").read_text(encoding="utf-8", errors="replace")
        except OSError:
            return None
    place = path.absolute().resolve()
    best, kind = -1, ""
    for line in mounts.splitlines():
        words = line.split()
        if len(words) < 3:
            continue
        point = Path(words[1].replace("\\040", " "))
        if place.is_relative_to(point) and len(point.parts) >= best:
            best, kind = len(point.parts), words[2]
    return kind if kind.removeprefix("fuse.").rstrip("0123456789") in _NETWORK else None


@contextlib.contextmanager
def writing(path: Path, hint: str = "") -> Iterator[None]:
    """Whatever the machine says while something is written becomes one error that names the file.

    Args:
        path: The file or folder.
        hint: What the user can do.

    Raises:
        FileNotWrittenError: It cannot be written.
    """
    try:
        yield
    except OSError as error:
        raise FileNotWrittenError(path, error, hint) from error


def make_private_folder(folder: Path, hint: str = "") -> None:
    """Make a folder, and those above it, for its owner alone (0700); folders that exist stay as they are.

    Raises:
        FileNotWrittenError: It cannot be made.
    """
    wanted, missing = folder, []
    with writing(wanted, hint):
        while not folder.exists():
            missing.append(folder)
            folder = folder.parent
        for folder in reversed(missing):
            folder.mkdir(mode=0o700, exist_ok=True)
        if not folder.is_dir():
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))


def private(path: str, flags: int) -> int:
    """For `open(…, opener=private)`: a file that is made is its owner's alone (0600); one that exists keeps its mode."""
    return os.open(path, flags, 0o600)


def write_private(path: Path, content: bytes, hint: str = "") -> None:
    """Write a file that is its owner's alone, all of it or nothing: a reader finds the old or the new content, never half of it.

    Raises:
        FileNotWrittenError: It cannot be written; what stood there stands.
    """
    with writing(path, hint):
        _replace(path, content, private)


def _replace(path: Path, content: bytes, opener: Callable[[str, int], int] | None) -> None:
    # A link stays one, and what is no file (a terminal, a pipe) is written to as it is.
    place = path.resolve() if path.is_symlink() else path
    mode = place.stat().st_mode if place.exists() else None
    if mode is not None and not stat.S_ISREG(mode):
        with open(place, "wb") as stream:
            stream.write(content)
        return
    part = place.with_name(f".{place.name[:100]}.{os.getpid()}.part")
    try:
        with open(part, "wb", opener=opener) as file:
            if mode is not None:
                os.fchmod(file.fileno(), mode & 0o777)
            file.write(content)
        os.replace(part, place)
    except BaseException:
        with contextlib.suppress(OSError):
            part.unlink()
        raise


def write_public(path: Path, text: str, hint: str = "") -> None:
    """Write a text file of the user's own, such as a template: with the rights that new files have here.

    Raises:
        FileNotWrittenError: It, or a folder above it, cannot be written.
    """
    with writing(path, hint):
        path.parent.mkdir(parents=True, exist_ok=True)
        _replace(path, text.encode("utf-8"), None)


def append_private(path: Path, text: str) -> None:
    """Add lines to a file that is its owner's alone.

    Raises:
        FileNotWrittenError: They cannot be added.
    """
    with writing(path), open(path, "a", encoding="utf-8", errors="backslashreplace", opener=private) as file:
        file.write(text)


def write_redacted(path: Path, text: str, errors: str = "backslashreplace", hint: str = "") -> None:
    """Write text in UTF-8, without any key in it, to a file that is its owner's alone.

    Args:
        path: The file.
        text: Its content.
        errors: What becomes of half a character (a lone surrogate), as in `str.encode`.
        hint: What the user can do when it cannot be written.

    Raises:
        FileNotWrittenError: It cannot be written; what stood there stands.
    """
    write_private(path, redact(text).encode("utf-8", errors=errors), hint)
