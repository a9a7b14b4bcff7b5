"""A vendor's model or a server as a model: one request out, one answer back, every fault typed, every try counted."""

from __future__ import annotations

import asyncio
import functools
import hashlib
import math
import time
from collections.abc import AsyncGenerator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from wonderful_team.core.caps import Estimate
from wonderful_team.core.interrupts import in_thread
from wonderful_team.core.values import Answer, Request, Usage
from wonderful_team.errors import (
    BudgetReached,
    ContextTooLongError,
    ModelCutOffError,
    ModelTimeoutError,
    WonderfulTeamError,
)
from wonderful_team.images import Ticks
from wonderful_team.models.budget import Ticket, current_ticket
from wonderful_team.models.conventions import Convention
from wonderful_team.models.prices import Prices
from wonderful_team.models.providers import library
from wonderful_team.models.providers.facts import UNKNOWN
from wonderful_team.models.providers.faults import Fault, before_sending, declined, fault_of, key_refused, told
from wonderful_team.models.providers.learned import Learned
from wonderful_team.models.providers.server_facts import server_facts
from wonderful_team.models.providers.settings import LONGEST_WAIT_S, TIMED_OUT_TRIES, Settings, Thinking
from wonderful_team.models.providers.specs import Spec, is_loopback
from wonderful_team.models.providers.tokens import MOST_CHARACTERS_PER_TOKEN, as_said, reckoned, usage_of
from wonderful_team.models.providers.turns import Turn, Turns
from wonderful_team.models.providers.vendors import SERVER_KEY
from wonderful_team.models.wire import Composed, Reading, Unreadable, compose, encodable, ticks_of
from wonderful_team.redaction import keep_secret, redact_known

if TYPE_CHECKING:
    from pydantic_ai.messages import ModelResponse

FACTS_S = 5.0
"""Time for each question about the server itself."""


@dataclass
class Provider:
    """Ask a vendor's model or a server. Made by `make_provider`.

    Attributes:
        name: As the user wrote it; never holds a key.
        weak_pointing: Whole views should carry labelled axes.
        prices: What tokens cost.
        note: What the user should know before trusting its places; "" when they were measured.
        key_holder: The variable that holds the key, or would.
    """

    name: str
    spec: Spec
    model: str
    convention: Convention
    settings: Settings
    prices: Prices
    weak_pointing: bool = False
    local_only: bool = False
    note: str = ""
    key: str | None = field(default=None, repr=False)
    key_holder: str = SERVER_KEY
    _clients: WeakKeyDictionary[asyncio.AbstractEventLoop, tuple[Any, AsyncGenerator[None]]] = field(
        default_factory=WeakKeyDictionary, repr=False
    )

    def __post_init__(self) -> None:
        keep_secret(self.key)
        self._learned = Learned.of(self.settings)
        self._turns = Turns()

    @property
    def ticks(self) -> Ticks:
        """What numbers on drawn axes mean where the answer holds places."""
        return ticks_of(self.convention)

    @property
    def identity(self) -> Mapping[str, Any]:
        """What decides the answer beside the request: for cache keys and records."""
        return {
            "model": self.model,
            "api": self.spec.service.api,
            "server": self.spec.base_url,
            "thinking": self.settings.thinking,
            "max_tokens": self.settings.max_tokens,
            "schemas": self.settings.schemas,
            "max_pictures": self.settings.max_pictures,
            "convention": repr(self.convention),
            "library": library.library_version(),
            # PNG leaves it out: what was kept before pictures had a choice holds on.
            **({} if self.settings.encoding == "png" else {"encoding": self.settings.encoding}),
        }

    @property
    def picture_limit(self) -> int | None:
        """Most pictures in one request, as set or as the service told; None when nothing is known."""
        return self._learned.max_pictures

    @property
    def schemas_refused(self) -> bool:
        """The service does not take schemas: they are told in words only."""
        return not self._learned.schemas

    @property
    def thinking_refused(self) -> bool:
        """The service does not take the switch for thinking."""
        return not self._learned.thinking

    @property
    def deadline_s(self) -> float:
        """Longest time for one request with all its tries, and for those whose turn comes before it."""
        return self._own_s * (1 + self._turns.ahead)

    @property
    def _own_s(self) -> float:
        """Longest time for one request with all its tries."""
        held = self.settings
        if held.deadline_s is not None:
            return held.deadline_s
        # The second of two tries may take twice as long as the first; and there are pauses.
        return 1.05 * self._learned.try_s * (3 if held.adapts else TIMED_OUT_TRIES) + LONGEST_WAIT_S

    def estimate(self, request: Request) -> Estimate:
        """What a request may cost at most, before it is sent (see `Budget`)."""
        tokens_in = self._learned.careful(self._reckoned(request))
        most = self.settings.max_tokens
        prices = (self.prices.usd(Usage(tokens_in=tokens_in)), self.prices.usd(Usage(tokens_out=most)))
        return Estimate(tokens_in, most, *prices)

    def _reckoned(self, request: Request) -> float:
        return reckoned(request, self.convention)

    async def answer(self, request: Request) -> Answer:
        """The model's answer, not yet checked against the question.

        Raises:
            ModelUnavailableError: The provider failed until tries or time were used up.
            ConfigError: The key, the model's name, the address, or the request's size is wrong.
            ModelOutputError: It refused, its filter struck, or the answer was cut off.
            BudgetReached: A cap was met before another try.
        """
        # The first request of a loop builds the client, which takes time that is not the service's.
        with before_sending():
            await self._client()
        ticket, started = current_ticket(), time.monotonic()
        # A little earlier than whoever waits, so that the error can say what was tried.
        longest_s = math.inf if ticket.seconds is None else 0.97 * ticket.seconds
        await self._ask_facts(min(self._own_s, longest_s))
        async with Turn(self._turns) as turn:
            return await self._answer(request, ticket, turn, started, started + longest_s)

    async def _answer(self, request: Request, ticket: Ticket, turn: Turn, started: float, ends: float) -> Answer:
        """The answer after as many tries as it needs, at the latest at `ends`; waiting for its turn is not its own time."""
        own_ends = started + self._own_s
        tries, doubts, timed_out, wait_s = 0, 0, 0, 0.0
        while True:
            if self._learned.crowded:
                own_ends += await turn.take()
            with before_sending(first=not tries):
                composed = self._compose(request)
                limit = self._limit(request, ticket)
            if tries:
                ticket.another_try()
            tries += 1
            ticket.sends(composed.sent)
            began = time.monotonic()
            outcome = await self._try(request, composed, limit, min(ends, own_ends) - began)
            if not isinstance(outcome, Fault):
                self._learned.took(time.monotonic() - began)
                return await self._answered(request, composed, outcome, limit, tries, ticket)
            if outcome.billed:
                ticket.book_lost_try(limit)
            if isinstance(outcome.error, ModelTimeoutError):
                timed_out += 1
                if self.settings.adapts:
                    self._learned.too_short(time.monotonic() - began)
            if outcome.crowded and not turn.taken:
                self._learned.crowd()
                continue
            size = self._reckoned(request)
            if doubts < 3 and self._learned.take(outcome, composed, self._thinking, limit, size):
                doubts += 1
                continue
            left = min(ends, own_ends) - time.monotonic()
            wait_s = self._wait(outcome, request, tries)
            again = outcome.retry and tries < self.settings.tries and timed_out < TIMED_OUT_TRIES
            if not again or wait_s > LONGEST_WAIT_S or wait_s >= left:
                raise told(outcome.error, tries, wait_s, left) from None
            await asyncio.sleep(wait_s)

    async def aclose(self) -> None:
        """Close the connections of the running loop; otherwise the loop closes them at its end."""
        held = self._clients.pop(asyncio.get_running_loop(), None)
        if held is not None:
            await held[1].aclose()

    # -- sending ---------------------------------------------------------------------------------------------------

    def _compose(self, request: Request) -> Composed:
        limit = self._learned.max_pictures
        pasted = limit is not None and len(request.pictures) > limit
        told = not self._learned.schemas or self.spec.vendor is None
        return self._composed(request, pasted, told)

    def _composed(self, request: Request, pasted: bool, told: bool) -> Composed:
        return compose(
            request,
            self.convention,
            one_picture=pasted,
            schema_in_words=told,
            limits=self._learned.weight,
            encoding=self.settings.encoding,
            tile_px=self.settings.tile_px,
        )

    @property
    def _thinking(self) -> Thinking | None:
        return self.settings.thinking if self._learned.thinking else None

    def _limit(self, request: Request, ticket: Ticket) -> int:
        """Most tokens that the answer may have, by the settings, the caps and the context.

        Raises:
            ContextTooLongError: The request alone fills the context.
        """
        most = self.settings.max_tokens
        limit = most if ticket.max_out is None else min(most, ticket.max_out)
        try:
            return self._learned.fitted(limit, self._reckoned(request))
        except ContextTooLongError as error:
            raise ContextTooLongError(f"{self.name}: {error}", stage=request.stage) from None

    async def _ask_facts(self, within_s: float) -> None:
        """Ask a server named by its address for its context, before the first request."""
        if self.spec.vendor is not None or not self._learned.facts_wanted:
            return
        self._learned.facts_asked += 1
        self._learned.facts = self._learned.facts or UNKNOWN
        direct = self.local_only or is_loopback(self.spec.base_url)
        ask = functools.partial(
            server_facts, self.spec.service, self.spec.base_url, self.model, self.key,
            timeout_s=min(FACTS_S, within_s / 4), direct=direct,
        )  # fmt: skip
        self._learned.know(await in_thread(ask, name="server facts"))

    async def _try(self, request: Request, composed: Composed, limit: int, left_s: float) -> ModelResponse | Fault:
        """One HTTP request: the library's reply, or what went wrong."""
        longest = max(0.001, min(left_s, self._learned.try_s))
        try:
            async with asyncio.timeout(longest):
                model = await self._client()
                schema = composed.form.schema if self._learned.schemas and library.enforces_schemas(model) else None
                told = schema is None or library.hides_schemas(model)
                if told and self.spec.vendor is not None and self._learned.schemas:
                    composed = self._composed(request, len(composed.sizes_px) < len(request.pictures), True)
                turns = [(as_said(request.previous), self._complaint(request, composed))] if request.feedback else []
                messages = library.messages_of(composed, turns, self.settings.detail)
                return await library.send(model, messages, self._settings(limit), schema, request.contract)
        except TimeoutError:
            text = f"{self.name} gave no whole reply within {longest:.3g} s (--timeout S, timeout=S, allows more)"
            return Fault(ModelTimeoutError(text), True, billed=True)
        except WonderfulTeamError:
            raise
        except Exception as error:  # noqa: BLE001  every fault of the library or the wire is sorted
            refused = key_refused(self.spec.base_url, self.key, self.key_holder)
            return fault_of(error, self.name, self.spec.base_url, refused)

    def _settings(self, max_tokens: int) -> dict[str, Any]:
        thinking, service = self._thinking, self.spec.service
        switch = {} if thinking is None else service.think(thinking, self._learned.facts or UNKNOWN)
        return {"max_tokens": max_tokens, **service.settings, **switch}

    def _complaint(self, request: Request, composed: Composed) -> str:
        """What was wrong with the last answer, in a further turn."""
        text = f"Your answer does not fit: {request.feedback}\nAnswer again, whole, in the same form."
        if composed.form.has_places and composed.convention.unit != "pixels":
            text += (
                " Numbers in this message are pixels of the picture; "
                f"your answer's positions are {composed.form.describe()}."
            )
        return text

    async def _client(self) -> Any:
        """The library's model on connections that belong to the running loop; the loop closes them when it ends."""
        loop = asyncio.get_running_loop()
        held = self._clients.get(loop)
        if held is None:
            service = self.spec.service
            if not library.is_loaded(service):
                await in_thread(library.loaded, service, self.spec.text, name="client library")
            # While that was waited for, another request may have built it.
            held = self._clients.get(loop)
        if held is None:
            client = library.http_client(self.spec, self.key, self.local_only)
            keeper = _keep_open(client)
            await anext(keeper)
            held = (library.build_model(self.spec, self.model, self.key, client), keeper)
            self._clients[loop] = held
        return held[0]

    def _wait(self, fault: Fault, request: Request, tries: int) -> float:
        """How long to pause: what the provider asked for, else doubling, spread by request so that none march in step."""
        if fault.wait_s is not None:
            return max(0.0, fault.wait_s)
        spread = hashlib.sha256(f"{request.id}:{request.sample}:{tries}".encode()).digest()[0] / 255
        return float(min(self.settings.first_wait_s * 2 ** (tries - 1) * (0.75 + 0.5 * spread), LONGEST_WAIT_S))

    # -- reading ---------------------------------------------------------------------------------------------------

    async def _answered(
        self, request: Request, composed: Composed, response: ModelResponse, limit: int, tries: int, ticket: Ticket
    ) -> Answer:
        from pydantic_ai.messages import TextPart, ThinkingPart

        said = "".join(part.content for part in response.parts if isinstance(part, TextPart))
        thought = "".join(part.content for part in response.parts if isinstance(part, ThinkingPart))
        said, thought = (encodable(redact_known(text)) for text in (said, thought))
        usage = self._usage(request, response, said, thought, tries)
        ticket.answered = usage
        await self._check_whole(request, composed, response.usage.input_tokens)
        details = response.provider_details or {}
        if response.finish_reason == "content_filter" or details.get("refusal"):
            raise declined(self.name, request, details, said)
        value: Any
        repairs: tuple[str, ...] = ()
        try:
            reading = self._read(composed, said, thought)
            value, repairs = reading.value, reading.repairs
        except ValueError as error:
            value = Unreadable(str(error), said)
        if response.finish_reason == "length" and not _whole(request, value):
            # Half an answer may still hold a whole object inside: that is no wrong answer to send back, but a cut one.
            raise self._cut_off(request, limit, ticket)
        model = response.model_name or self.model
        notices = (*self._learned.told(), *([composed.notice] if composed.notice else []))
        return Answer(value, usage, model, said, repairs=repairs, notices=notices)

    async def _check_whole(self, request: Request, composed: Composed, counted: int) -> None:
        """Refuse the answer to a request that the server has cut without a word; servers named by address may."""
        if self.spec.vendor is not None:
            return
        # An Ollama says how long its context is once the model is loaded.
        await self._ask_facts(FACTS_S)
        characters = len(composed.system) + sum(len(piece) for piece in composed.pieces if isinstance(piece, str))
        try:
            self._learned.check_whole(counted, characters / MOST_CHARACTERS_PER_TOKEN)
        except ContextTooLongError as error:
            raise ContextTooLongError(f"{self.name}: {error}", stage=request.stage) from None

    def _read(self, composed: Composed, said: str, thought: str) -> Reading:
        if said.strip() or "{" not in thought:
            return composed.read(said)
        # Some servers route the whole answer of a thinking model into its thinking.
        reading = composed.read(thought)
        return Reading(reading.value, (*reading.repairs, "the answer stood in the model's thinking"))

    def _cut_off(self, request: Request, limit: int, ticket: Ticket) -> WonderfulTeamError:
        if ticket.max_out is not None and limit == ticket.max_out < self.settings.max_tokens:
            return BudgetReached(
                f"the answer to {request.contract} was cut off at {limit} tokens: no more were left under {ticket.held_by}"
            )
        why = "thinking included" if limit == self.settings.max_tokens else "all that the model or its context leaves"
        return ModelCutOffError(
            f"{self.name}: the answer to {request.contract} was cut off at {limit} tokens ({why})", stage=request.stage
        )

    def _usage(self, request: Request, response: ModelResponse, said: str, thought: str, tries: int) -> Usage:
        """Tokens and money as the service reports them; where it reports none, what was reckoned beforehand."""
        usage = usage_of(response.usage, said, thought, self._learned.careful(self._reckoned(request)))
        if response.usage.input_tokens:
            self._learned.count(response.usage.input_tokens, self._reckoned(request))
        return replace(usage, calls=tries, pictures=len(request.pictures), usd=self.prices.usd(usage))


async def _keep_open(client: Any) -> AsyncGenerator[None]:
    """Holds a connection pool; asyncio ends async generators when a loop shuts down, and so the pool is closed."""
    try:
        yield
    finally:
        await client.aclose()


def _whole(request: Request, value: Any) -> bool:
    """Whether a value has everything that the question asks for."""
    try:
        request.output.model_validate(value)
    except ValueError:
        return False
    return True
