"""Caps on what a run may cost, and what one call may cost at most."""

from __future__ import annotations

from dataclasses import dataclass, fields

from wonderful_team.errors import ConfigError


@dataclass(frozen=True)
class Caps:
    """Upper limits; None for none. Of one plan or trial: the method fails at stage budget. Of a whole study: it stops cleanly.

    Raises:
        ConfigError: A cap is not positive.
    """

    calls: int | None = None
    tokens: int | None = None
    seconds: float | None = None
    usd: float | None = None

    def __post_init__(self) -> None:
        for name, value in self.given.items():
            if value <= 0:
                raise ConfigError(f"cap on {name} must be positive, got {value}")

    @property
    def given(self) -> dict[str, float]:
        """The caps that are set, by name."""
        return {item.name: value for item in fields(self) if (value := getattr(self, item.name)) is not None}


@dataclass(frozen=True)
class Estimate:
    """What one call may cost at most, reckoned before it is sent.

    Attributes:
        tokens_in: Tokens of the request.
        tokens_out: Most tokens of the answer, thinking included; the call can be held to fewer.
        usd_in, usd_out: Cost of these; None when the price is unknown.
    """

    tokens_in: int
    tokens_out: int
    usd_in: float | None = None
    usd_out: float | None = None
