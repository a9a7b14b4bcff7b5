"""One request at a time, for a service whose requests share what is too little for several."""

from __future__ import annotations

import asyncio
import time
from weakref import WeakKeyDictionary


class Turns:
    """Whose turn it is, among the requests of one event loop."""

    def __init__(self) -> None:
        self._locks: WeakKeyDictionary[asyncio.AbstractEventLoop, asyncio.Lock] = WeakKeyDictionary()
        self.ahead = 0
        """Requests that have a turn or wait for one."""

    def lock(self) -> asyncio.Lock:
        """The running loop's lock."""
        return self._locks.setdefault(asyncio.get_running_loop(), asyncio.Lock())


class Turn:
    """One request's turn; it ends with the `async with`. Nobody has to take it."""

    def __init__(self, turns: Turns) -> None:
        self._turns = turns
        self._held: asyncio.Lock | None = None

    @property
    def taken(self) -> bool:
        return self._held is not None

    async def take(self) -> float:
        """Wait until no other request has a turn; seconds waited. It is kept once it is taken."""
        if self._held is not None:
            return 0.0
        began = time.monotonic()
        lock = self._turns.lock()
        self._turns.ahead += 1
        try:
            await lock.acquire()
        except BaseException:
            self._turns.ahead -= 1
            raise
        self._held = lock
        return time.monotonic() - began

    async def __aenter__(self) -> Turn:
        return self

    async def __aexit__(self, *_: object) -> None:
        if self._held is not None:
            self._held.release()
            self._turns.ahead -= 1
            self._held = None
