"""What tokens cost: a maintained table for vendors at their own address, or a price that was given. Never a guess."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from wonderful_team.core.values import Usage
from wonderful_team.errors import ConfigError


class Prices(Protocol):
    """Anything that says what a usage costs."""

    def usd(self, usage: Usage) -> float | None:
        """Cost in US dollars, or None when unknown."""
        ...


@dataclass(frozen=True)
class Unpriced:
    """Nobody has said what this model costs."""

    def usd(self, usage: Usage) -> float | None:
        return None


@dataclass(frozen=True)
class GivenPrice:
    """A price in US dollars per million tokens; thinking counts as output, cached input as input unless stated.

    Raises:
        ConfigError: A price is negative.
    """

    usd_in: float
    usd_out: float
    usd_cached: float | None = None

    def __post_init__(self) -> None:
        for value in (self.usd_in, self.usd_out, self.usd_cached or 0.0):
            if not 0 <= value < float("inf"):
                raise ConfigError(f"a price must be 0 or more USD per million tokens, got {value}")

    def usd(self, usage: Usage) -> float | None:
        cached = self.usd_in if self.usd_cached is None else self.usd_cached
        fresh = max(0, usage.tokens_in - usage.tokens_cached)
        out = usage.tokens_out + usage.tokens_thinking
        return (fresh * self.usd_in + usage.tokens_cached * cached + out * self.usd_out) / 1e6


@dataclass(frozen=True)
class TablePrice:
    """The price of a vendor's model as the table of the package genai-prices has it."""

    vendor: str
    model: str

    def usd(self, usage: Usage) -> float | None:
        import genai_prices
        from genai_prices import Usage as TableUsage

        counted: Any = TableUsage(
            input_tokens=usage.tokens_in,
            cache_read_tokens=usage.tokens_cached,
            output_tokens=usage.tokens_out + usage.tokens_thinking,
        )
        try:
            found = genai_prices.calc_price(counted, self.model, provider_id=self.vendor)
        except LookupError:
            return None
        return float(found.total_price)


def read_price(given: str | Sequence[float]) -> GivenPrice:
    """A price from "IN,OUT" or "IN,OUT,CACHED", or such numbers: US dollars per million tokens.

    Raises:
        ConfigError: Another form.
    """
    text = ",".join(map(str, given)) if isinstance(given, list | tuple) else str(given)
    try:
        numbers = [float(word) for word in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3):
        raise ConfigError(f"--price {text!r}: valid is IN,OUT or IN,OUT,CACHED in USD per million tokens, as in 3,15")
    return GivenPrice(*numbers)
