"""Caps on calls, tokens, seconds and money, enforced before a request is sent, also with many in flight."""

from __future__ import annotations

import asyncio
import contextvars
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from wonderful_team.core import deadline
from wonderful_team.core.caps import Caps, Estimate
from wonderful_team.core.values import SentPicture, Usage
from wonderful_team.errors import BudgetReached

LEAST_OUT = 256
"""A call is not worth sending when fewer tokens than this are left for its answer."""


@dataclass(eq=False)
class Ticket:
    """Leave for one call.

    Attributes:
        max_out: Most tokens that the answer may have under the caps; None for no limit.
        held_by: The cap that sets it, in words.
        seconds: Time that the call may take, all its tries together; None for no limit.
        tries: How often it was sent.
        lost: What tries without an answer may have cost.
        answered: What an answer cost that was none for the team (a refusal, say).
        hear: Told of the files of the request's pictures when they go out.
        sent: Whether they did.
    """

    budget: Budget | None = None
    estimate: Estimate | None = None
    max_out: int | None = None
    held_by: str = "the caps"
    seconds: float | None = None
    tries: int = 1
    tokens: int = 0
    usd: float = 0.0
    lost: Usage = field(default_factory=Usage)
    answered: Usage | None = None
    hear: Callable[[tuple[SentPicture, ...]], None] | None = None
    sent: bool = False

    def sends(self, pictures: tuple[SentPicture, ...]) -> None:
        """Tell what goes out now."""
        self.sent = True
        if self.hear is not None:
            self.hear(pictures)

    def another_try(self) -> None:
        """Ask leave to send once more.

        Raises:
            BudgetReached: It could pass a cap.
        """
        if self.budget is not None:
            self.budget.admit_again(self)
        self.tries += 1

    def book_lost_try(self, limit: int | None = None) -> None:
        """The last try brought no answer but may have been worked on: its request and the longest answer count as spent.

        Args:
            limit: Most tokens that its answer could have; None: what the caps left.
        """
        if self.estimate is None:
            return
        reckoned = self.estimate
        out = min(most for most in (limit, self.max_out, reckoned.tokens_out) if most is not None)
        share = out / reckoned.tokens_out if reckoned.tokens_out else 0.0
        priced = reckoned.usd_in is not None and reckoned.usd_out is not None
        usd = (reckoned.usd_in or 0.0) + (reckoned.usd_out or 0.0) * share if priced else None
        lost = Usage(tokens_in=reckoned.tokens_in, tokens_out=out, usd=usd)
        self.lost = self.lost + lost
        if self.budget is not None:
            self.budget.hold_more(self, lost)


_CURRENT: contextvars.ContextVar[Ticket | None] = contextvars.ContextVar("ticket", default=None)


def current_ticket() -> Ticket:
    """The ticket of the call under way; without a client, one that knows no caps."""
    return _CURRENT.get() or Ticket()


def set_current_ticket(ticket: Ticket) -> None:
    """Make a ticket the one that the model finds under `current_ticket`."""
    _CURRENT.set(ticket)


@dataclass
class Budget:
    """Counts what was spent and what is in flight.

    A call in flight holds what it may cost at most: as its model reckons it, else the dearest call seen so far. A call
    that fits the caps, but not beside those in flight, waits for them.

    Attributes:
        spent: Sum over finished calls.
        by_role: The same, per role.
    """

    caps: Caps = field(default_factory=Caps)
    clock: Callable[[], float] = time.monotonic
    spent: Usage = field(default_factory=Usage)
    by_role: dict[str, Usage] = field(default_factory=dict)
    _calls: int = 0
    _tokens: int = 0
    _usd: float = 0.0
    _dearest_tokens: int = 0
    _dearest_usd: float = 0.0
    _started: float | None = None
    _waiting: list[asyncio.Future[None]] = field(default_factory=list)

    async def take(self, estimate: Estimate | None = None) -> Ticket:
        """Leave for one call, as soon as it fits beside those in flight.

        Raises:
            BudgetReached: The call could pass a cap; names the cap and what was spent.
        """
        while True:
            ticket = self._admit(estimate)
            if ticket is not None:
                return ticket
            turn: asyncio.Future[None] = asyncio.get_running_loop().create_future()
            self._waiting.append(turn)
            left = self.seconds_left
            try:
                await asyncio.wait_for(turn, left)
            except TimeoutError:
                # The next look at the caps says so.
                continue

    def settle(self, role: str, usage: Usage, ticket: Ticket) -> None:
        """Give the place back and book what the call cost, its lost tries included."""
        self._calls -= ticket.tries
        self._tokens -= ticket.tokens
        self._usd -= ticket.usd
        cost = replace(usage + ticket.lost, calls=max(usage.calls, ticket.tries) if usage.calls else 0)
        self._dearest_tokens = max(self._dearest_tokens, cost.tokens)
        self._dearest_usd = max(self._dearest_usd, cost.usd or 0.0)
        self.spent = self.spent + cost
        self.by_role[role] = self.by_role.get(role, Usage()) + cost
        waiting, self._waiting = self._waiting, []
        for turn in waiting:
            if not turn.done():
                turn.get_loop().call_soon_threadsafe(_wake, turn)

    def admit_again(self, ticket: Ticket) -> None:
        """Leave to send a call once more; BudgetReached when it could pass a cap."""
        self._check_calls_and_time()
        caps = self.caps
        if caps.tokens is not None and self.spent.tokens + self._tokens > caps.tokens:
            raise BudgetReached(_tokens_reached(caps.tokens, self.spent.tokens + self._tokens))
        if caps.usd is not None and (self.spent.usd or 0.0) + self._usd > caps.usd:
            raise BudgetReached(_usd_reached(caps.usd, (self.spent.usd or 0.0) + self._usd))
        self._calls += 1

    def hold_more(self, ticket: Ticket, lost: Usage) -> None:
        """Hold what a lost try may have cost beside what its next try may."""
        ticket.tokens += lost.tokens
        ticket.usd += lost.usd or 0.0
        self._tokens += lost.tokens
        self._usd += lost.usd or 0.0

    def _admit(self, estimate: Estimate | None) -> Ticket | None:
        """A ticket, or None when the call has to wait for others; BudgetReached when waiting would not help."""
        self._check_calls_and_time()
        caps, busy = self.caps, self._calls > 0
        reckoned = estimate or Estimate(self._dearest_tokens, 0, self._dearest_usd, 0.0)
        most, held_by = float(reckoned.tokens_out), "the caps"
        if caps.tokens is not None:
            least = reckoned.tokens_in + min(LEAST_OUT, reckoned.tokens_out)
            if self.spent.tokens + least > caps.tokens:
                raise BudgetReached(_tokens_reached(caps.tokens, self.spent.tokens, least))
            free = caps.tokens - self.spent.tokens - self._tokens
            if least > free and busy:
                return None
            if free - reckoned.tokens_in < most:
                most, held_by = free - reckoned.tokens_in, f"the cap of {caps.tokens} tokens"
        usd_in, usd_out = reckoned.usd_in, reckoned.usd_out
        if caps.usd is not None and self.spent.usd is not None and usd_in is not None and usd_out is not None:
            per_token = usd_out / reckoned.tokens_out if reckoned.tokens_out else 0.0
            least_usd = usd_in + per_token * min(LEAST_OUT, reckoned.tokens_out)
            if self.spent.usd + least_usd > caps.usd:
                raise BudgetReached(_usd_reached(caps.usd, self.spent.usd, least_usd))
            free_usd = caps.usd - self.spent.usd - self._usd
            if least_usd > free_usd and busy:
                return None
            if per_token and (affordable := math.floor((free_usd - usd_in) / per_token + 1e-9)) < most:
                most, held_by = affordable, f"the cap of {caps.usd:g} USD"
        out = max(0, int(most))
        share = out / reckoned.tokens_out if reckoned.tokens_out else 0.0
        usd = (usd_in or 0.0) + (usd_out or 0.0) * share
        capped = estimate is not None and (caps.tokens is not None or caps.usd is not None)
        ticket = Ticket(self, estimate, out if capped else None, held_by, tokens=reckoned.tokens_in + out, usd=usd)
        self._calls += 1
        self._tokens += ticket.tokens
        self._usd += ticket.usd
        return ticket

    def _check_calls_and_time(self) -> None:
        if self._started is None:
            self._started = self.clock()
        caps, calls = self.caps, self.spent.calls + self._calls
        if caps.calls is not None and calls + 1 > caps.calls:
            raise BudgetReached(f"the cap of {caps.calls} calls is reached ({calls} made)")
        deadline.check("asking a model")
        if caps.seconds is not None and self.elapsed_s >= caps.seconds:
            raise BudgetReached(f"the cap of {caps.seconds:g} s is reached ({self.elapsed_s:.1f} s passed)")

    def time_is_up(self, during: str) -> BudgetReached:
        """The error of the limit on time, for what was under way."""
        limit = deadline.current()
        if limit is not None:
            return limit.reached(during)
        return BudgetReached(
            f"the cap of {self.caps.seconds:g} s is reached ({self.elapsed_s:.1f} s passed) during {during}"
        )

    @property
    def elapsed_s(self) -> float:
        """Seconds since the first call."""
        return 0.0 if self._started is None else self.clock() - self._started

    @property
    def seconds_left(self) -> float | None:
        """Seconds until the cap, or the end of the run's time; None without either."""
        own_s = None if self.caps.seconds is None else max(0.0, self.caps.seconds - self.elapsed_s)
        return deadline.left_s(own_s)


def _wake(turn: asyncio.Future[None]) -> None:
    if not turn.done():
        turn.set_result(None)


def _tokens_reached(cap: int, spent: int, least: int = 0) -> str:
    next_call = f"; the next call needs about {least}" if least else ""
    return f"the cap of {cap} tokens is reached ({spent} spent{next_call})"


def _usd_reached(cap: float, spent: float, least: float = 0.0) -> str:
    next_call = f"; the next call needs about {least:.4f}" if least else ""
    return f"the cap of {cap:g} USD is reached ({spent:.4f} USD spent{next_call})"
