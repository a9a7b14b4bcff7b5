"""What leaves this machine beside the request itself: the chosen key to its own service, and nothing from the environment."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, HTTPServer
from typing import Any

import pytest

from tests.models.providers.asking import question
from wonderful_team.errors import ConfigError, ModelAuthError, WonderfulTeamError
from wonderful_team.models.providers import SERVER_KEY, library, make_provider
from wonderful_team.models.providers.specs import parse_spec
from wonderful_team.models.providers.vendors import VENDORS

LEAK = "leaked"
ENVIRONMENT = {
    "OPENAI_API_KEY": "leaked-openai-key",
    "OPENAI_ADMIN_KEY": "leaked-admin-key",
    "OPENAI_ORG_ID": "leaked-organisation",
    "OPENAI_PROJECT_ID": "leaked-project",
    "OPENAI_BASE_URL": "http://127.0.0.1:9/leaked",
    "OPENAI_CUSTOM_HEADERS": "X-Team: leaked-header\nUser-Agent: leaked-agent\nAuthorization: Bearer leaked-bearer",
    "ANTHROPIC_API_KEY": "leaked-anthropic-key",
    "ANTHROPIC_AUTH_TOKEN": "leaked-token",
    "ANTHROPIC_BASE_URL": "http://127.0.0.1:9/leaked",
    "ANTHROPIC_CUSTOM_HEADERS": "X-Team: leaked-header\nanthropic-version: leaked-version\nX-Api-Key: leaked-bearer",
    "GOOGLE_API_KEY": "leaked-google-key",
    "GEMINI_API_KEY": "leaked-gemini-key",
    "GOOGLE_CLOUD_PROJECT": "leaked-cloud-project",
    "GOOGLE_CLOUD_LOCATION": "leaked-location",
    "GOOGLE_GENAI_USE_VERTEXAI": "true",
    "GOOGLE_GEMINI_BASE_URL": "http://127.0.0.1:9/leaked",
    "OPENROUTER_API_KEY": "leaked-openrouter-key",
    "OPENROUTER_APP_URL": "http://leaked.example",
    "OPENROUTER_APP_TITLE": "leaked title",
}
SPECS = {
    "openai": "openai:gpt-5@{url}/v1",
    "openai-chat": "openai-chat:gpt-5@{url}/v1",
    "anthropic": "anthropic:claude-opus-5@{url}",
    "google": "google:gemini-3@{url}",
    "openrouter": "openrouter:openai/gpt-5@{url}/v1",
    "server": "{url}/v1#m",
}


class Listener:
    """Keeps every request, whole, and refuses it."""

    def __init__(self) -> None:
        self.requests: list[tuple[dict[str, str], str]] = []
        heard = self.requests

        class Handler(BaseHTTPRequestHandler):
            def do_POST(self) -> None:  # noqa: N802  http.server's name
                body = self.rfile.read(int(self.headers["content-length"]))
                headers = {name.lower(): value for name, value in self.headers.items()}
                heard.append((headers, f"{self.path}\n{headers}\n{body.decode()}"))
                self.send_response(400)
                self.send_header("Content-Length", "0")
                self.end_headers()

            def log_message(self, *_: object) -> None:
                pass

        self.server = HTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self.server.server_port}"
        self.thread = threading.Thread(target=self.server.serve_forever, daemon=True)
        self.thread.start()

    def close(self) -> None:
        self.server.shutdown()
        self.server.server_close()
        self.thread.join(5)


@pytest.fixture
def listener(monkeypatch: pytest.MonkeyPatch) -> Iterator[Listener]:
    for name, value in ENVIRONMENT.items():
        monkeypatch.setenv(name, value)
    monkeypatch.delenv(SERVER_KEY, raising=False)
    running = Listener()
    yield running
    running.close()


def send(spec: str, **options: Any) -> None:
    """One request; the listener refuses it."""
    provider = make_provider(spec, tries=1, **options)
    with pytest.raises(WonderfulTeamError):
        asyncio.run(provider.answer(question()))


@pytest.mark.parametrize("thinking", [None, "high"])
@pytest.mark.parametrize("name", SPECS)
def test_a_foreign_address_gets_nothing_from_the_environment(
    name: str, thinking: Any, listener: Listener, monkeypatch: pytest.MonkeyPatch
) -> None:
    send(SPECS[name].format(url=listener.url), thinking=thinking)
    monkeypatch.setenv(SERVER_KEY, "own-server-key")
    send(SPECS[name].format(url=listener.url), thinking=thinking)
    (bare, first), (keyed, second) = listener.requests
    assert LEAK not in first + second
    assert not library.KEY_HEADERS & set(bare), "without a key no header for one is sent"
    assert [keyed[header].removeprefix("Bearer ") for header in library.KEY_HEADERS & set(keyed)] == ["own-server-key"]


@pytest.mark.parametrize("name", sorted(VENDORS))
def test_a_vendor_gets_its_own_key_and_nothing_else_from_the_environment(
    name: str, listener: Listener, monkeypatch: pytest.MonkeyPatch
) -> None:
    vendor = VENDORS[name]
    own = "/v1" if vendor.base_url.endswith("/v1") else ""
    monkeypatch.setitem(VENDORS, name, replace(vendor, base_url=listener.url + own))
    send(f"{name}:maker/model")
    ((headers, whole),) = listener.requests
    key = ENVIRONMENT[vendor.keys[0]]
    assert [headers[header].removeprefix("Bearer ") for header in library.KEY_HEADERS & set(headers)] == [key]
    assert LEAK not in whole.replace(key, "")


def test_a_request_that_would_go_elsewhere_is_stopped() -> None:
    async def stray() -> None:
        client = library.http_client(parse_spec("http://127.0.0.1:9/v1#m"), "k", True)
        try:
            await client.post("http://127.0.0.1:10/v1/chat/completions", json={})
        finally:
            await client.aclose()

    with pytest.raises(ConfigError, match=r"was about to go to http://127\.0\.0\.1"):
        asyncio.run(stray())


@pytest.mark.parametrize("key", ["two words", "line\nbreak", "schlüssel"])
def test_what_cannot_be_a_key_is_named_by_its_variable_and_not_repeated(
    key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", key)
    with pytest.raises(ModelAuthError, match="OPENAI_API_KEY holds spaces") as caught:
        make_provider("openai:gpt-5")
    assert key not in str(caught.value)
