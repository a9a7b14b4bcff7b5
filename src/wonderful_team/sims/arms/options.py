"""What can be asked of an arm's world behind the task's name: "block_in_bowl@xarm7@depth=2@calibration=1@nudge=1"."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from wonderful_team.errors import ConfigError
from wonderful_team.sims.arms.disturbances import DISTURBANCES
from wonderful_team.sims.arms.rows import ARMS, DEFAULT

TIERS = ("depth", "calibration", "camera")
HARDEST = 3


@dataclass(frozen=True)
class Asked:
    """What a name and options together ask for.

    Attributes:
        depth: Faults of the depth sensor, 0 (none) to 3.
        calibration: Error of the top camera's calibration, 0 (none) to 3.
        camera: How far the top camera was moved, 0 (not) to 3; planners are told where it stands.
        disturbances: How often each kind of disturbance happens, 1 to 3; see `disturbances.py`.
    """

    task: str
    arm: str = DEFAULT
    depth: int = 0
    calibration: int = 0
    camera: int = 0
    disturbances: Mapping[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in TIERS:
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= HARDEST:
                raise ConfigError(f"{name}: expected a tier from 0 (none) to {HARDEST} (most), got {value!r}")


def asked(name: str, arm: str | None, depth: int, calibration: int, camera: int = 0) -> Asked:
    """Read a name such as "block_in_bowl@xarm7@depth=2", completed by options.

    Raises:
        ConfigError: The name says otherwise than the options do, or something unknown.
    """
    task, *parts = name.split("@")
    found = Asked(task, arm or DEFAULT, depth, calibration, camera)
    for part in parts:
        tier, equals, level = part.partition("=")
        if equals and tier in TIERS and level.isdigit():
            if getattr(found, tier) not in (0, int(level)):
                raise ConfigError(f"{tier}: the name says {level}, the option {getattr(found, tier)}; say it once")
            more: dict[str, Any] = {tier: int(level)}
            found = replace(found, **more)
        elif equals and tier in DISTURBANCES and level in map(str, range(1, HARDEST + 1)):
            if tier in found.disturbances:
                raise ConfigError(f"{name!r}: {tier} is said twice; say it once")
            found = replace(found, disturbances={**found.disturbances, tier: int(level)})
        elif part in ARMS and arm in (None, part):
            found = replace(found, arm=part)
        else:
            raise ConfigError(
                f"{name!r}: {part!r} is no option; after @ come an arm ({', '.join(ARMS)}) or any of "
                f"{', '.join(f'{tier}=1 to {tier}={HARDEST}' for tier in (*TIERS, *DISTURBANCES))}"
            )
    return found
