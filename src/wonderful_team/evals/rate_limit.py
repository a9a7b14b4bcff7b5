"""One bound on model calls for all workers of a study."""

from __future__ import annotations

import asyncio
from typing import Any


class ProcessLimiter:
    """A semaphore that processes of one machine share."""

    def __init__(self, semaphore: Any) -> None:
        self._semaphore = semaphore

    async def acquire(self) -> None:
        """Wait for a place without blocking the event loop or pinning a thread."""
        while not self._semaphore.acquire(block=False):
            await asyncio.sleep(0.01)

    async def release(self) -> None:
        self._semaphore.release()
