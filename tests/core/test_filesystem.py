"""One answer to "does this file lie on a network file system", for the cache and for a study's store."""

from __future__ import annotations

from pathlib import Path

import pytest

from wonderful_team.core.filesystem import network_file_system

MOUNTS = "/dev/sda1 / ext4 rw 0 0\nserver:/home /mnt/home {kind} rw 0 0\n/dev/sdb1 /mnt/home/fast\\040disk xfs rw 0 0\n"


@pytest.mark.parametrize(
    "kind",
    "nfs nfs3 nfs4 cifs smb3 smbfs 9p afs ceph fuse.ceph fuse.sshfs fuse.s3fs fuse.rclone glusterfs fuse.glusterfs lustre gpfs "
    "beegfs virtiofs vboxsf davfs".split(),
)
def test_network_file_systems_are_told(kind: str) -> None:
    mounts = MOUNTS.format(kind=kind)
    assert network_file_system(Path("/mnt/home/me/s.db"), mounts) == kind
    assert network_file_system(Path("/mnt/home/fast disk/s.db"), mounts) is None, "the nearest mount decides"
    assert network_file_system(Path("/tmp/s.db"), mounts) is None


@pytest.mark.parametrize(
    "kind", "ext4 xfs btrfs tmpfs overlay zfs apfs fuse.portal fuseblk ntfs3 tracefs cgroup2".split()
)
def test_local_ones_are_not(kind: str) -> None:
    assert network_file_system(Path("/mnt/home/me/s.db"), MOUNTS.format(kind=kind)) is None


def test_a_system_that_does_not_tell_counts_as_local() -> None:
    assert network_file_system(Path("/mnt/home/me/s.db"), "nonsense\n\n") is None
