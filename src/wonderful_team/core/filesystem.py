"""Where a file lies: local disk or network file system."""

from __future__ import annotations

from pathlib import Path

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
