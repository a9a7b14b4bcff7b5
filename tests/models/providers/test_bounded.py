"""A server cannot exhaust its client: endless, huge, packed and dripping replies end within the limits, with a typed error."""

from __future__ import annotations

import asyncio
import functools
import gzip
import json
import resource
import socket
import threading
import time
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import httpx2
import pytest

from tests.models.wire.scenes import picture, reading
from wonderful_team.errors import ModelServerError, ModelUnavailableError, UnknownModelError
from wonderful_team.models.client import ModelClient
from wonderful_team.models.providers import make_provider
from wonderful_team.models.providers.bounded import FACTS_BYTES, ReplyTooLargeError, fetch_json, limit_replies
from wonderful_team.models.providers.facts import Facts
from wonderful_team.models.providers.listing import server_models
from wonderful_team.models.providers.server_facts import server_facts
from wonderful_team.models.providers.vendors import VENDORS
from wonderful_team.models.wire import encodable, read_json

Send = Callable[[socket.socket], None]


@contextmanager
def answering(send: Send) -> Iterator[str]:
    """A raw server: reads a request's head, then does as it is told, until the test ends."""
    listener = socket.create_server(("127.0.0.1", 0))
    listener.settimeout(0.2)
    ending = threading.Event()

    def one(line: socket.socket) -> None:
        with line:
            line.settimeout(10)
            try:
                line.recv(65536)
                send(line)
            except OSError:
                pass  # the client has gone away, as it should

    def serve() -> None:
        while not ending.is_set():
            try:
                line, _ = listener.accept()
            except TimeoutError:
                continue
            threading.Thread(target=one, args=(line,), daemon=True).start()

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{listener.getsockname()[1]}/v1"
    finally:
        ending.set()
        thread.join()
        listener.close()


def head(*lines: str) -> bytes:
    return "\r\n".join(("HTTP/1.1 200 OK", "Content-Type: application/json", *lines, "", "")).encode()


def endless(line: socket.socket) -> None:
    line.sendall(head("Connection: close"))
    for _ in range(2000):
        line.sendall(b"[" * 65536)


def declared(line: socket.socket) -> None:
    line.sendall(head("Content-Length: 100000000000"))


@functools.cache
def packed_spaces() -> bytes:
    """150 MB of spaces, packed piece by piece so that making them takes no memory here."""
    packer = zlib.compressobj(1, zlib.DEFLATED, 16 + zlib.MAX_WBITS)
    return b"".join([*(packer.compress(b" " * 1_000_000) for _ in range(150)), packer.flush()])


def bomb(line: socket.socket) -> None:
    packed = packed_spaces()
    line.sendall(head("Content-Encoding: gzip", f"Content-Length: {len(packed)}") + packed)


def layers(line: socket.socket) -> None:
    packed = gzip.compress(gzip.compress(gzip.compress(b" " * 1_000_000)))
    line.sendall(head("Content-Encoding: gzip, gzip, gzip", f"Content-Length: {len(packed)}") + packed)


def unknown_coding(line: socket.socket) -> None:
    line.sendall(head("Content-Encoding: br", "Content-Length: 4") + b"abcd")


def broken_gzip(line: socket.socket) -> None:
    line.sendall(head("Content-Encoding: gzip", "Content-Length: 4") + b"abcd")


def drip(line: socket.socket) -> None:
    line.sendall(head("Content-Length: 100000"))
    for _ in range(200):
        line.sendall(b" ")
        time.sleep(0.05)


def dripping_head(line: socket.socket) -> None:
    line.sendall(b"HTTP/1.1 200 OK\r\n")
    for number in range(200):
        line.sendall(f"X-{number}: 1\r\n".encode())
        time.sleep(0.05)


LARGE = [endless, declared, bomb, layers, unknown_coding, broken_gzip]


def memory_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


@pytest.mark.parametrize("send", LARGE)
def test_a_list_of_models_has_a_size_limit(send: Send) -> None:
    before = memory_mb()
    with answering(send) as url, pytest.raises(ModelUnavailableError, match="ReplyTooLarge"):
        server_models(url, None)
    assert memory_mb() - before < 100


@pytest.mark.parametrize("send", [drip, dripping_head])
def test_a_list_of_models_has_a_deadline_in_all(send: Send) -> None:
    with answering(send) as url, pytest.raises(ModelUnavailableError, match="Timeout"):
        server_models(url, None, timeout_s=0.3)


@pytest.mark.parametrize("send", [endless, drip])
def test_facts_of_a_server_that_cannot_be_read_are_unknown(send: Send) -> None:
    with answering(send) as url:
        assert server_facts(VENDORS["openai-chat"], url, "m", None, timeout_s=0.3) == Facts()


def test_a_deep_list_of_models_is_no_list() -> None:
    body = b"[" * 200_000

    def deep(line: socket.socket) -> None:
        line.sendall(head(f"Content-Length: {len(body)}") + body)

    with answering(deep) as url, pytest.raises(UnknownModelError, match="no list of models"):
        server_models(url, None)


@pytest.mark.parametrize("coding", ["gzip", "deflate", ""])
def test_packed_replies_of_ordinary_size_are_read(coding: str) -> None:
    text = json.dumps({"data": [{"id": f"model-{number}"} for number in range(500)]}).encode()
    body = {"gzip": gzip.compress, "deflate": zlib.compress, "": bytes}[coding](text)

    def send(line: socket.socket) -> None:
        packed = (f"Content-Encoding: {coding}",) if coding else ()
        line.sendall(head(*packed, f"Content-Length: {len(body)}") + body)

    with answering(send) as url:
        assert len(server_models(url, None)) == 500
        status, found = asyncio.run(_through_the_pool(url))
        assert (status, found) == (200, json.loads(text))


async def _through_the_pool(url: str) -> tuple[int, object]:
    async with limit_replies(httpx2.AsyncClient()) as client:
        reply = await client.get(url)
        return reply.status_code, reply.json()


@pytest.mark.parametrize("send", LARGE)
def test_a_models_reply_has_a_size_limit_and_is_not_asked_for_again(send: Send) -> None:
    asked = []

    def counted(line: socket.socket) -> None:
        asked.append(1)
        send(line)

    before = memory_mb()
    with answering(counted) as url:
        model = make_provider(f"openai-chat:m@{url}", deadline_s=20)
        with pytest.raises(ModelServerError, match="the reply (has more than|is packed as|cannot be unpacked)"):
            asyncio.run(ModelClient(model).ask(reading(picture(), ())))
    assert len(asked) == 1
    assert memory_mb() - before < 200


def test_the_limit_is_exact() -> None:
    body = b'"' + b"x" * (FACTS_BYTES - 2) + b'"'

    def send(line: socket.socket) -> None:
        line.sendall(head("Connection: close") + body)

    with answering(send) as url:
        status, found = fetch_json("GET", url, headers={}, timeout_s=20, direct=True)
        assert (status, len(found)) == (200, FACTS_BYTES - 2)
        with pytest.raises(ReplyTooLargeError):
            fetch_json("GET", url, headers={}, timeout_s=20, direct=True, most=FACTS_BYTES - 1)


def test_deep_answers_go_back_to_the_model() -> None:
    with pytest.raises(ValueError, match="nested deeper than 50"):
        read_json('{"a":' * 400 + "1" + "}" * 400)
    with pytest.raises(ValueError, match="cut off or malformed"):
        read_json('{"a":' * 100_000)


def test_lone_surrogates_are_replaced() -> None:
    (value,) = read_json('{"text": "left \\ud800 of"}').value.values()
    assert value == "left \ufffd of"
    assert encodable("\ud83d\ude00 \udc00") == "\U0001f600 \ufffd"
