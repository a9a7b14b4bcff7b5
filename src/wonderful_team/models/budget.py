"""Caps on calls, tokens, seconds and money, enforced before a request is sent, also with many in flight."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

from wonderful_team.errors import BudgetReached, ConfigError
from wonderful_team.types import Usage


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


@dataclass
class Budget:
    """Counts what was spent and what is in flight. A call in flight is reckoned as the dearest one seen so far.

    Attributes:
        spent: Sum over finished calls.
        by_role: The same, per role.
    """

    caps: Caps = field(default_factory=Caps)
    clock: Callable[[], float] = time.monotonic
    spent: Usage = field(default_factory=Usage)
    by_role: dict[str, Usage] = field(default_factory=dict)
    _in_flight: int = 0
    _dearest_tokens: int = 0
    _dearest_usd: float = 0.0
    _started: float | None = None

    def reserve(self) -> None:
        """Take a place for one call.

        Raises:
            BudgetReached: The call could pass a cap; names the cap and what was spent.
        """
        if self._started is None:
            self._started = self.clock()
        caps, calls = self.caps, self.spent.calls + self._in_flight
        if caps.calls is not None and calls + 1 > caps.calls:
            raise BudgetReached(f"the cap of {caps.calls} calls is reached ({calls} made)")
        if caps.tokens is not None:
            tokens = self.spent.tokens + self._in_flight * self._dearest_tokens
            if tokens + self._dearest_tokens > caps.tokens:
                raise BudgetReached(f"the cap of {caps.tokens} tokens is reached ({tokens} spent or in flight)")
        if caps.seconds is not None and self.elapsed_s >= caps.seconds:
            raise BudgetReached(f"the cap of {caps.seconds:g} s is reached ({self.elapsed_s:.1f} s passed)")
        if caps.usd is not None and self.spent.usd is not None:
            usd = self.spent.usd + self._in_flight * self._dearest_usd
            if usd + self._dearest_usd > caps.usd:
                raise BudgetReached(f"the cap of {caps.usd:g} USD is reached ({usd:.4f} USD spent or in flight)")
        self._in_flight += 1

    def settle(self, role: str, usage: Usage) -> None:
        """Give the place back and book what the call cost."""
        self._in_flight -= 1
        self._dearest_tokens = max(self._dearest_tokens, usage.tokens)
        self._dearest_usd = max(self._dearest_usd, usage.usd or 0.0)
        self.spent = self.spent + usage
        self.by_role[role] = self.by_role.get(role, Usage()) + usage

    @property
    def elapsed_s(self) -> float:
        """Seconds since the first call."""
        return 0.0 if self._started is None else self.clock() - self._started

    @property
    def seconds_left(self) -> float | None:
        """Seconds until the cap, or None without one."""
        return None if self.caps.seconds is None else max(0.0, self.caps.seconds - self.elapsed_s)
