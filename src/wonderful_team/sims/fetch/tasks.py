"""The tasks of the Fetch world, known even where the simulator is not installed, and what may stand behind their names."""

from __future__ import annotations

from wonderful_team.errors import ConfigError, UnknownNameError

TASKS: dict[str, int] = {"lid": 1, "lid_two": 2}
"""How many things go into the box."""
WORDS = {
    "lid": "Place one of four things inside a closed box; that its lid comes off first is not said.",
    "lid_two": "Place two of four things inside a closed box; that its lid comes off first is not said.",
}
TIERS = ("depth",)
HARDEST = 3


def task_names() -> dict[str, str]:
    """All tasks with one line of help each."""
    return {name: f"{words[:-1]} (gymnasium-robotics' Fetch)." for name, words in WORDS.items()}


def partitions(name: str) -> tuple[str, ...]:
    """No task has generalisation levels."""
    return ()


def asked(name: str, depth: int) -> tuple[str, int]:
    """The task and the faults of its depth sensor, from a name such as "lid@depth=2".

    Raises:
        UnknownNameError: No such task.
        ConfigError: Something else stands behind the name, or option and name say different things.
    """
    task, *parts = name.split("@")
    if task not in TASKS:
        raise UnknownNameError("task", task, TASKS)
    tiers = {depth} - {0}
    for part in parts:
        key, _, level = part.partition("=")
        if key not in TIERS or not level.isdigit():
            raise ConfigError(f"{name!r}: {part!r} is no option; after @ comes depth=1 to depth={HARDEST}")
        tiers.add(int(level))
    if len(tiers) > 1:
        raise ConfigError(f"depth: said as {' and as '.join(map(str, sorted(tiers)))}; say it once")
    found = tiers.pop() if tiers else 0
    if isinstance(depth, bool) or not 0 <= found <= HARDEST:
        raise ConfigError(f"depth: expected a tier from 0 (none) to {HARDEST} (most), got {found!r}")
    return task, found
