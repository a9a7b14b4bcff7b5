"""The server: sockets, routes, rules, faults. One per test, in a thread, on a free port of 127.0.0.1."""

from __future__ import annotations

import asyncio
import importlib
import json
import re
import socket
import threading
import time
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import ModuleType
from typing import Any, Literal

import uvicorn

from tests.servers import openai_chat
from tests.servers.brains import Brain, Unmatched
from tests.servers.faults import SERVER, Fault, spoil
from tests.servers.heard import Heard, Rejected, Reply

LONGEST_STALL_S = 20.0
KEY = "wt-secret-0123456789-very-own-key"
"""The key that servers ask for: no known pattern, so that only care keeps it out of files."""

_ROUTES = (
    (re.compile(r"(?:/v1)?/chat/completions"), "openai_chat"),
    (re.compile(r"(?:/v1)?/responses"), "openai_responses"),
    (re.compile(r"(?:/v1)?/messages"), "anthropic_messages"),
    (
        re.compile(r"/v1(?:beta|alpha)?/models/(?P<model>[^/:]+):(?P<verb>generateContent|streamGenerateContent)"),
        "google_generate",
    ),
)


@dataclass
class Rules:
    """What a server insists on and what is odd about it.

    Attributes:
        key: The key it asks for; None for none.
        models: Names it serves; None for any.
        local: A local server: takes fields that OpenAI refuses, asks for system words first.
        max_pictures: Most pictures in a request; vLLM's 400 beyond.
        schemas: enforced; ignored (the answer comes with prose round it); refused (400 for a schema).
        thinks: never; field (in a field of its own); inline (<think> before the answer); switch (inline until it is told
            not to).
        context: Most tokens of a request, at 4 characters and 750 pixels a token.
        wait_s: Time that every answer takes.
    """

    key: str | None = KEY
    models: tuple[str, ...] | None = None
    local: bool = False
    max_pictures: int | None = None
    schemas: Literal["enforced", "ignored", "refused"] = "enforced"
    thinks: Literal["never", "field", "inline", "switch"] = "never"
    context: int | None = None
    wait_s: float = 0.0


@dataclass(frozen=True, eq=False)
class Seen:
    """One request as the server saw it."""

    path: str
    heard: Heard | None
    status: int
    fault: str = ""
    problem: str = ""
    user_agent: str = ""
    at_s: float = 0.0


Script = Callable[[Heard, int], "Fault | None"]


@dataclass
class WireServer:
    """A server of all four formats.

    Attributes:
        script: Says which fault strikes request number n, if any.
        log: Every request, in order.
        remember: Keep what was heard in the log, pictures and all.
        crashes: Tracebacks of the server's own defects; leaving the `with` block raises when there is one.
    """

    brain: Brain
    rules: Rules = field(default_factory=Rules)
    script: Script = field(default=lambda heard, number: None)
    log: list[Seen] = field(default_factory=list)
    remember: bool = True
    port: int = 0
    crashes: list[str] = field(default_factory=list)

    def strike(self, *faults: Fault | str | None) -> None:
        """These faults strike the next requests, one each; None lets one pass; then all is well."""
        start, made = len(self.log), [Fault(f) if isinstance(f, str) else f for f in faults]
        self.script = lambda heard, n: made[n - start] if n - start < len(made) else None

    def always(self, fault: Fault | str) -> None:
        """This fault strikes every request from now on."""
        made = Fault(fault) if isinstance(fault, str) else fault
        self.script = lambda heard, n: made

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def heard(self) -> list[Heard]:
        """Requests that were understood."""
        return [seen.heard for seen in self.log if seen.heard is not None]

    def __enter__(self) -> WireServer:
        # Told that it is TCP, asyncio sends small writes at once.
        listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
        listening.bind(("127.0.0.1", self.port))
        self.port = listening.getsockname()[1]
        config = uvicorn.Config(
            self._app,
            interface="asgi3",
            log_config=None,
            lifespan="off",
            access_log=False,
            log_level="critical",
            timeout_graceful_shutdown=1,
            ws="none",
        )
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._server.run, kwargs={"sockets": [listening]}, daemon=True)
        self._thread.start()
        until = time.monotonic() + 10
        while not self._server.started:
            if time.monotonic() > until:
                raise RuntimeError("the server did not start within 10 s")
            time.sleep(0.005)
        return self

    def __exit__(self, *_: object) -> None:
        self._server.should_exit = True
        self._server.force_exit = True
        self._thread.join(5)
        if self.crashes:
            raise RuntimeError("the server itself failed:\n" + "\n".join(self.crashes))

    # -- one request ---------------------------------------------------------------------------------------------

    async def _app(self, scope: Mapping[str, Any], receive: Any, send: Any) -> None:
        try:
            if scope["type"] == "http":
                await self._serve(scope, receive, send)
        except Exception:  # noqa: BLE001  kept, and raised in the test
            self.crashes.append(traceback.format_exc())
            _cut(send)

    async def _serve(self, scope: Mapping[str, Any], receive: Any, send: Any) -> None:
        body = b""
        while True:
            message = await receive()
            if message["type"] == "http.disconnect":
                return
            body += message.get("body", b"")
            if not message.get("more_body"):
                break
        path = scope["path"]
        headers = {name.decode().lower(): value.decode() for name, value in scope["headers"]}
        if scope["method"] == "GET":
            await _send_json(send, 200, self._listing(path))
            return
        place = self._reserve(path, headers)
        form, match = _form_of(path)
        try:
            parsed = self._parse(form, match, path, body, headers)
            if self.remember:
                self.log[place] = replace(self.log[place], heard=parsed)
            self._insist(parsed, form)
        except Rejected as error:
            self.log[place] = replace(self.log[place], status=error.status, problem=error.message)
            await _send_json(send, error.status, form.error(error.status, error.message, error.code), error.headers)
            return
        await self._answer(form, parsed, place, receive, send)

    def _reserve(self, path: str, headers: Mapping[str, str]) -> int:
        self.log.append(Seen(path, None, 200, user_agent=headers.get("user-agent", ""), at_s=time.monotonic()))
        return len(self.log) - 1

    def _parse(
        self, form: ModuleType, match: re.Match[str] | None, path: str, raw: bytes, headers: Mapping[str, str]
    ) -> Heard:
        if match is None:
            raise Rejected(404, f"Invalid URL (POST {path})")
        try:
            body = json.loads(raw)
        except ValueError as error:
            raise Rejected(400, f"We could not parse the JSON body of your request: {error}") from error
        if "model" in match.groupdict():
            body = {**body, "model": match["model"], "stream": match["verb"] == "streamGenerateContent"}
        try:
            heard: Heard = form.parse(body, headers, local=self.rules.local, size=len(raw))
        except KeyError as error:
            raise Rejected(400, f"Missing required parameter: {error}", code="missing_required_parameter") from error
        return heard

    def _insist(self, heard: Heard, form: ModuleType) -> None:
        rules = self.rules
        if rules.key is not None and heard.secret != rules.key:
            status, code = getattr(form, "BAD_KEY", (401, "invalid_api_key"))
            raise Rejected(status, f"Incorrect API key provided: {heard.secret}.", code=code)
        if rules.models is not None and heard.model not in rules.models:
            raise Rejected(404, f"The model `{heard.model}` does not exist.", code="model_not_found")
        if rules.max_pictures is not None and len(heard.pictures) > rules.max_pictures:
            raise Rejected(400, f"At most {rules.max_pictures} image(s) may be provided in one prompt.")
        if rules.schemas == "refused" and heard.schema_native:
            raise Rejected(400, "response_format of type json_schema is not supported by this server")
        tokens = tokens_of(heard)
        if rules.context is not None and tokens > rules.context:
            raise Rejected(
                400,
                f"This model's maximum context length is {rules.context} tokens. However, you requested {tokens} tokens.",
                code="context_length_exceeded",
            )

    async def _answer(self, form: ModuleType, heard: Heard, place: int, receive: Any, send: Any) -> None:
        fault = self.script(heard, place)
        self.log[place] = replace(self.log[place], fault=fault.name if fault else "")
        if self.rules.wait_s:
            await asyncio.sleep(self.rules.wait_s)
        if fault is not None and fault.level == "line" and fault.name in ("hang", "drop"):
            if fault.name == "hang":
                await _stall(receive)
            _cut(send)
            return
        if fault is not None and fault.level == "server" and fault.name != "empty_choices":
            status = await _send_fault(form, heard, fault, send)
            self.log[place] = replace(self.log[place], status=status)
            return
        try:
            said = await asyncio.to_thread(self.brain, heard)
        except Unmatched as error:
            self.log[place] = replace(self.log[place], status=500, problem=f"unmatched: {error}")
            await _send_json(send, 500, form.error(500, f"unmatched: {error}", ""))
            return
        reply = self._dressed(said if isinstance(said, Reply) else Reply(said), heard)
        if fault is not None and fault.level == "answer":
            reply = spoil(reply, heard, fault)
        await _send_reply(form, reply, heard, fault, receive, send)

    def _dressed(self, reply: Reply, heard: Heard) -> Reply:
        """The reply with the server's standing oddities."""
        if reply.usage is not None:
            reply = replace(reply, usage=(tokens_of(heard), *reply.usage[1:]))
        if self.rules.schemas == "ignored":
            reply = replace(reply, text=f"Sure! Here is what I found:\n```json\n{reply.text}\n```")
        if self.rules.thinks == "field":
            return replace(reply, thinking="Let me look at the picture.")
        told = (heard.body.get("chat_template_kwargs") or {}).get("enable_thinking") is False
        told = told or heard.body.get("think") is False or heard.body.get("reasoning_effort") == "none"
        if self.rules.thinks == "inline" or (self.rules.thinks == "switch" and not told):
            return replace(reply, text=f"<think>Let me look at the picture.</think>\n{reply.text}")
        return reply

    def _listing(self, path: str) -> dict[str, Any]:
        names = list(self.rules.models or ("test-model",))
        if path.startswith("/v1beta"):
            return {
                "models": [{"name": f"models/{name}", "inputTokenLimit": self.rules.context or 32768} for name in names]
            }
        if path == "/api/tags":
            return {"models": [{"name": name, "model": name} for name in names]}
        return openai_chat.models(names, self.rules.context)


def _form_of(path: str) -> tuple[ModuleType, re.Match[str] | None]:
    for pattern, name in _ROUTES:
        match = pattern.fullmatch(path)
        if match is not None:
            return importlib.import_module(f"tests.servers.{name}"), match
    return openai_chat, None


def tokens_of(heard: Heard) -> int:
    """A rough count: 4 characters, or 750 pixels, a token."""
    words = len(heard.system) + sum(len(p) for turn in heard.turns for p in turn.pieces if isinstance(p, str))
    return words // 4 + sum(p.shape[0] * p.shape[1] // 750 for p in heard.pictures)


# -- sending -------------------------------------------------------------------------------------------------------


async def _send_json(send: Any, status: int, value: Any, headers: Mapping[str, str] | None = None) -> None:
    # allow_nan: a model's NaN inside a text is text; nothing else here holds one.
    await _send_bytes(send, status, json.dumps(value).encode(), "application/json", headers)


async def _send_bytes(send: Any, status: int, body: bytes, kind: str, headers: Mapping[str, str] | None = None) -> None:
    head = [(b"content-type", kind.encode()), (b"content-length", str(len(body)).encode())]
    head += [(name.encode(), value.encode()) for name, value in (headers or {}).items()]
    await send({"type": "http.response.start", "status": status, "headers": head})
    await send({"type": "http.response.body", "body": body})


async def _send_fault(form: ModuleType, heard: Heard, fault: Fault, send: Any) -> int:
    status, message, code = SERVER[fault.name]
    message = (
        message.format(secret=heard.secret, model=heard.model)
        if "{secret}" in message or "{model}" in message
        else message
    )
    headers = {"retry-after": f"{fault.wait_s:g}"} if fault.name == "rate_limit" else {}
    if fault.name == "unauthorized":
        status = getattr(form, "BAD_KEY", (401, ""))[0]
    if fault.name in ("html_200", "html_502"):
        await _send_bytes(send, status, message.encode(), "text/html")
    elif fault.name in ("empty_200", "garbage_200", "other_shape"):
        await _send_bytes(send, status, message.encode(), "application/json")
    elif fault.name == "error_200":
        await _send_json(send, 200, {"error": {"message": message, "code": 500}})
    else:
        await _send_json(send, status, form.error(status, message, code), headers)
    return status


async def _send_reply(
    form: ModuleType, reply: Reply, heard: Heard, fault: Fault | None, receive: Any, send: Any
) -> None:
    name = fault.name if fault is not None else ""
    if heard.stream and name != "empty_choices":
        kind, body = b"text/event-stream", b"".join(form.stream(reply, heard))
    else:
        whole = form.render(reply, heard)
        if name == "empty_choices":
            whole = form.emptied(whole) if hasattr(form, "emptied") else {**whole, "choices": []}
        kind, body = b"application/json", json.dumps(whole).encode()
    if name not in ("drip", "drop_mid", "drop_headers"):
        await _send_bytes(send, 200, body, kind.decode())
        return
    head = [(b"content-type", kind), (b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": 200, "headers": head})
    if name == "drop_headers":
        await send({"type": "http.response.body", "body": body[:1], "more_body": True})
        _cut(send)
    elif name == "drop_mid":
        await send({"type": "http.response.body", "body": body[: len(body) // 2], "more_body": True})
        await asyncio.sleep(0.01)
        _cut(send)
    else:
        assert fault is not None
        await _drip(body, fault.wait_s or 0.05, receive, send)


async def _drip(body: bytes, gap_s: float, receive: Any, send: Any) -> None:
    until = time.monotonic() + LONGEST_STALL_S
    gone = asyncio.ensure_future(receive())
    for index in range(len(body)):
        if gone.done() or time.monotonic() > until:
            break
        await send({"type": "http.response.body", "body": body[index : index + 1], "more_body": True})
        await asyncio.sleep(gap_s)
    gone.cancel()
    _cut(send)


async def _stall(receive: Any) -> None:
    """Say nothing until the client goes away."""
    try:
        await asyncio.wait_for(receive(), LONGEST_STALL_S)
    except TimeoutError:
        return


def _cut(send: Any) -> None:
    """End the connection at once: the bound method's owner is uvicorn's cycle of this request."""
    send.__self__.transport.abort()
