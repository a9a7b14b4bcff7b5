"""Caps of a whole study: what was spent, what trials in flight may spend, and what is left for the next one.

A trial in flight holds what it may spend at most, so trials run side by side and a cap is never passed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from wonderful_team.core.caps import Caps
from wonderful_team.errors import BudgetReached

UNITS = ("calls", "tokens", "usd")
ROOM = 2.0
"""A trial holds so many times what the dearest one of its condition took; one that wants more is cut and run again."""
ROOM_OF_OTHERS = 3.0
"""The same where only other conditions are known."""
LEAST_USD = 1e-9
Costs: TypeAlias = tuple[float | None, float | None, float | None]
"""Calls, tokens, USD; None where it is not known."""


class CapReached(BudgetReached):
    """One more trial could pass a cap of the study. Whatever is in flight ends; the study can be resumed with more."""


class WaitForCost(Exception):  # noqa: N818  a signal between a store and its workers
    """The trials in flight hold what is left; try again when one of them has ended."""


@dataclass(frozen=True)
class Spending:
    """What a study cost so far.

    Attributes:
        held: Calls, tokens and USD that trials in flight may still spend.
        unpriced: Trials whose cost in money is unknown (no price for their model).
    """

    calls: int = 0
    tokens: int = 0
    usd: float = 0.0
    unpriced: int = 0
    in_flight: int = 0
    held: tuple[float, float, float] = (0, 0, 0.0)


@dataclass(frozen=True)
class Likely:
    """What is known of the cost of a trial before it runs.

    Attributes:
        own: The dearest trial of the same condition, cut ones included; 0 for what costs nothing; None: none has run yet.
        others: The dearest trial of any condition; None: no trial has cost anything yet.
        allowed: What this very trial was allowed when the study's cap last cut it; 0 when that never happened.
    """

    own: Costs = (None, None, None)
    others: Costs = (None, None, None)
    allowed: tuple[float, float, float] = (0, 0, 0.0)


@dataclass(frozen=True)
class Allowance:
    """What a trial may spend at most, and what of that it holds."""

    caps: Caps
    held: tuple[float, float, float]


def allow(caps: Caps, spent: Spending, likely: Likely) -> Allowance:
    """What the next trial may spend.

    Raises:
        WaitForCost: It does not fit beside those in flight.
        CapReached: It does not fit at all; names the cap and what was spent.
    """
    left: dict[str, float | None] = {}
    held = []
    # A trial that was cut gets at least twice as much the next time, so that attempts end after a few.
    grows = not any(likely.allowed)
    for place, (name, least) in enumerate(zip(UNITS, (1, 1, LEAST_USD), strict=True)):
        cap = getattr(caps, name)
        if cap is None:
            left[name] = None
            held.append(0.0)
            continue
        free = cap - getattr(spent, name) - spent.held[place]
        own, others = likely.own[place], likely.others[place]
        if own == 0:
            left[name] = free
            held.append(0.0)
            continue
        need = own if own is not None else 0.0
        if free <= 0 or need > free:
            if spent.held[place] > 0:
                raise WaitForCost(f"what is left of {name} is held by trials in flight")
            raise CapReached(_reached(name, cap, getattr(spent, name), need))
        before = likely.allowed[place]
        wanted = ROOM * own if own is not None else ROOM_OF_OTHERS * others if others else free
        given = min(free, max(wanted, ROOM * before, least))
        grows = grows or given > before
        left[name] = given
        held.append(given)
    if not grows:
        if any(spent.held):
            raise WaitForCost("the trial was cut, and trials in flight hold what it needs more")
        raise CapReached("the study's cap is reached: a trial needs more than all that is left of it")
    calls, tokens, usd = left["calls"], left["tokens"], left["usd"]
    whole = Caps(
        None if calls is None else max(1, int(calls)),
        None if tokens is None else max(1, int(tokens)),
        None,
        None if usd is None else max(LEAST_USD, usd),
    )
    return Allowance(whole, (held[0], held[1], held[2]))


def _reached(name: str, cap: float, spent: float, need: float) -> str:
    unit = "USD" if name == "usd" else name
    took = f", a trial like the next one took up to {need:g}" if need else ""
    return f"the study's cap of {cap:g} {unit} is reached: {spent:g} spent{took}"
