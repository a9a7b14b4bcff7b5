"""Imports the user's own, unmodified `vima_bench`, and keeps wall-clock time out of its results."""

from __future__ import annotations

import importlib
import importlib.util
import sys
import time
import types
from typing import Any

STAND_INS = ("torch", "kornia", "kornia.augmentation", "matplotlib", "matplotlib.pyplot")
"""Imported at the top of one of its files and used by no task: empty modules do when they are not installed."""
PACKAGE = "vima_bench"


class Missing(Exception):  # noqa: N818  says what is the case
    """`vima_bench`, or something that it needs, cannot be imported here."""

    kind = "missing"


class CpuClock:
    """Counts the time that this process computed: a busy machine then cannot change how a motion ends."""

    def time(self) -> float:
        """Seconds of processor time."""
        return time.process_time()

    def __getattr__(self, name: str) -> Any:
        return getattr(time, name)


def load(path: str) -> Any:
    """The module `vima_bench`.

    Args:
        path: A source checkout to look in first, or "".

    Raises:
        Missing: It cannot be imported; says what is missing.
    """
    if path:
        sys.path.insert(0, path)
    while True:
        try:
            return importlib.import_module(PACKAGE)
        except ModuleNotFoundError as error:
            if not _made_up_for(str(error.name)):
                raise Missing(f"{error} ({sys.executable})") from error
        except ImportError as error:
            raise Missing(f"{error} ({sys.executable})") from error


def versions() -> dict[str, str]:
    """Of what the simulator runs on, where known."""
    found = {"python": sys.version.split()[0]}
    for name in ("pybullet", "gym", "gymnasium", "numpy", "vima_bench"):
        try:
            from importlib import metadata

            found[name] = metadata.version(name.replace("_", "-"))
        except ImportError:
            continue
    return found


def use_cpu_clock(env: Any) -> bool:
    """Let the simulator's own limits on the arm's motion (5 s) count processor time; whether that was possible."""
    done = False
    for kind in type(env).__mro__:
        module = sys.modules.get(kind.__module__)
        if module is not None and kind.__module__.startswith(PACKAGE) and getattr(module, "time", None) is time:
            module.time = CpuClock()  # type: ignore[attr-defined]
            done = True
    return done


def specs(module: Any, level: str, task: str) -> Any:
    """What a task is made with at a generalisation level, from the benchmark's own tables.

    Raises:
        KeyError: The task does not exist at that level.
    """
    names: list[str] = list(module.ALL_PARTITIONS)
    tables = module.PARTITION_TO_SPECS
    table = tables["train"] if level == "train" else tables["test"][names[int(level[1:]) - 1]]
    return table[task]


def _made_up_for(name: str) -> bool:
    """Put something in the place of a module that is missing; False where nothing can be."""
    if name in sys.modules:
        return False
    if name in STAND_INS:
        sys.modules[name] = types.ModuleType(name)
        parent, _, child = name.rpartition(".")
        if parent:
            setattr(sys.modules[parent], child, sys.modules[name])
        return True
    if name == "gym" and importlib.util.find_spec("gymnasium") is not None:
        # The maintained successor has the same spaces, and more of it is not used.
        sys.modules["gym"] = importlib.import_module("gymnasium")
        sys.modules["gym.spaces"] = importlib.import_module("gymnasium.spaces")
        return True
    return False
