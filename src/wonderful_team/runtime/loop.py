"""One event loop for a whole rollout, also where one is running already (a notebook)."""

from __future__ import annotations

import asyncio
import inspect
import threading
from collections.abc import Awaitable
from types import TracebackType
from typing import Any


class Caller:
    """Call plain or async functions from synchronous code and wait for their result.

    Clients of models keep connections that belong to one event loop, so all calls of a rollout share one. Where the
    calling thread runs a loop already, ours lives in a thread of its own; the world stays in the calling thread.
    """

    def __enter__(self) -> Caller:
        self._runner = asyncio.Runner()
        self._loop: asyncio.AbstractEventLoop | None = None
        if _loop_is_running():
            self._loop = asyncio.new_event_loop()
            self._thread = threading.Thread(target=self._loop.run_forever, name="rollout", daemon=True)
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._loop is not None:
            asyncio.run_coroutine_threadsafe(self._loop.shutdown_asyncgens(), self._loop).result()
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join()
            self._loop.close()
        self._runner.close()

    def wait_for(self, result: Any) -> Any:
        """The value itself, or what it turns into once awaited."""
        if not inspect.isawaitable(result):
            return result
        if self._loop is None:
            return self._runner.run(_as_coroutine(result))
        future = asyncio.run_coroutine_threadsafe(_as_coroutine(result), self._loop)
        try:
            return future.result()
        except BaseException:
            future.cancel()
            raise


async def _as_coroutine(awaitable: Awaitable[Any]) -> Any:
    return await awaitable


def _loop_is_running() -> bool:
    try:
        asyncio.get_running_loop()
    except RuntimeError:
        return False
    return True
