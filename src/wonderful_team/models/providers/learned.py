"""What a service taught while it was asked: it is told once, not before every request."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from wonderful_team.errors import ContextTooLongError
from wonderful_team.models.budget import LEAST_OUT
from wonderful_team.models.providers.facts import Facts
from wonderful_team.models.providers.faults import Fault
from wonderful_team.models.providers.settings import LONGEST_TRY_S, Settings
from wonderful_team.models.wire import UNLIMITED, Composed, Weight

LIGHTER = 3
"""Pictures that a service refused as too heavy are sent again with at most this fraction of their bytes."""
SLOW_TIMES = 4.0
"""A reply may take so many times as long as the slowest one seen."""
MOST_UNSEEN = 4.0
"""A try may take at most so many times what the first one may, as long as no slower reply was seen."""
_UNMEASURED = (1 / 3, 2 / 3)
"""Least and likely share of the careful estimate that a request takes, before a service has counted one."""
_MEASURED = (0.8, 1.05)


@dataclass
class Learned:
    """What is known of a service by now.

    Attributes:
        schemas, thinking: It takes schemas; it takes the switch for thinking.
        max_pictures: Most pictures in one request; None when nothing is known.
        weight: How heavy pictures may be.
        facts: What it says of the model; None until it was asked. facts_asked: How often it was.
        context: Most tokens of a request and its answer together.
        most_out: Most tokens of an answer, as it said when it refused more.
        counted: Largest share of the careful estimate that a request took as it counted; None before it counted one.
        first_try_s, try_s: How long one try may take: at the start, and now.
        crowded: Requests at once were too much for it: it is asked one at a time.
        notices: What the user should know, not yet told.
    """

    schemas: bool
    max_pictures: int | None
    first_try_s: float
    try_s: float
    thinking: bool = True
    weight: Weight = UNLIMITED
    facts: Facts | None = None
    facts_asked: int = 0
    context: int | None = None
    most_out: int | None = None
    counted: float | None = None
    crowded: bool = False
    notices: list[str] = field(default_factory=list)
    _said: set[str] = field(default_factory=set)

    @classmethod
    def of(cls, settings: Settings) -> Learned:
        """What is set at the start."""
        first = settings.first_try_s
        return cls(
            settings.schemas, settings.max_pictures, first, first, context=settings.context, weight=settings.weight
        )

    def say(self, what: str, text: str) -> None:
        """Note something for the user, once for each `what`."""
        if what not in self._said:
            self._said.add(what)
            self.notices.append(text)

    def told(self) -> tuple[str, ...]:
        """The notices not yet told, which are told now."""
        found, self.notices = tuple(self.notices), []
        return found

    # -- length ----------------------------------------------------------------------------------------------------

    @property
    def facts_wanted(self) -> bool:
        """The service should be asked what it says: once, and an Ollama again once its model is loaded."""
        return self.facts is None or (self.facts.ollama and self.facts.context is None and self.facts_asked < 2)

    def know(self, facts: Facts) -> None:
        """Take in what the service says of itself."""
        self.facts = facts
        if facts.context is not None:
            self.context = facts.context

    def count(self, tokens: float, reckoned: float) -> None:
        """Take in how many tokens the service counted in a request that was reckoned at so many."""
        if reckoned > 0:
            self.counted = min(100.0, max(self.counted or 0.0, tokens / reckoned))

    def careful(self, reckoned: float) -> int:
        """A request's tokens on the careful side."""
        return round(reckoned * max(1.0, self.counted or 1.0))

    def fitted(self, limit: int, reckoned: float) -> int:
        """The answer's limit that the context leaves beside a request that was reckoned at so many tokens.

        Raises:
            ContextTooLongError: The request alone leaves no room for an answer.
        """
        if self.most_out is not None:
            limit = min(limit, self.most_out)
        if self.context is None:
            return limit
        least, likely = (
            reckoned * (self.counted or 1.0) * share for share in (_MEASURED if self.counted else _UNMEASURED)
        )
        if self.context - least < LEAST_OUT:
            raise ContextTooLongError(
                f"words and pictures alone take about {likely:.0f} tokens, and the model's context is {self.context} tokens "
                f"({self.source}); {self._raised(likely + limit)}"
            )
        room = max(LEAST_OUT, int(self.context - likely))
        if room < limit:
            self.say(
                "fit",
                f"answers are held to {room} tokens instead of {limit}: the model's context is {self.context} tokens "
                f"({self.source}), words and pictures included; {self._raised(likely + limit)}",
            )
        return min(limit, room)

    def check_whole(self, counted: int, least: float) -> None:
        """Notice a request that the server cut without a word.

        Raises:
            ContextTooLongError: The server counted far fewer tokens than the words and pictures sent can have, or an Ollama
                counted as many as its context holds, which is where it cuts.
        """
        context = self.context
        over = context is None or least + LEAST_OUT > context
        full = context is not None and counted + LEAST_OUT > context and self.facts is not None and self.facts.ollama
        if (0 < counted < least and over) or full:
            known = "" if context is None else f"; its context is {context} tokens ({self.source})"
            raise ContextTooLongError(
                f"the server counted {counted} tokens in a request of at least {least:.0f}: it dropped part of it without a "
                f"word{known}; {self._raised(2 * max(least, counted))}"
            )

    @property
    def source(self) -> str:
        """Where the context's length stands."""
        return (
            self.facts.source if self.facts is not None and self.facts.source else "as it was measured or refused more"
        )

    def _raised(self, tokens: float) -> str:
        return (self.facts or Facts()).raised_by(round(tokens))

    # -- time ------------------------------------------------------------------------------------------------------

    def took(self, seconds: float) -> None:
        """A whole reply took so long."""
        self.try_s = min(LONGEST_TRY_S, max(self.try_s, SLOW_TIMES * seconds))

    def too_short(self, tried_s: float) -> None:
        """A try ended after so long without a reply: the next one may take twice that, within bounds (it may hang)."""
        self.try_s = max(self.try_s, min(2 * tried_s, MOST_UNSEEN * self.first_try_s))

    # -- refusals --------------------------------------------------------------------------------------------------

    def take(self, fault: Fault, sent: Composed, thinking: str | None, limit: int, reckoned: float) -> bool:
        """Take in what the service refused; True when the request should be sent in another form."""
        pictures = len(sent.sizes_px)
        if fault.schema:
            # Perhaps another request that is under way has learned it already: this one was still sent with a schema.
            self.schemas = False
            return True
        if fault.thinking and thinking is not None and self.thinking:
            self.thinking = False
            self.say(
                "thinking", f"the service does not take --thinking {thinking} for this model: its own default stands"
            )
            return True
        if fault.picture_limit is not None and pictures > 1:
            self.max_pictures = min(fault.picture_limit or 1, pictures - 1)
            return True
        if fault.most_out is not None and fault.most_out < limit:
            self.most_out = fault.most_out
            return True
        if fault.heavy and pictures and self._lighter(sent):
            return True
        return isinstance(fault.error, ContextTooLongError) and self._shorter(fault, limit, reckoned)

    def _lighter(self, sent: Composed) -> bool:
        """Whether pictures that were too heavy together can be sent lighter."""
        most = sent.picture_bytes // LIGHTER
        if self.weight.request is not None and self.weight.request <= most:
            return False
        self.weight = replace(self.weight, request=most)
        return True

    def crowd(self) -> None:
        """Requests that were under way at once were too much for the service."""
        self.crowded = True
        known = "" if self.context is None else f" of {self.context} tokens"
        self.say(
            "crowd",
            f"requests at once share the model's context{known} and together overfilled it: it is asked one at a time from now "
            f"on; {self._raised(4 * (self.context or 4096))}",
        )

    def _shorter(self, fault: Fault, limit: int, reckoned: float) -> bool:
        """Whether a shorter answer makes a request fit that was too long for the context."""
        if fault.context is not None:
            self.context = fault.context
        if self.context is None:
            return False
        # Where the refusal does not say how long the request is, it is at least what the answer did not leave.
        taken = fault.taken if fault.taken is not None else 1.1 * (self.context - limit)
        if self.context - taken < LEAST_OUT or limit <= LEAST_OUT:
            return False
        self.count(max(1.0, taken), reckoned)
        return True
