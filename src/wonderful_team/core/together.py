"""Run independent requests at once; the first failure cancels the rest and is raised as it is."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Iterable, Iterator, Sequence
from typing import TypeVar

T = TypeVar("T")
U = TypeVar("U")


async def together(jobs: Iterable[Awaitable[T]]) -> list[T]:
    """Results in the order of the jobs, whatever order they finish in."""
    tasks = [asyncio.ensure_future(job) for job in jobs]
    try:
        return list(await asyncio.gather(*tasks))
    except BaseException:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        raise


def batches(items: Sequence[T], most: int) -> Iterator[Sequence[T]]:
    """As few parts as possible, in order and of nearly the same size, none of more than `most` items."""
    count = -(-len(items) // max(most, 1))
    for part in range(count):
        yield items[part * len(items) // count : (part + 1) * len(items) // count]


async def both(first: Awaitable[T], second: Awaitable[U]) -> tuple[T, U]:
    """Like together, for two jobs with results of different types."""
    one, two = asyncio.ensure_future(first), asyncio.ensure_future(second)
    await together([one, two])
    return one.result(), two.result()
