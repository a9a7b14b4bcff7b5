"""One event loop for a whole rollout, in a thread of its own."""

from __future__ import annotations

import asyncio
import contextlib
import inspect
from collections.abc import Awaitable
from types import TracebackType
from typing import Any

from wonderful_team.core import deadline
from wonderful_team.core.interrupts import start_thread

MARGIN_S = 0.5
"""Beyond the limit of the run a method may still say what it has so far [s]."""
CLOSE_S = 10.0
"""Longest wait for what the loop still has to end [s]."""
HALT_S = 1.0
"""The same after an error or an interrupt [s]: somebody waits."""


class Caller:
    """Call plain or async functions from synchronous code and wait for their result.

    Clients of models keep connections that belong to one event loop, so all calls of a rollout share one. It lives in a
    thread of its own: that works where a loop is running already (a notebook), and an interrupt reaches the calling
    thread at once, where the world stays.
    """

    def __enter__(self) -> Caller:
        self._loop = asyncio.new_event_loop()
        self._thread = start_thread(_run, self._loop, name="rollout")
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        patience_s = CLOSE_S if kind is None else HALT_S
        limit = deadline.current()
        if limit is not None:
            patience_s = min(patience_s, limit.ending_s)
        ended = asyncio.run_coroutine_threadsafe(_wind_up(), self._loop)
        # What takes longer is left behind: the loop stops as soon as it has ended.
        ended.add_done_callback(lambda _: self._loop.call_soon_threadsafe(self._loop.stop))
        with contextlib.suppress(TimeoutError):
            ended.result(patience_s)
            self._thread.join(patience_s)

    def wait_for(self, result: Any, during: str = "planning") -> Any:
        """The value itself, or what it turns into once awaited.

        Raises:
            BudgetReached: Not within the limit of the run.
        """
        if not inspect.isawaitable(result):
            return result
        limit = deadline.current()
        future = asyncio.run_coroutine_threadsafe(_as_coroutine(result), self._loop)
        try:
            return future.result(None if limit is None else limit.left_s + MARGIN_S)
        except TimeoutError:
            if future.done() or limit is None:
                raise  # it is the method's own
            future.cancel()
            raise limit.reached(during) from None
        except BaseException:
            future.cancel()
            raise


def _run(loop: asyncio.AbstractEventLoop) -> None:
    """Until it is stopped: a method that raises SystemExit ends its own task, not the loop that others wait for."""
    with contextlib.closing(loop):
        while True:
            try:
                return loop.run_forever()
            except (SystemExit, KeyboardInterrupt):
                continue


async def _wind_up() -> None:
    """Cancel what is still running and wait until it has ended."""
    others = asyncio.all_tasks() - {asyncio.current_task()}
    for task in others:
        task.cancel()
    await asyncio.gather(*others, return_exceptions=True)
    await asyncio.get_running_loop().shutdown_asyncgens()
    await asyncio.get_running_loop().shutdown_default_executor()


async def _as_coroutine(awaitable: Awaitable[Any]) -> Any:
    return await awaitable
