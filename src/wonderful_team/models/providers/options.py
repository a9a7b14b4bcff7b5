"""How models are to be asked, by role: thinking, prices, where they may be; and whether their cost is known."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias, cast, get_args

from wonderful_team.core.caps import Caps
from wonderful_team.core.protocols import Model
from wonderful_team.core.values import Usage
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.models.prices import GivenPrice, read_price
from wonderful_team.models.providers.settings import Thinking
from wonderful_team.models.wire import ENCODINGS, Encoding

REST = "*"
"""Key for the roles that are not named."""
LEVELS: tuple[Thinking, ...] = get_args(Thinking)


@dataclass(frozen=True)
class ModelOptions:
    """Options of the models that a run uses.

    Attributes:
        thinking: Level by role; roles without one keep the service's default.
        prices: Given prices by role, instead of a table's or a profile's.
        local_only: Refuse models outside this machine and private networks.
        timeout_s: Longest time for one try at a request; None: it follows how slow the service is.
        encoding: Of pictures' files: auto, png or jpeg.
    """

    thinking: Mapping[str, Thinking] = field(default_factory=dict)
    prices: Mapping[str, GivenPrice] = field(default_factory=dict)
    local_only: bool = False
    timeout_s: float | None = None
    encoding: Encoding = "auto"

    def thinking_of(self, role: str) -> Thinking | None:
        return self.thinking.get(role, self.thinking.get(REST))

    def price_of(self, role: str) -> GivenPrice | None:
        return self.prices.get(role, self.prices.get(REST))


PriceChoice: TypeAlias = str | Sequence[float] | GivenPrice
"""One price: "IN,OUT", (IN, OUT), or a GivenPrice."""


def model_options(
    thinking: str | Mapping[str, str] | None,
    price: PriceChoice | Mapping[str, PriceChoice] | None,
    local_only: bool,
    roles: Sequence[str],
    timeout_s: float | None = None,
    encoding: str = "auto",
) -> ModelOptions:
    """Options from what a user says: one value for all roles, or a mapping with "*" for the rest.

    Raises:
        UnknownNameError: A role that does not exist.
        ConfigError: A level, a price or an encoding in another form.
    """
    if not (thinking is None or isinstance(thinking, str | Mapping)):
        raise ConfigError(
            f"thinking {thinking!r}: valid are {', '.join(LEVELS)}, or a mapping from role to one of them"
        )
    levels = {REST: thinking} if isinstance(thinking, str) else dict(thinking or {})
    prices = dict(price) if isinstance(price, Mapping) else {} if price is None else {REST: price}
    for role in (*levels, *prices):
        if role not in (*roles, REST):
            raise UnknownNameError("role", role, roles)
    for role, level in levels.items():
        if level not in LEVELS:
            raise ConfigError(f"thinking {level!r} for {_who(role)}: valid are {', '.join(LEVELS)}")
    held = {role: given if isinstance(given, GivenPrice) else read_price(given) for role, given in prices.items()}
    if timeout_s is not None and not timeout_s > 0:
        raise ConfigError(f"timeout {timeout_s!r}: valid is a number of seconds above 0")
    if encoding not in ENCODINGS:
        raise ConfigError(f"encoding {encoding!r}: valid are {', '.join(ENCODINGS)}")
    return ModelOptions(cast(Mapping[str, Thinking], levels), held, local_only, timeout_s, encoding)


def check_prices(models: Iterable[Model], caps: Caps, allow_unpriced: bool) -> None:
    """Refuse to spend an unknown sum without bound.

    Raises:
        ConfigError: A model's price is unknown, no cap on tokens is set, and `allow_unpriced` is not given.
    """
    if allow_unpriced or caps.tokens is not None:
        return
    unpriced = sorted({str(getattr(model, "name", "model")) for model in models if not has_price(model)})
    if unpriced:
        raise ConfigError(
            f"no price is known for {', '.join(unpriced)}: set --max-tokens N (max_tokens=), or give --price IN,OUT in USD "
            "per million tokens (price=; 0,0 for your own machine), or accept any cost with --allow-unpriced "
            "(allow_unpriced=True)"
        )


def has_price(model: Model) -> bool:
    """Whether a model's cost is known; models that are no providers (offline, your own) are not asked."""
    prices = getattr(model, "prices", None)
    return prices is None or prices.usd(Usage(tokens_in=1, tokens_out=1)) is not None


def _who(role: str) -> str:
    return "all roles" if role == REST else f"role {role}"
