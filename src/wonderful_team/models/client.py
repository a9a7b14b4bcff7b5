"""The client: every question of every method goes through here to a model, and only valid answers come back.

It picks the role's model, enforces the budget and the concurrency limit, validates the answer against the question,
sends the validation text back when it does not fit, and tells subscribers what happened.
"""

from __future__ import annotations

import asyncio
import contextlib
import inspect
import json
import reprlib
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pydantic import BaseModel, ValidationError

from wonderful_team.contracts import Question
from wonderful_team.core.interrupts import in_thread
from wonderful_team.core.protocols import Event, Model, Subscriber
from wonderful_team.core.values import Answer, Request, Usage
from wonderful_team.errors import (
    ConfigError,
    ModelCodeError,
    ModelOutputError,
    ModelUnavailableError,
    WonderfulTeamError,
    code_of,
)
from wonderful_team.images import Ticks
from wonderful_team.models.budget import Budget, Ticket, set_current_ticket
from wonderful_team.models.wire import chat as _chat  # noqa: F401  gives requests their messages()
from wonderful_team.models.wire.unreadable import Unreadable
from wonderful_team.redaction import redact_all, redact_known

UNSENT = frozenset({"cached", "replayed"})
"""Provenance of answers for which no model was called: they cost nothing."""
DEADLINE_S = 300.0
"""Longest time for one request to a model that has no deadline of its own."""
DEFAULT = "*"
"""Key of the model that serves every role without one of its own."""


class ModelClient:
    """Ask models questions.

    Args:
        models: One model for all roles, or a mapping from role to model with "*" for the rest.
        attempts: How often an answer may be tried, the first try included.
        concurrency: Most requests in flight at once.
        deadline_s: Longest time for one whole request; a model's own `deadline_s` counts where it is longer.

    Raises:
        ConfigError: No model serves some role, or a number is not positive.
    """

    def __init__(
        self,
        models: Model | Mapping[str, Model],
        *,
        budget: Budget | None = None,
        subscribers: Sequence[Subscriber] = (),
        attempts: int = 3,
        concurrency: int = 8,
        deadline_s: float = DEADLINE_S,
    ) -> None:
        if attempts < 1 or concurrency < 1 or deadline_s <= 0:
            raise ConfigError(
                f"attempts, concurrency and deadline_s must be positive, got {attempts}, {concurrency}, {deadline_s}"
            )
        self._models: Mapping[str, Model] = models if isinstance(models, Mapping) else {DEFAULT: models}
        for role, model in self._models.items():
            if not hasattr(model, "answer"):
                raise ConfigError(f"the model for {role!r} is a {type(model).__name__} without answer(request)")
        self.budget = budget or Budget()
        self._subscribers = tuple(subscribers)
        self._attempts = attempts
        self._deadline_s = deadline_s
        self._concurrency = concurrency
        self._places: asyncio.Semaphore | None = None
        self._loop: asyncio.AbstractEventLoop | None = None

    def model_for(self, role: str) -> Model:
        """The model that serves a role."""
        model = self._models.get(role, self._models.get(DEFAULT))
        if model is None:
            raise ConfigError(f"no model for role {role!r}; models are set for: {', '.join(self._models)}")
        return model

    def picture_limit(self, role: str) -> int | None:
        """Most pictures in one request to the model that serves a role; None where nothing is known."""
        limit = getattr(self.model_for(role), "picture_limit", None)
        return limit if isinstance(limit, int) and limit > 0 else None

    @property
    def model_name(self) -> str:
        """The model's name; where roles have different ones, role=name for each."""
        names = {_name(model) for model in self._models.values()}
        if len(names) == 1:
            return names.pop()
        return " ".join(f"{role}={_name(model)}" for role, model in self._models.items())

    def tell(self, kind: str, name: str, content: Any = None) -> None:
        """Pass an event to every subscriber."""
        for subscriber in self._subscribers:
            subscriber.on_event(Event(kind, name, content))

    async def ask(self, request: Request) -> Answer:
        """The validated answer to a request.

        Raises:
            ModelOutputError: No attempt gave a valid answer.
            ModelUnavailableError: The deadline passed or the provider failed.
            BudgetReached: A cap was met before sending.
        """
        model = self.model_for(request.role)
        total = Usage()
        for attempt in range(self._attempts):
            sent = replace(request, attempt=attempt)
            answer = await self._send(model, sent)
            total = total + answer.usage
            for notice in answer.notices:
                self.tell("warning", sent.id, f"{_name(model)}: {notice}")
            try:
                value, repairs = checked_answer(sent, answer).settled
            except (ValueError, RecursionError, OverflowError) as error:
                text = _explain(error)
                self.tell("invalid", sent.id, (sent, answer.raw or _as_text(answer.value), text))
                request = replace(request, feedback=text, previous=answer.raw or _plain(answer.value))
                continue
            settled = replace(
                answer, value=value, usage=total, tries=attempt + 1, repairs=answer.repairs + repairs, checked=None
            )
            self.tell("answer", sent.id, (sent, settled))
            for repair in repairs:
                self.tell("warning", sent.id, f"{sent.id}: {repair}")
            return settled
        raise ModelOutputError(
            f"{_name(model)} gave no valid answer to {request.contract} in {self._attempts} attempts; "
            f"the last problem: {request.feedback}",
            stage=request.stage,
        )

    async def _send(self, model: Model, request: Request) -> Answer:
        async with self._place():
            budget = self.budget
            with model_code(model):
                # Not isinstance with a protocol: from Python 3.12 on it misses what a wrapper forwards, and caps would fail open.
                reckon = getattr(model, "estimate", None)
                estimate = reckon(request) if callable(reckon) else None
            ticket = await budget.take(estimate)
            usage = None
            started = time.monotonic()
            ticket.hear = lambda pictures: self.tell("sent", request.id, (request, pictures))
            try:
                self.tell("request", request.id, request)
                if not isinstance(getattr(model, "ticks", None), Ticks):
                    # It draws nothing itself: it is handed the request.
                    self._tell_drawn(request, ticket, Ticks.PIXELS)
                left = budget.seconds_left
                # A service knows how long its own tries may take.
                most_s = max(self._deadline_s, float(getattr(model, "deadline_s", 0.0)))
                longest_s = most_s if left is None else max(0.001, min(most_s, left))
                ticket.seconds = longest_s
                set_current_ticket(ticket)
                try:
                    answer = as_answer(await asyncio.wait_for(call_model(model, request), longest_s), model)
                except TimeoutError as error:
                    ticket.book_lost_try()
                    if left is not None and longest_s < most_s:
                        raise budget.time_is_up(f"asking {_name(model)} to {request.contract}") from error
                    raise ModelUnavailableError(
                        f"{_name(model)} did not answer {request.contract} within {most_s:g} s"
                    ) from error
                self._tell_drawn(request, ticket, getattr(model, "ticks", Ticks.PIXELS))
                seconds = time.monotonic() - started
                if answer.provenance in UNSENT:
                    usage = Usage(seconds=seconds)
                else:
                    usage = replace(
                        answer.usage, calls=max(1, answer.usage.calls), pictures=len(request.pictures), seconds=seconds
                    )
                return replace(answer, usage=usage + ticket.lost)
            except asyncio.CancelledError:
                ticket.book_lost_try()
                raise
            except WonderfulTeamError as error:
                if not error.sent:
                    usage = Usage(seconds=time.monotonic() - started)
                self._tell_drawn(request, ticket, getattr(model, "ticks", Ticks.PIXELS))
                self.tell("failed", request.id, (request, error))
                raise
            finally:
                budget.settle(request.role, usage or _failed_usage(request, ticket, started), ticket)

    def _tell_drawn(self, request: Request, ticket: Ticket, ticks: Ticks) -> None:
        """Say how pictures look that nobody sent, once."""
        if request.pictures and not ticket.sent:
            ticket.sent = True
            self.tell("drawn", request.id, (request, ticks))

    def _place(self) -> asyncio.Semaphore:
        # A semaphore belongs to one event loop; each synchronous entry may bring a new one.
        loop = asyncio.get_running_loop()
        if self._places is None or self._loop is not loop:
            self._places, self._loop = asyncio.Semaphore(self._concurrency), loop
        return self._places


def _failed_usage(request: Request, ticket: Ticket, started: float) -> Usage:
    """What a call cost that brought no answer; lost tries are booked beside it."""
    seconds, pictures = time.monotonic() - started, len(request.pictures)
    if ticket.answered is not None:
        return replace(ticket.answered, seconds=seconds)
    priced = ticket.estimate is not None and ticket.estimate.usd_in is not None
    return Usage(ticket.tries, pictures=pictures, seconds=seconds, usd=0.0 if priced else None)


async def call_model(model: Model, request: Request) -> Any:
    """What a model's `answer` returns, be it plain (then in a thread) or async.

    Raises:
        ModelCodeError: It raised something that says nothing of whose fault it is.
    """

    def plain(asked: Request) -> Any:
        with model_code(model):
            return model.answer(asked)

    with model_code(model):
        if inspect.iscoroutinefunction(model.answer):
            return await model.answer(request)
        # A plain function would block every other request: it runs in a thread.
        result = await in_thread(plain, request, name="model")
        return await result if inspect.isawaitable(result) else result


def model_code(model: Model) -> contextlib.AbstractContextManager[None]:
    """Whatever the code of a model raises is the model's: never a defect of ours, never the method's failure."""
    return code_of(f"the code of model {_name(model)!r}", ModelCodeError)


def as_answer(result: Any, model: Model) -> Answer:
    """What a model returned, as an Answer; values that are no Answer are taken as its value."""
    if isinstance(result, Answer):
        if not isinstance(result.usage, Usage):
            raise ModelCodeError(
                f"model {_name(model)!r} answered with usage {type(result.usage).__name__}; valid: a wt.Usage"
            )
        return replace(
            result, model_id=redact_known(result.model_id or _name(model)), raw=redact_known(str(result.raw))
        )
    raw = redact_known(result) if isinstance(result, str) else ""
    return Answer(value=result, model_id=_name(model), raw=raw, usage=Usage(calls=1, usd=None))


@dataclass(frozen=True, eq=False)
class CheckedAnswer:
    """A value that was validated against a question.

    Attributes:
        value: What was validated; whoever changes an answer's value on the way has it validated anew.
        parsed: An instance of the answer's type, as the model said it.
        settled: The value as it is used, and what was clamped or repaired for that.
    """

    question: Any
    output: type[Any]
    value: Any
    parsed: Any
    settled: tuple[Any, tuple[str, ...]]


def checked_answer(request: Request, answer: Answer) -> CheckedAnswer:
    """An answer validated against its request, once: a cache on the way may have done it for this very question.

    Raises:
        ValueError: It does not fit; the text is for the model.
    """
    held = answer.checked
    if isinstance(held, CheckedAnswer) and held.value is answer.value:
        if held.question is request.question and held.output is request.output:
            return held
    return check_value(request, answer.value)


def validate_answer(request: Request, value: Any) -> tuple[Any, tuple[str, ...]]:
    """Validate a value against the request's type and question. Raises ValueError with text for the model."""
    return check_value(request, value).settled


def check_value(request: Request, value: Any) -> CheckedAnswer:
    """What a value is by the request's type and question. Raises ValueError with text for the model."""
    said, output = value, request.output
    if isinstance(value, Unreadable):
        raise ValueError(value.problem)
    try:
        # A model of one's own may have read a key, as a server may echo it.
        value = redact_all(_plain(value), looks=False)
    except RecursionError as error:
        raise ValueError(_explain(error)) from error
    parsed = output.model_validate_json(value) if isinstance(value, str) else output.model_validate(value)
    question = request.question
    settled = question.validate(parsed) if isinstance(question, Question) else (parsed, ())
    return CheckedAnswer(question, output, said, parsed, settled)


def _plain(value: Any) -> Any:
    return value.model_dump() if isinstance(value, BaseModel) else value


def _as_text(value: Any) -> str:
    try:
        return json.dumps(_plain(value))
    except (TypeError, ValueError, RecursionError):
        return reprlib.repr(value)


def _explain(error: Exception) -> str:
    if isinstance(error, RecursionError):
        return "the answer is nested too deeply"
    if not isinstance(error, ValidationError):
        return str(error)
    lines = (
        f"{'.'.join(map(str, item['loc'])) or 'answer'}: {item['msg']}" for item in error.errors(include_url=False)
    )
    return "; ".join(lines)


def _name(model: Model) -> str:
    return str(getattr(model, "name", type(model).__name__))
