"""Caps of a whole study: what was spent, what is in flight, and what is left for the next trial."""

from __future__ import annotations

from dataclasses import dataclass

from wonderful_team.errors import BudgetReached
from wonderful_team.evals.trials import SpendingCaps


class CapReached(BudgetReached):
    """One more trial could pass a cap of the study. Whatever is in flight ends; the study can be resumed with more."""


class WaitForCost(Exception):  # noqa: N818  a signal between a store and its workers
    """A cap is set and nobody knows yet what a trial costs; try again when the one in flight has ended."""


@dataclass(frozen=True)
class Spending:
    """What a study cost so far.

    Attributes:
        dearest: Most calls, tokens and USD that one trial took; a trial in flight is reckoned as that.
        unpriced: Trials whose cost in money is unknown (no price for their model).
    """

    calls: int = 0
    tokens: int = 0
    usd: float = 0.0
    dearest: tuple[int, int, float] = (0, 0, 0.0)
    unpriced: int = 0
    in_flight: int = 0


def remaining(caps: SpendingCaps, spent: Spending) -> SpendingCaps:
    """What the next trial may spend at most.

    Raises:
        WaitForCost: Nothing says yet what a trial costs, and one is in flight.
        CapReached: A trial as dear as the dearest so far would pass a cap; names the cap and what was spent.
    """
    left: dict[str, float | None] = {"calls": None, "tokens": None, "usd": None}
    for place, name in enumerate(("calls", "tokens", "usd")):
        cap = getattr(caps, name)
        if cap is None:
            continue
        dearest = spent.dearest[place]
        if dearest == 0 and spent.in_flight:
            raise WaitForCost(f"what a trial costs in {name} is not known yet: one at a time until one has ended")
        booked = getattr(spent, name) + spent.in_flight * dearest
        if booked + dearest > cap or booked >= cap:
            unit = "USD" if name == "usd" else name
            raise CapReached(
                f"the study's cap of {cap:g} {unit} is reached: {getattr(spent, name):g} spent, "
                f"{spent.in_flight} trials in flight, a trial took up to {dearest:g}"
            )
        left[name] = cap - booked
    calls, tokens = left["calls"], left["tokens"]
    return SpendingCaps(
        None if calls is None else int(calls), None if tokens is None else int(tokens), None, left["usd"]
    )
