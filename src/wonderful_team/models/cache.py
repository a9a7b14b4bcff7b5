"""A model that remembers: the same request to the same model costs once.

Only answers that fit their question are kept: a refused, cut-off or invalid one is asked for anew. Identical requests
under way at the same time are sent once.
"""

from __future__ import annotations

import asyncio
import json
import threading
from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, TypeAlias, get_args
from weakref import WeakKeyDictionary

from wonderful_team.core.caps import Estimate
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.protocols import Model
from wonderful_team.core.values import Answer, Provenance, Request, Usage
from wonderful_team.errors import CacheMissError, ConfigError, WonderfulTeamError
from wonderful_team.models.around import AroundModel
from wonderful_team.models.cache_key import request_key
from wonderful_team.models.cache_store import CacheStore, Stored
from wonderful_team.models.client import CheckedAnswer, as_answer, call_model, check_value, checked_answer

CacheMode: TypeAlias = Literal["on", "off", "only"]
CACHE_MODES: tuple[CacheMode, ...] = get_args(CacheMode)
KEPT: frozenset[Provenance] = frozenset({"model", "offline"})
"""Answers of other provenance depend on what no request shows (a truth, a script, a planted fault): never kept."""

FREE = Usage(calls=0, usd=0.0)
"""What a kept answer costs."""
NO_COST = Estimate(0, 0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class _Landing:
    """How a request under way ended: an answer, an error to share, or neither when whoever sent it went away."""

    answer: Answer | None = None
    error: WonderfulTeamError | None = None


class _Flights:
    """Requests under way in this process, by key."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._under_way: dict[str, Future[_Landing]] = {}

    def join(self, key: str) -> tuple[Future[_Landing], bool]:
        """The flight under that key, and whether it is the caller's to make."""
        with self._lock:
            known = self._under_way.get(key)
            if known is not None:
                return known, False
            flight: Future[_Landing] = Future()
            self._under_way[key] = flight
            return flight, True

    def land(self, key: str, flight: Future[_Landing], landing: _Landing) -> None:
        with self._lock:
            del self._under_way[key]
        flight.set_result(landing)


_flights: WeakKeyDictionary[CacheStore, _Flights] = WeakKeyDictionary()
_flights_lock = threading.Lock()


class Cached(AroundModel):
    """A model behind a cache. What it says of itself (name, ticks, identity, …) is what the model says.

    Args:
        model: Asked when the cache holds no answer.
        store: Where answers are kept.
        mode: "on", or "only": the model is never asked.
        repeat: Number of the repetition of a whole trial, from 0: repetitions do not share answers.

    Raises:
        ConfigError: Another mode.
    """

    def __init__(self, model: Model, store: CacheStore, mode: Literal["on", "only"] = "on", *, repeat: int = 0) -> None:
        if mode not in ("on", "only"):
            raise ConfigError(f"cache mode {mode!r}: a model behind a cache is 'on' or 'only'")
        super().__init__(model)
        self.store = store
        self.mode = mode
        self.repeat = repeat
        with _flights_lock:
            self._flights = _flights.setdefault(store, _Flights())
        self._found: WeakKeyDictionary[Request, Answer] = WeakKeyDictionary()

    def __getattr__(self, name: str) -> Any:
        value = super().__getattr__(name)
        return self._reckon if name == "estimate" else value

    def _reckon(self, request: Request) -> Estimate:
        """What a request may cost: nothing when its answer is kept, so that no cap stands in its way."""
        found = self._kept(request_key(request, self.model, self.repeat), request)
        if found is not None:
            # It is asked next: what was read and validated here is its answer.
            self._found[request] = found
            return NO_COST
        reckoned: Estimate = self.model.estimate(request)  # type: ignore[attr-defined]
        return reckoned

    async def answer(self, request: Request) -> Answer:
        """The kept answer, marked `cached` and free of cost, or the model's, kept when it fits the question.

        Raises:
            CacheMissError: Mode "only", and there is none.
            ConfigError: The cache's file became unusable.
        """
        held = self._found.pop(request, None)
        if held is not None:
            await asyncio.sleep(0)
            return held
        key = request_key(request, self.model, self.repeat)
        # Requests that start together must all have started before the first is answered, as with a real model.
        await asyncio.sleep(0)
        while True:
            found = self._kept(key, request)
            if found is not None:
                return found
            if self.mode == "only":
                raise CacheMissError(
                    f"--cache only: {str(self.store.path)!r} holds no answer of {self.name} to {request.contract} "
                    f"({request.id}, try {request.attempt + 1}); run it once with --cache on, or leave out --cache only"
                )
            flight, ours = self._flights.join(key)
            if ours:
                return await self._ask(key, request, flight)
            landing = await asyncio.shield(asyncio.wrap_future(flight))
            if landing.error is not None:
                raise landing.error
            if landing.answer is not None:
                return replace(landing.answer, usage=FREE, provenance="cached")
            # Whoever sent it was cancelled: the next one sends it.

    async def _ask(self, key: str, request: Request, flight: Future[_Landing]) -> Answer:
        landing = _Landing()
        try:
            # Between the look and the flight another one may have landed.
            found = self._kept(key, request)
            if found is None:
                result = as_answer(await call_model(self.model, request), self.model)
                found = self._keep(key, request, result)
            landing = _Landing(found)
            return found
        except WonderfulTeamError as error:
            landing = _Landing(error=error)
            raise
        finally:
            self._flights.land(key, flight, landing)

    def _kept(self, key: str, request: Request) -> Answer | None:
        entry = self.store.get(key)
        if entry is None:
            return None
        try:
            checked = check_value(request, entry.value)
        except ValueError:
            # A stricter release of ours would refuse it: it is asked for anew.
            if self.mode == "on":
                self.store.forget(key)
            return None
        return _from_store(checked, entry, FREE)

    def _keep(self, key: str, request: Request, answer: Answer) -> Answer:
        """Keep an answer that fits; returns the one that stands, as another process may have been first."""
        if answer.provenance not in KEPT:
            return answer
        try:
            checked = checked_answer(request, answer)
        except ValueError:
            return answer
        answer = replace(answer, checked=checked)
        entry = Stored(
            # Before the question settles it: that happens again at each use.
            value=json.loads(checked.parsed.model_dump_json()),
            raw=answer.raw,
            model_id=answer.model_id,
            contract=request.contract,
            repairs=answer.repairs,
            cost=to_jsonable(answer.usage),
        )
        try:
            standing = self.store.put(key, entry)
        except ConfigError as error:
            # It was paid for: a file that cannot be written must not lose it.
            return replace(answer, repairs=(*answer.repairs, f"the answer is not kept: {error}"))
        if standing == entry:
            return answer
        # Ours was paid for all the same.
        return replace(
            _from_store(check_value(request, standing.value), standing, answer.usage), provenance=answer.provenance
        )


def cached_models(
    models: Mapping[str, Model], mode: CacheMode | None, file: str | Path | None = None, *, repeat: int = 0
) -> tuple[dict[str, Model], CacheStore | None]:
    """The same models behind one cache.

    Args:
        models: By role.
        mode: on, off, only; None for the default: on for models of vendors and servers (those with an `identity`),
            off for `offline` and for models of one's own, which cost nothing or are still being written.
        file: The cache's file; None for the default one. It is opened only when some model is cached.
        repeat: See `Cached`.

    Returns:
        The models, and the open cache, or None when nothing is cached.

    Raises:
        ConfigError: An unknown mode, or a file that cannot be used.
    """
    if mode is not None and mode not in CACHE_MODES:
        raise ConfigError(f"cache {mode!r}: valid are {', '.join(CACHE_MODES)}")
    if mode == "off":
        return dict(models), None
    wanted = [model for model in models.values() if mode is not None or getattr(model, "identity", None) is not None]
    if not wanted:
        return dict(models), None
    store = CacheStore(file)
    # One wrapper for one model, whatever number of roles it serves.
    wrapped = {id(model): Cached(model, store, mode or "on", repeat=repeat) for model in wanted}
    return {role: wrapped.get(id(model), model) for role, model in models.items()}, store


def _from_store(checked: CheckedAnswer, entry: Stored, usage: Usage) -> Answer:
    return Answer(
        value=checked.parsed,
        usage=usage,
        model_id=entry.model_id,
        raw=entry.raw,
        provenance="cached",
        repairs=entry.repairs,
        checked=replace(checked, value=checked.parsed),
    )
