"""Providers pointed at local servers, one for each wire format, each with a family whose convention differs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tests.servers.server import KEY, WireServer
from tests.servers.speech import SPEECHES, Speech, qwen25_resize
from wonderful_team.models.providers import make_provider


@dataclass(frozen=True)
class Wire:
    """One way to a server.

    Attributes:
        vendor: Head of the model's name; "" for a server named by its address.
        path: What the address ends in.
        model: A served name whose family speaks as `speech`.
    """

    vendor: str
    path: str
    model: str
    speech: Speech

    def spec(self, server: WireServer) -> str:
        """The name to give to --model."""
        url = f"{server.url}{self.path}"
        return f"{self.vendor}:{self.model}@{url}" if self.vendor else f"{url}#{self.model}"

    def provider(self, server: WireServer, **options: Any) -> Any:
        """A provider with quick retries."""
        quick = {"api_key": KEY, "deadline_s": 4.0, "first_wait_s": 0.01, "tries": 3}
        return make_provider(self.spec(server), **(quick | options))


WIRES: dict[str, Wire] = {
    "openai-chat": Wire("openai-chat", "/v1", "gpt-5", SPEECHES["pixels"]),
    "openai-responses": Wire("openai-responses", "/v1", "gpt-5", SPEECHES["pixels"]),
    "anthropic": Wire("anthropic", "", "claude-sonnet-4-6", SPEECHES["claude"]),
    "google": Wire("google", "", "gemini-2.5-pro", SPEECHES["gemini"]),
    "server": Wire("", "/v1", "qwen3-vl-8b-instruct", SPEECHES["thousandths"]),
}

OTHER_FAMILIES: dict[str, Wire] = {
    "qwen2.5": Wire(
        "", "/v1", "Qwen2.5-VL-7B-Instruct", Speech("xy", None, lambda s: qwen25_resize(s, high=12_845_056))
    ),
    "moondream": Wire("", "/v1", "moondream-3", SPEECHES["unit"]),
    "molmo": Wire("", "/v1", "Molmo-7B-D", SPEECHES["percent"]),
}
