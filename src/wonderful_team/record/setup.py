"""How a run was called, kept in its record so that it can be run again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from wonderful_team.core.actions import Vocabulary
from wonderful_team.core.values import NO_WORKSPACE, KeepOut, Limits, Target
from wonderful_team.errors import ConfigError
from wonderful_team.record.values_file import decode, encode

RENAMED = {"looks": "reobserve"}
"""Fields that records of earlier releases call otherwise."""
LATER: Mapping[str, Any] = {"reobserve": 0, "facts": ""}
"""Fields that records of earlier releases lack, and what those runs did."""


@dataclass(frozen=True, eq=False)
class Setup:
    """The arguments of one run beside its model, method and pictures.

    Attributes:
        entry: plan, ground, or run (a rollout in a world).
        until: Where planning was to stop; of `plan`.
        targets: What was to be found; of `ground`.
        plan: Id of the plan that was handed in; of `run`.
        facts: What planners were told of the robot and its place.
    """

    entry: Literal["plan", "ground", "run"]
    vocabulary: tuple[str, ...]
    limits: Limits
    until: str = "actions"
    keep_out: tuple[KeepOut, ...] = ()
    targets: tuple[Target, ...] = ()
    scene: str = ""
    seed: int | None = None
    replans: int = 0
    reobserve: int = 0
    plan: str | None = None
    scored: bool = True
    facts: str = ""


def setup_entry(
    entry: Literal["plan", "ground", "run"],
    vocabulary: Vocabulary,
    limits: Limits,
    *,
    keep_out: Sequence[KeepOut] = (),
    targets: Sequence[Target] = (),
    **more: Any,
) -> dict[str, Any]:
    """JSON values of a run's set-up; the keywords are those of Setup."""
    whole = Setup(entry, tuple(vocabulary.kinds), limits, keep_out=tuple(keep_out), targets=tuple(targets), **more)
    return dict(encode(whole))


def read_setup(record: Mapping[str, Any], where: str) -> Setup:
    """The set-up that a record holds.

    Raises:
        ConfigError: It holds none (it was written by an earlier release, or by a program of one's own), or a broken one.
    """
    told = record.get("setup")
    if told is None:
        raise ConfigError(f"{where}: this record does not say how it was called, so it cannot be run again")
    try:
        setup = decode({**LATER, **{RENAMED.get(key, key): value for key, value in told.items()}}, Setup)
    except (ValueError, ConfigError) as error:
        raise ConfigError(f"{where}: the set-up in the record cannot be read: {error}") from error
    assert isinstance(setup, Setup)
    return setup


def same_limits(setup: Setup) -> Limits:
    """The limits; the very value that stands for "nobody has said" where it was that."""
    return NO_WORKSPACE if encode(setup.limits) == encode(NO_WORKSPACE) else setup.limits
