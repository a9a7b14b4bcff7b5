"""Caps on what a run may cost, and what one call may cost at most."""

from __future__ import annotations

from dataclasses import dataclass

from wonderful_team.errors import ConfigError


@dataclass(frozen=True)
class Caps:
    """Upper limits of one plan or trial; None means no cap.

    Raises:
        ConfigError: A cap is not positive.
    """

    calls: int | None = None
    tokens: int | None = None
    seconds: float | None = None
    usd: float | None = None

    def __post_init__(self) -> None:
        for name in ("calls", "tokens", "seconds", "usd"):
            value = getattr(self, name)
            if value is not None and value <= 0:
                raise ConfigError(f"cap on {name} must be positive, got {value}")


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
