"""What can be asked of a world beside its task and seed, as options or behind the task's name: "rotate@L3@small@clutter=2"."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

from wonderful_team.errors import ConfigError
from wonderful_team.sims.tabletop.cameras import SIZE_PX

T = TypeVar("T")
TIERS = ("clutter", "lighting", "camera", "texture")
HARDEST = 3
SMALL = "small"
SMALL_PX = (256, 128)
"""The size of VIMA-Bench's pictures, width and height [px]."""


@dataclass(frozen=True)
class Tiers:
    """How much harder than usual a scene is, in four ways; 0 is as usual, 3 the hardest.

    Attributes:
        clutter: 2, 4 or 6 further things stand about that no rule is about.
        lighting: Light from elsewhere, weaker and coloured; from 2 on things cast shadows.
        camera: The top camera stands elsewhere, tilted and rolled; at 3 its calibration is a little wrong.
        texture: A patterned table; from 2 on covers that look alike.

    Raises:
        ConfigError: A tier is not from 0 to 3.
    """

    clutter: int = 0
    lighting: int = 0
    camera: int = 0
    texture: int = 0

    def __post_init__(self) -> None:
        for name in TIERS:
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= HARDEST:
                raise ConfigError(f"{name}: expected a tier from 0 (as usual) to {HARDEST} (hardest), got {value!r}")


@dataclass(frozen=True)
class Asked:
    """What a name and options together ask for."""

    task: str
    partition: str | None
    size_px: tuple[int, int]
    tiers: Tiers


def asked(name: str, partition: str | None, size_px: tuple[int, int] | None, tiers: Tiers) -> Asked:
    """Read a name such as "rotate@L3@small@clutter=2", completed by options.

    Raises:
        ConfigError: The name says something twice, or otherwise than the options do, or something unknown.
    """
    task, *parts = name.split("@")
    for part in parts:
        tier, equals, level = part.partition("=")
        if part == SMALL:
            size_px = _one("size_px", size_px, SMALL_PX)
        elif equals and tier in TIERS:
            if not level.isdigit():
                raise ConfigError(f"{name!r}: {part!r} is no tier; say {tier}=0 to {tier}={HARDEST}")
            value = _one(tier, getattr(tiers, tier) or None, int(level))
            tiers = replace(tiers, **{tier: value})
        elif equals or not part:
            raise ConfigError(
                f"{name!r}: {part!r} is no option; after @ come a level, {SMALL}, or a tier: {', '.join(TIERS)}"
            )
        else:
            partition = _one("partition", partition, part)
    return Asked(task, partition, size_px or SIZE_PX, tiers)


def _one(what: str, option: T | None, named: T) -> T:
    if option is not None and option != named:
        raise ConfigError(f"{what}: the name says {named!r}, the option {option!r}; say it once")
    return named
