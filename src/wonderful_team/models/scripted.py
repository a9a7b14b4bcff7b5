"""A model that says what a script tells it: for tests, for timing the loops, and for trying out one's own agents."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from wonderful_team.core.values import Answer, Request, Usage
from wonderful_team.errors import UnsupportedQuestion


class ScriptedModel:
    """Answers by kind of question.

    Args:
        script: Contract name to an answer, a list of answers (used in turn, the last one repeats), or a function of
            the request. An answer may be a value, an Answer, a dict, JSON text, or an exception to raise.
        delay_s: Fixed time that every answer takes.
    """

    def __init__(
        self,
        script: Mapping[str, Any | Sequence[Any] | Callable[[Request], Any]],
        *,
        delay_s: float = 0.0,
        name: str = "scripted",
    ) -> None:
        self.name = name
        self.requests: list[Request] = []
        self._script = dict(script)
        self._used: dict[str, int] = {}
        self._delay_s = delay_s

    async def answer(self, request: Request) -> Answer:
        """The next scripted answer; UnsupportedQuestion when the script has none for this kind."""
        self.requests.append(request)
        if self._delay_s:
            await asyncio.sleep(self._delay_s)
        if request.contract not in self._script:
            raise UnsupportedQuestion(self.name, request.contract, "the script has no answer for it")
        entry = self._script[request.contract]
        if isinstance(entry, list):
            turn = self._used.get(request.contract, 0)
            self._used[request.contract] = turn + 1
            entry = entry[min(turn, len(entry) - 1)]
        if callable(entry) and not isinstance(entry, type):
            entry = entry(request)
        if isinstance(entry, BaseException):
            raise entry
        if isinstance(entry, Answer):
            return replace(entry, model_id=self.name, provenance="scripted")
        raw = entry if isinstance(entry, str) else ""
        return Answer(value=entry, raw=raw, model_id=self.name, provenance="scripted", usage=Usage(calls=1, usd=0.0))
