"""A vendor's model or a server as a model: one request out, one answer back, every fault typed, every try counted."""

from __future__ import annotations

import asyncio
import hashlib
import json
import math
import time
from collections.abc import AsyncGenerator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from wonderful_team.core.caps import Estimate
from wonderful_team.core.values import Answer, Request, Usage, Words
from wonderful_team.errors import (
    BudgetReached,
    ContentFilterError,
    ModelCutOffError,
    ModelRefusalError,
    ModelTimeoutError,
    WonderfulTeamError,
)
from wonderful_team.images import Ticks
from wonderful_team.models.budget import Ticket, current_ticket
from wonderful_team.models.conventions import Convention
from wonderful_team.models.prices import Prices
from wonderful_team.models.providers import library
from wonderful_team.models.providers.faults import Fault, fault_of, scrubbed
from wonderful_team.models.providers.settings import LONGEST_WAIT_S, Settings
from wonderful_team.models.providers.specs import SERVER_KEY, Spec
from wonderful_team.models.wire import Composed, Reading, Unreadable, compose, encodable, ticks_of

if TYPE_CHECKING:
    from pydantic_ai.messages import ModelResponse

CHARACTERS_PER_TOKEN = 3.0
PIXELS_PER_TOKEN = 500.0
"""On the careful side for every vendor's way of counting pictures; corrected by what the service reports."""


@dataclass
class _Learned:
    """What the service taught while it was asked: it is told once, not before every request."""

    schemas: bool
    max_pictures: int | None
    tokens_ratio: float = 1.0


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
        self._learned = _Learned(self.settings.schemas, self.settings.max_pictures)

    @property
    def ticks(self) -> Ticks:
        """What numbers on drawn axes mean where the answer holds places."""
        return ticks_of(self.convention)

    @property
    def identity(self) -> Mapping[str, Any]:
        """What decides the answer beside the request: for cache keys and records."""
        return {
            "model": self.model,
            "api": self.spec.api,
            "server": self.spec.base_url,
            "thinking": self.settings.thinking,
            "max_tokens": self.settings.max_tokens,
            "schemas": self.settings.schemas,
            "max_pictures": self.settings.max_pictures,
            "convention": repr(self.convention),
            "library": library.library_version(),
        }

    @property
    def picture_limit(self) -> int | None:
        """Most pictures in one request, as set or as the service told; None when nothing is known."""
        return self._learned.max_pictures

    @property
    def schemas_refused(self) -> bool:
        """The service does not take schemas: they are told in words only."""
        return not self._learned.schemas

    def estimate(self, request: Request) -> Estimate:
        """What a request may cost at most, before it is sent (see `Budget`)."""
        characters = len(request.system) + sum(len(part.text) for part in request.parts if isinstance(part, Words))
        characters += 1500 + len(request.feedback)
        pixels = 0.0
        for picture in request.pictures:
            width, height = self.convention.seen_size(picture.size_px)
            pixels += width * height + 150_000
        tokens_in = (characters / CHARACTERS_PER_TOKEN + pixels / PIXELS_PER_TOKEN) * self._learned.tokens_ratio
        most = self.settings.max_tokens
        prices = (self.prices.usd(Usage(tokens_in=round(tokens_in))), self.prices.usd(Usage(tokens_out=most)))
        return Estimate(round(tokens_in), most, *prices)

    async def answer(self, request: Request) -> Answer:
        """The model's answer, not yet checked against the question.

        Raises:
            ModelUnavailableError: The provider failed until tries or time were used up.
            ConfigError: The key, the model's name, the address, or the request's size is wrong.
            ModelOutputError: It refused, its filter struck, or the answer was cut off.
            BudgetReached: A cap was met before another try.
        """
        # The first request of a loop builds the client, which takes time that is not the service's.
        await self._client()
        started = time.monotonic()
        ticket = current_ticket()
        # A little earlier than whoever waits, so that the error can say what was tried.
        deadline_s = min(self.settings.deadline_s, math.inf if ticket.seconds is None else 0.97 * ticket.seconds)
        composed = self._compose(request)
        tries, doubts = 0, 0
        while True:
            if tries:
                ticket.another_try()
            tries += 1
            left = deadline_s - (time.monotonic() - started)
            outcome = await self._try(request, composed, ticket, left)
            if not isinstance(outcome, Fault):
                return self._answered(request, composed, outcome, tries, ticket)
            if outcome.billed:
                ticket.book_lost_try()
            if self._learn(outcome, composed) and doubts < 3:
                doubts += 1
                composed = self._compose(request)
                continue
            left = deadline_s - (time.monotonic() - started)
            wait_s = self._wait(outcome, request, tries)
            if not outcome.retry or tries >= self.settings.tries or wait_s > LONGEST_WAIT_S or wait_s >= left:
                raise _told(outcome.error, tries, wait_s, left) from None
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
        return compose(request, self.convention, one_picture=pasted, schema_in_words=told)

    async def _try(
        self, request: Request, composed: Composed, ticket: Ticket, left_s: float
    ) -> tuple[ModelResponse, int] | Fault:
        """One HTTP request: the library's reply with the limit of tokens it had, or what went wrong."""
        limit = self.settings.max_tokens if ticket.max_out is None else min(self.settings.max_tokens, ticket.max_out)
        # A hang must leave time for another try.
        longest = max(0.001, min(left_s, self.settings.deadline_s / 2 if self.settings.tries > 1 else left_s))
        try:
            async with asyncio.timeout(longest):
                model = await self._client()
                schema = composed.form.schema if self._learned.schemas and library.enforces_schemas(model) else None
                told = schema is None or library.hides_schemas(model)
                if told and self.spec.vendor is not None and self._learned.schemas:
                    composed = compose(
                        request, self.convention, one_picture=len(composed.sizes_px) < len(request.pictures),
                        schema_in_words=True,
                    )  # fmt: skip
                turns = [(_as_said(request.previous), self._complaint(request, composed))] if request.feedback else []
                messages = library.messages_of(composed, turns)
                return await library.send(model, messages, self._settings(limit), schema, request.contract), limit
        except TimeoutError:
            return Fault(
                ModelTimeoutError(f"{self.name} gave no whole reply within {longest:.3g} s"), True, billed=True
            )
        except WonderfulTeamError:
            raise
        except Exception as error:  # noqa: BLE001  every fault of the library or the wire is sorted
            return fault_of(error, self.name, self.spec.base_url, self.key, self.key_holder)

    def _settings(self, max_tokens: int) -> dict[str, Any]:
        settings: dict[str, Any] = {"max_tokens": max_tokens, "max_retries": 0}
        thinking = self.settings.thinking
        if self.spec.api == "google":
            # Google's client takes no such setting; it does not try again by itself.
            settings.pop("max_retries")
        if self.spec.api == "openai-responses":
            settings["openai_store"] = False
        if thinking is not None and self.spec.vendor is None:
            # Servers have no common switch: this is the one of vLLM, SGLang and llama.cpp for models that think.
            body: dict[str, Any] = {"chat_template_kwargs": {"enable_thinking": thinking != "off"}}
            if thinking != "off":
                body["reasoning_effort"] = thinking
            settings["extra_body"] = body
        elif thinking is not None:
            settings["thinking"] = False if thinking == "off" else thinking
        return settings

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
            client = library.http_client(self.spec, self.key, self.settings.deadline_s, self.local_only)
            keeper = _keep_open(client)
            await anext(keeper)
            held = (library.build_model(self.spec, self.model, self.key, client), keeper)
            self._clients[loop] = held
        return held[0]

    def _learn(self, fault: Fault, composed: Composed) -> bool:
        """Take in what the service refused; True when the request should be sent in another form."""
        if fault.schema:
            # Perhaps another request that is under way has learned it already: this one was still sent with a schema.
            self._learned.schemas = False
            return True
        if fault.picture_limit is not None and len(composed.sizes_px) > 1:
            self._learned.max_pictures = min(fault.picture_limit or 1, len(composed.sizes_px) - 1)
            return True
        return False

    def _wait(self, fault: Fault, request: Request, tries: int) -> float:
        """How long to pause: what the provider asked for, else doubling, spread by request so that none march in step."""
        if fault.wait_s is not None:
            return max(0.0, fault.wait_s)
        spread = hashlib.sha256(f"{request.id}:{request.sample}:{tries}".encode()).digest()[0] / 255
        return float(min(self.settings.first_wait_s * 2 ** (tries - 1) * (0.75 + 0.5 * spread), LONGEST_WAIT_S))

    # -- reading ---------------------------------------------------------------------------------------------------

    def _answered(
        self, request: Request, composed: Composed, reply: tuple[ModelResponse, int], tries: int, ticket: Ticket
    ) -> Answer:
        from pydantic_ai.messages import TextPart, ThinkingPart

        response, limit = reply
        said = "".join(part.content for part in response.parts if isinstance(part, TextPart))
        thought = "".join(part.content for part in response.parts if isinstance(part, ThinkingPart))
        said, thought = (encodable(scrubbed_key(text, self.key)) for text in (said, thought))
        usage = self._usage(request, response, said, thought, tries)
        ticket.answered = usage
        details = response.provider_details or {}
        if response.finish_reason == "content_filter" or details.get("refusal"):
            raise self._declined(request, details, said)
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
        return Answer(value, usage, response.model_name or self.model, said, repairs=repairs)

    def _read(self, composed: Composed, said: str, thought: str) -> Reading:
        if said.strip() or "{" not in thought:
            return composed.read(said)
        # Some servers route the whole answer of a thinking model into its thinking.
        reading = composed.read(thought)
        return Reading(reading.value, (*reading.repairs, "the answer stood in the model's thinking"))

    def _declined(self, request: Request, details: Mapping[str, Any], said: str) -> WonderfulTeamError:
        why = str(details.get("refusal") or "")
        reason = str(details.get("finish_reason") or "")
        text = scrubbed(why or said, self.key)[:200]
        if why or "refusal" in reason:
            return ModelRefusalError(f"{self.name} refused to answer {request.contract}: {text}", stage=request.stage)
        kind = reason or "content_filter"
        return ContentFilterError(
            f"{self.name}: a content filter stopped the answer to {request.contract} ({kind})", stage=request.stage
        )

    def _cut_off(self, request: Request, limit: int, ticket: Ticket) -> WonderfulTeamError:
        if limit < self.settings.max_tokens:
            return BudgetReached(
                f"the answer to {request.contract} was cut off at {limit} tokens: no more were left under the caps"
            )
        return ModelCutOffError(
            f"{self.name}: the answer to {request.contract} was cut off at {limit} tokens (thinking included)",
            stage=request.stage,
        )

    def _usage(self, request: Request, response: ModelResponse, said: str, thought: str, tries: int) -> Usage:
        """Tokens and money as the service reports them; where it reports none, what was reckoned beforehand."""
        reported, reckoned = response.usage, self.estimate(request)
        details = reported.details or {}
        thinking = next((details[name] for name in ("reasoning_tokens", "thoughts_tokens") if details.get(name)), 0)
        if thought and not thinking:
            # Many servers show the thinking but do not count it apart.
            thinking = min(reported.output_tokens, math.ceil(len(thought) / CHARACTERS_PER_TOKEN))
        if reported.input_tokens or reported.output_tokens:
            usage = Usage(
                tries,
                tokens_in=reported.input_tokens,
                tokens_cached=reported.cache_read_tokens,
                tokens_thinking=thinking,
                tokens_out=max(0, reported.output_tokens - thinking),
                pictures=len(request.pictures),
            )
            if reckoned.tokens_in:
                ratio = self._learned.tokens_ratio * reported.input_tokens / reckoned.tokens_in
                self._learned.tokens_ratio = min(100.0, max(self._learned.tokens_ratio, ratio))
        else:
            out = round(len(said) / CHARACTERS_PER_TOKEN)
            usage = Usage(tries, reckoned.tokens_in, tokens_out=out, pictures=len(request.pictures))
        return replace(usage, usd=self.prices.usd(usage))


def scrubbed_key(text: str, key: str | None) -> str:
    """What a model said, without the key (a server may echo it)."""
    return text.replace(key, "[key]") if key and len(key) > 3 else text


async def _keep_open(client: Any) -> AsyncGenerator[None]:
    """Holds a connection pool; asyncio ends async generators when a loop shuts down, and so the pool is closed."""
    try:
        yield
    finally:
        await client.aclose()


def _told(error: WonderfulTeamError, tries: int, wait_s: float, left_s: float) -> WonderfulTeamError:
    """The error with what was tried."""
    extra = ""
    if tries > 1:
        extra = f"; {tries} tries"
    if wait_s > LONGEST_WAIT_S:
        extra += f"; it asks to wait {wait_s:.0f} s, at most {LONGEST_WAIT_S:.0f} s are waited"
    elif wait_s >= left_s:
        extra += "; no time is left for another try"
    return type(error)(f"{error}{extra}", stage=error.stage) if extra else error


def _as_said(previous: Any) -> str:
    if isinstance(previous, str):
        return previous
    return json.dumps(previous, default=str)


def _whole(request: Request, value: Any) -> bool:
    """Whether a value has everything that the question asks for."""
    try:
        request.output.model_validate(value)
    except ValueError:
        return False
    return True
