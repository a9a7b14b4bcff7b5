"""Who works on a trial: a process of a machine, with a lease that it renews while it lives."""

from __future__ import annotations

import os
import socket
import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

LEASE_S = 180.0
"""A claim that nobody renewed for so long may be taken over [s]: three times the minute by which clocks of machines may differ or jump."""
RENEW_EVERY_S = 30.0


@dataclass(frozen=True)
class Owner:
    """A claiming process. `born` tells a process from a later one with the same number.

    Attributes:
        parent: The process that watches over it and frees its claims when it dies; 0 for none.
    """

    host: str
    pid: int
    born: str
    parent: int
    parent_born: str
    token: str

    @classmethod
    def this_process(cls, parent: int | None = None) -> Owner:
        born_of_parent = "" if parent is None else _born(parent)
        token = uuid.uuid4().hex[:8]
        return cls(socket.gethostname(), os.getpid(), _born(os.getpid()), parent or 0, born_of_parent, token)

    def __str__(self) -> str:
        return f"{self.host}|{self.pid}|{self.born}|{self.parent}|{self.parent_born}|{self.token}"


@dataclass(frozen=True)
class Surroundings:
    """What a store asks the machine: tests replace it.

    Attributes:
        host: Name of this machine.
        wall_s: Time of day, which machines share more or less, and which may jump [s].
        steady_s: A clock of this machine alone, which never jumps, and which its processes share [s].
        lives: Whether the process with this number and birth is running.
    """

    host: str = field(default_factory=socket.gethostname)
    wall_s: Callable[[], float] = time.time
    steady_s: Callable[[], float] = time.monotonic
    lives: Callable[[int, str], bool] = lambda pid, born: _is(pid, born)

    def is_free(self, owner: str, lease_wall_s: float, lease_steady_s: float) -> bool:
        """Whether a claim may be taken over.

        On this machine: its process and the one that watched it are gone, or its lease ran out by the clock that does not jump.
        On another machine: its lease ran out by the time of day.
        """
        host, pid, born, parent, parent_born, _ = owner.split("|")
        if host != self.host:
            return lease_wall_s < self.wall_s()
        if lease_steady_s < self.steady_s():
            return True
        if self.lives(int(pid), born):
            return False
        # A watching parent counts the death of its worker before it frees the claim.
        return not (int(parent) and self.lives(int(parent), parent_born))


def _is(pid: int, born: str) -> bool:
    return _alive(pid) and _born(pid) == born


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return not _is_zombie(pid)


def _stat(pid: int) -> list[str]:
    """Fields of /proc/PID/stat after the name; empty where there is none."""
    try:
        return Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return []


def _is_zombie(pid: int) -> bool:
    return _stat(pid)[:1] == ["Z"]


def _born(pid: int) -> str:
    """Start time of a process in clock ticks since boot; "" where the system does not tell."""
    found = _stat(pid)
    return found[19] if len(found) > 19 else ""
