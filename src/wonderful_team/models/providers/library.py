"""The one file that asks through the client library; the models that it asks are built in `vendors`. Nothing imports it early.

Only `pydantic_ai.models.*.request` is used: no agent, no tools, no retries of its own, so every word that goes out is ours.
"""

from __future__ import annotations

import functools
import importlib
import importlib.metadata
import importlib.util
import os
import ssl
import threading
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, cast

from wonderful_team.core.interrupts import start_thread
from wonderful_team.errors import ConfigError, MissingExtraError
from wonderful_team.models.providers.bounded import limit_replies
from wonderful_team.models.providers.specs import Spec, is_loopback
from wonderful_team.models.wire import Composed, media_type

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.messages import ModelMessage, ModelResponse
    from pydantic_ai.models import Model as LibraryModel

    from wonderful_team.models.providers.vendors import Vendor

LIBRARY = "pydantic-ai-slim"
NO_KEY = "none"
"""Given to the vendors' clients where there is no key: they insist on some word. It is never sent."""
SENT_HEADERS = frozenset({
    "accept", "accept-encoding", "connection", "content-length", "content-type", "host", "transfer-encoding", "user-agent",
})  # fmt: skip
"""Headers that leave this machine, beside the one with the key and those of the vendor's format: vendors' clients add more
from variables such as OPENAI_ORG_ID and ANTHROPIC_CUSTOM_HEADERS, which name accounts and hold secrets."""
KEY_HEADERS = frozenset({"authorization", "x-api-key", "x-goog-api-key"})
"""Where vendors' clients put the key; which of these it is depends on their version."""
_TRUST_VARIABLES = ("SSL_CERT_FILE", "SSL_CERT_DIR", "SSLKEYLOGFILE")
_OF_ALL = ("httpx2", "pydantic_ai.direct")
_lock = threading.Lock()
_loading: dict[str, Future[None]] = {}
"""By service's module: its import, under way or done."""


@functools.cache
def library_version() -> str:
    """Name and version of the client library, for records and cache keys.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        return f"{LIBRARY} {importlib.metadata.version(LIBRARY)}"
    except importlib.metadata.PackageNotFoundError as error:
        raise MissingExtraError("models of vendors and servers", "vendors") from error


def preload(service: Vendor, text: str) -> Future[None]:
    """Start to import what a service needs, in a thread: it takes seconds, in which pictures are read; see `loaded`.

    Raises:
        MissingExtraError: It is not installed.
    """
    if not all(map(_is_installed, ("httpx2", "pydantic_ai", service.package))):
        raise MissingExtraError(f"model {text!r}", "vendors")
    module = service.module
    with _lock:
        if module in _loading:
            return _loading[module]
        future: Future[None] = Future()
        _loading[module] = future
    start_thread(_import, (*_OF_ALL, module), future, name="client library")
    return future


def loaded(service: Vendor, text: str) -> None:
    """Wait until what a service needs is imported.

    Raises:
        MissingExtraError: Part of it is not installed.
    """
    future = preload(service, text)
    try:
        future.result()
    except ImportError as error:
        with _lock:
            _loading.pop(service.module, None)  # it may be installed while the process goes on
        raise MissingExtraError(f"model {text!r}", "vendors") from error


def is_loaded(service: Vendor) -> bool:
    """Whether `loaded` would return at once."""
    held = _loading.get(service.module)
    return held is not None and held.done() and held.exception() is None


def _import(names: Sequence[str], future: Future[None]) -> None:
    try:
        for name in names:
            importlib.import_module(name)
    except BaseException as error:  # noqa: BLE001  raised by whoever waits
        future.set_exception(error)
    else:
        future.set_result(None)


def _is_installed(name: str) -> bool:
    try:
        return importlib.util.find_spec(name) is not None
    except (ValueError, ImportError):
        return False


@functools.lru_cache(maxsize=8)
def _tls(trust_env: bool, from_environment: tuple[str | None, ...]) -> ssl.SSLContext:
    """What is trusted: read once, as every client would read the same file anew."""
    import httpx2

    return httpx2.create_ssl_context(trust_env=trust_env)


def http_client(spec: Spec, key: str | None, local_only: bool) -> httpx2.AsyncClient:
    """A connection pool of our own for one service and one key.

    No redirects (a key must not follow one), no proxy for this machine, no endless reply, no headers but `SENT_HEADERS`,
    the vendor's own and exactly this key, no address but the service's. How long a reply may take is the caller's to limit.
    """
    import httpx2

    limits = httpx2.Limits(max_connections=64, max_keepalive_connections=16)
    timeout = httpx2.Timeout(None, connect=10.0)
    outside = not (local_only or is_loopback(spec.base_url))
    trusted = _tls(outside, tuple(map(os.environ.get, _TRUST_VARIABLES)))
    client = httpx2.AsyncClient(
        verify=trusted, timeout=timeout, limits=limits, follow_redirects=False, trust_env=outside
    )
    client.event_hooks = {"request": [_guard(spec, key)], "response": []}
    return limit_replies(client)


def _guard(spec: Spec, key: str | None) -> Callable[[httpx2.Request], Awaitable[None]]:
    """Lets through what we decided to send, whatever a vendor's client found in the environment."""
    import httpx2

    home = httpx2.URL(spec.base_url)
    place = (home.scheme, home.host, home.port)
    known, (key_header, before) = SENT_HEADERS | spec.service.headers, spec.service.key_header
    key_headers = KEY_HEADERS | {key_header.lower()}
    keys = () if key is None else (key, f"Bearer {key}", f"{before}{key}")

    async def guard(request: httpx2.Request) -> None:
        url = request.url
        if (url.scheme, url.host, url.port) != place:
            raise ConfigError(f"a request for {spec.base_url} was about to go to {url.scheme}://{url.host}")
        for name in set(request.headers):
            if name not in known and not (name in key_headers and request.headers[name] in keys):
                del request.headers[name]

    return guard


def build_model(spec: Spec, model: str, key: str | None, client: httpx2.AsyncClient) -> LibraryModel:
    """The library's model for a spec, on our connection pool.

    Raises:
        MissingExtraError: A vendor's client is not installed.
        ConfigError: The library cannot use such a name.
    """
    try:
        return spec.service.build(spec.base_url, model, key or NO_KEY, client)
    except ImportError as error:
        raise MissingExtraError(f"model {spec.text!r}", "vendors") from error
    except Exception as error:
        # It reads names of models in ways of its own.
        raise ConfigError(f"model {spec.text!r}: the client library cannot use it ({type(error).__name__})") from error


def messages_of(composed: Composed, turns: Sequence[tuple[str, str]], detail: str | None = None) -> list[ModelMessage]:
    """System words, the request, and after it the model's earlier answers, each with what was wrong with it.

    A turn is (what the model said, what it was told), in order. `detail` goes with each picture.
    """
    from pydantic_ai.messages import (
        BinaryImage,
        ModelRequest,
        ModelResponse,
        SystemPromptPart,
        TextPart,
        UserContent,
        UserPromptPart,
    )

    metadata = None if detail is None else {"detail": detail}
    content: list[UserContent] = [
        piece if isinstance(piece, str) else BinaryImage(piece, media_type=media_type(piece), vendor_metadata=metadata)
        for piece in composed.pieces
    ]
    first: list[Any] = [SystemPromptPart(composed.system)] if composed.system else []
    messages: list[ModelMessage] = [ModelRequest(parts=[*first, UserPromptPart(content)])]
    for said, told in turns:
        messages.append(ModelResponse(parts=[TextPart(said or "(empty)")]))
        messages.append(ModelRequest(parts=[UserPromptPart(told)]))
    return messages


async def send(
    model: LibraryModel,
    messages: list[ModelMessage],
    settings: dict[str, Any],
    schema: dict[str, Any] | None,
    name: str,
) -> ModelResponse:
    """One HTTP request that asks for an answer in `schema` (None: plain text); the library's own errors come through."""
    from pydantic_ai.direct import model_request
    from pydantic_ai.models import ModelRequestParameters
    from pydantic_ai.output import OutputObjectDefinition
    from pydantic_ai.settings import ModelSettings

    # No template: the library must add no words to the request.
    parameters = ModelRequestParameters(prompted_output_template=False)
    if schema is not None:
        output = OutputObjectDefinition(json_schema=schema, name=name, strict=True)
        parameters = ModelRequestParameters(output_mode="native", output_object=output, prompted_output_template=False)
    return await model_request(
        model, messages, model_settings=cast(ModelSettings, settings), model_request_parameters=parameters
    )


def enforces_schemas(model: LibraryModel) -> bool:
    """Whether the library believes that this model's service keeps answers to a schema."""
    return bool(model.profile.get("supports_json_schema_output", False))


def hides_schemas(model: LibraryModel) -> bool:
    """Whether the service constrains the answer without showing the schema to the model."""
    return bool(model.profile.get("native_output_requires_schema_in_instructions", False))
