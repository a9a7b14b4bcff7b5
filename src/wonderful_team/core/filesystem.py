"""Files of ours: readable by their owner alone, text without keys; and whether a file lies on a network file system."""

from __future__ import annotations

import errno
import os
from pathlib import Path

from wonderful_team.redaction import redact

_NETWORK = (
    "nfs",
    "cifs",
    "smb",
    "sshfs",
    "lustre",
    "gpfs",
    "beegfs",
    "ceph",
    "glusterfs",
    "afs",
    "9p",
    "davfs",
    "s3fs",
)


def network_file_system(path: Path, mounts: str | None = None) -> str | None:
    """The kind of network file system that a path lies on; None on a local disk, or where the system does not tell.

    Args:
        path: The file, which need not exist yet.
        mounts: Text of /proc/mounts; read from the system if not given.
    """
    if mounts is None:
        try:
            mounts = Path("/proc/mounts").read_text(encoding="utf-8")
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
    return kind if any(name in kind for name in _NETWORK) else None


def make_private_folder(folder: Path) -> None:
    """Make a folder, and those above it, for its owner alone (0700); folders that exist stay as they are."""
    missing = []
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


def write_private(path: Path, content: bytes) -> None:
    """Write a file that is its owner's alone."""
    with open(path, "wb", opener=private) as file:
        file.write(content)


def write_redacted(path: Path, text: str, errors: str = "backslashreplace") -> None:
    """Write text in UTF-8, without any key in it, to a file that is its owner's alone.

    Args:
        path: The file.
        text: Its content.
        errors: What becomes of half a character (a lone surrogate), as in `str.encode`.
    """
    write_private(path, redact(text).encode("utf-8", errors=errors))
