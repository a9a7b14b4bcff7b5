"""Requests and models that the tests of cache and replay share, also between processes."""

from __future__ import annotations

import asyncio
import time
from pathlib import Path
from typing import Any

import numpy as np

from wonderful_team.contracts import ReviewPath
from wonderful_team.core.geometry import Frame
from wonderful_team.core.pictures import Axes, Mark, Picture
from wonderful_team.core.values import Answer, Request, Subgoal, Usage, Words
from wonderful_team.images import Ticks
from wonderful_team.models.cache import Cached
from wonderful_team.models.cache_store import CacheStore
from wonderful_team.models.client import ModelClient

GOOD = {"reasoning": "it is free", "accepted": True, "problem": ""}
CONTRADICTION = {"reasoning": "", "accepted": True, "problem": "it is wrong"}


def picture(shade: int = 0, marks: tuple[Mark, ...] = (Axes(),), depth: float | None = None) -> Picture:
    rgb = np.full((64, 64, 3), shade, np.uint8)
    depth_m = None if depth is None else np.full((64, 64), depth, np.float32)
    return Picture("view", rgb, Frame.whole("view", (64, 64)), depth_m, marks)


def request(shown: Picture | None = None, *, words: str = "see", **more: Any) -> Request:
    seen = picture() if shown is None else shown
    question = ReviewPath(Subgoal("G1", "go round"), seen)
    fields = {"id": "0/act/main/ReviewPath/1", "system": "You plan.", "output": question.output(), **more}
    return Request(stage="act", role="supervisor", question=question, parts=(Words(words), seen), **fields)


class Paid:
    """A model of a vendor, as the cache sees one: it has an identity and draws pictures itself."""

    name = "vendor:model"
    ticks = Ticks.PIXELS

    def __init__(self, answers: Any = None, identity: Any = None, delay_s: float = 0.0) -> None:
        self.identity = identity or {"model": "model", "server": "https://api", "thinking": "low"}
        self.answers = answers if isinstance(answers, list) else [answers or GOOD]
        self.delay_s = delay_s
        self.calls = 0

    async def answer(self, asked: Request) -> Answer:
        self.calls += 1
        if self.delay_s:
            await asyncio.sleep(self.delay_s)
        value = self.answers[min(self.calls, len(self.answers)) - 1]
        if isinstance(value, BaseException):
            raise value
        return Answer(value, Usage(1, 100, 0, 0, 10, usd=0.01), "model-2026", raw="as it came")


def ask(model: Any, asked: Request | None = None, **options: Any) -> Answer:
    return asyncio.run(ModelClient(model, **options).ask(asked or request()))


def fill(file: Path, first: int, count: int) -> None:
    """What one of several processes does: ask many questions, some of which the others ask too."""
    model = Cached(Paid(), CacheStore(file))
    for number in range(first, first + count):
        ask(model, request(words=f"question {number}"))


def fill_for_ever(file: Path) -> None:
    """Writes until it is killed."""
    model = Cached(Paid(), CacheStore(file))
    for number in range(10**9):
        ask(model, request(words=f"{number} " + "x" * 20000))


def hold(file: Path, seconds: float) -> None:
    """Keeps the file locked for a while."""
    store = CacheStore(file)
    with store._told() as connection:
        connection.execute("BEGIN EXCLUSIVE")
        time.sleep(seconds)
        connection.execute("COMMIT")
