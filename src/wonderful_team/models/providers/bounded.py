"""What a server may send: so many bytes, unpacked ones included, within so many seconds in all.

A client's own time-outs are per read: a server that drips a byte now and then, or never ends, keeps it reading for ever.
"""

from __future__ import annotations

import json
import queue
import threading
import time
import zlib
from collections.abc import AsyncIterator, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from wonderful_team.core import deadline

if TYPE_CHECKING:
    import httpx2

REPLY_BYTES = 16 * 1024 * 1024
"""Largest reply to a request. An answer with 100,000 tokens of thinking has about half a megabyte."""
FACTS_BYTES = 4 * 1024 * 1024
"""Largest list of models or settings of a server; OpenRouter's list of some 400 models has about one megabyte."""
_CODINGS = {"gzip": 16 + zlib.MAX_WBITS, "x-gzip": 16 + zlib.MAX_WBITS, "deflate": zlib.MAX_WBITS}
ACCEPTED = "gzip, deflate"
"""What is asked for: codings that can be unpacked step by step here, and no others."""


class ReplyTooLargeError(Exception):
    """A reply is larger than the limit, or packed in a way that cannot be bounded."""


class _Unpacker:
    """Counts what passes, unpacks it, and stops at the limit."""

    def __init__(self, headers: Mapping[str, str], most: int) -> None:
        self.most, self.taken, self.given = most, 0, 0
        codings = [
            name for part in headers.get("content-encoding", "").lower().split(",")
            if (name := part.strip()) and name != "identity"
        ]  # fmt: skip
        if len(codings) > 1 or any(name not in _CODINGS for name in codings):
            raise ReplyTooLargeError(f"the reply is packed as {', '.join(codings)[:80]!r}; valid is one of {ACCEPTED}")
        self._inflate = zlib.decompressobj(_CODINGS[codings[0]]) if codings else None
        stated = headers.get("content-length", "")
        if stated.isdecimal() and len(stated) < 20:
            self._check(int(stated))

    def _check(self, size: int) -> None:
        if size > self.most:
            raise ReplyTooLargeError(f"the reply has more than {self.most:,} bytes")

    def feed(self, chunk: bytes) -> bytes:
        self.taken += len(chunk)
        self._check(self.taken)
        if self._inflate is None:
            return chunk
        try:
            plain = self._inflate.decompress(chunk, self.most + 1 - self.given)
        except zlib.error as error:
            raise ReplyTooLargeError(f"the reply cannot be unpacked: {error}") from None
        self.given += len(plain)
        self._check(self.given)
        return plain


def limit_replies(client: httpx2.AsyncClient, most: int = REPLY_BYTES) -> httpx2.AsyncClient:
    """The client, whose replies end with `ReplyTooLargeError` beyond `most` bytes, packed or unpacked."""
    import httpx2

    class Stream(httpx2.AsyncByteStream):
        def __init__(self, inner: Any, unpacker: _Unpacker) -> None:
            self.inner, self.unpacker = inner, unpacker

        async def __aiter__(self) -> AsyncIterator[bytes]:
            async for chunk in self.inner:
                yield self.unpacker.feed(chunk)

        async def aclose(self) -> None:
            await self.inner.aclose()

    async def bound(response: httpx2.Response) -> None:
        unpacker = _Unpacker(response.headers, most)
        response.stream = Stream(response.stream, unpacker)
        # What comes out is plain already.
        response.headers.pop("content-encoding", None)

    client.headers["Accept-Encoding"] = ACCEPTED
    client.event_hooks = {**client.event_hooks, "response": [*client.event_hooks.get("response", []), bound]}
    return client


def fetch_json(
    method: str,
    url: str,
    *,
    headers: Mapping[str, str],
    timeout_s: float,
    direct: bool,
    body: Mapping[str, Any] | None = None,
    most: int = FACTS_BYTES,
) -> tuple[int, Any]:
    """Ask a server for a small JSON document; never follows a redirect.

    Args:
        method: GET or POST.
        url: The whole address.
        headers: Sent as they are.
        timeout_s: For all of it: connecting, headers and the whole body, within what the run has left [s].
        direct: Never through a proxy.
        body: Sent as JSON.
        most: Most bytes of the reply, packed or unpacked.

    Returns:
        The status, and the document; None when the body is not JSON.

    Raises:
        httpx2.HTTPError: Nothing answers, or not within the time.
        ReplyTooLargeError: More bytes than `most`.
        BudgetReached: The time of the run is over.
    """
    import httpx2

    during = f"asking {url}"
    deadline.check(during)
    timeout_s = max(0.001, deadline.left_s(timeout_s) or 0.0)

    def ask() -> tuple[int, Any]:
        ends = time.monotonic() + timeout_s
        asked = {**headers, "Accept-Encoding": ACCEPTED}
        with (
            httpx2.Client(timeout=timeout_s, trust_env=not direct, follow_redirects=False) as client,
            client.stream(method, url, headers=asked, json=body) as reply,
        ):
            text = b"".join(_until(ends, reply.iter_raw(), _Unpacker(reply.headers, most)))
            return reply.status_code, _json(text)

    ended: queue.SimpleQueue[tuple[tuple[int, Any] | None, BaseException | None]] = queue.SimpleQueue()

    def run() -> None:
        try:
            ended.put((ask(), None))
        except BaseException as error:  # noqa: BLE001  handed to the caller's thread, whatever it is
            ended.put((None, error))

    # Headers that drip are read inside of the library, past every limit of ours but this one.
    threading.Thread(target=run, name="server facts", daemon=True).start()
    try:
        found, error = ended.get(timeout=timeout_s + 0.5)
    except queue.Empty:
        found, error = None, httpx2.ReadTimeout(f"no whole reply within {timeout_s:g} s")
    if error is not None:
        deadline.check(during)
        raise error
    assert found is not None
    return found


def _until(ends: float, chunks: Iterator[bytes], unpacker: _Unpacker) -> Iterator[bytes]:
    import httpx2

    for chunk in chunks:
        if time.monotonic() > ends:
            raise httpx2.ReadTimeout("no whole reply within the time")
        yield unpacker.feed(chunk)


def _json(text: bytes) -> Any:
    try:
        return json.loads(text.decode("utf-8", errors="replace"))
    except (ValueError, RecursionError):
        return None
