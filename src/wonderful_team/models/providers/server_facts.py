"""What a service says of a model without being asked a question: how long its context is, and whether it is an Ollama."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from wonderful_team.models.providers.bounded import ReplyTooLargeError, fetch_json

_NAMES = (
    "max_model_len",
    "context_length",
    "max_context_length",
    "context_window",
    "inputTokenLimit",
    "n_ctx",
    "loaded_context_length",
)
"""Fields with a context length: vLLM and SGLang, OpenRouter and LM Studio, others, Google, llama.cpp."""
_NUM_CTX = re.compile(r"^\s*num_ctx\s+(\d+)\s*$", re.M)


@dataclass(frozen=True)
class Facts:
    """What a service says of one model.

    Attributes:
        context: Most tokens of a request and its answer together; None when the service does not say.
        source: Where that stands.
        ollama: The server is an Ollama: it cuts longer requests without a word (docs.ollama.com/context-length), and its
            context is that of the model as it is loaded, not what the model could take.
    """

    context: int | None = None
    source: str = ""
    ollama: bool = False

    def raised_by(self, tokens: int) -> str:
        """How a server gets a context of at least `tokens`."""
        wanted = 1 << max(1, tokens - 1).bit_length()
        if self.ollama:
            return f"start Ollama as OLLAMA_CONTEXT_LENGTH={wanted} ollama serve"
        return f"start the server with a longer one (vLLM: --max-model-len {wanted}; llama.cpp: -c {wanted})"


def server_facts(
    api: str, base_url: str, model: str, key: str | None, *, timeout_s: float = 5.0, direct: bool = True
) -> Facts:
    """What the service says of the model; a place that does not answer, in time and in bounds, ends the asking.

    Args:
        api: As providers call it: server, openrouter, google, …
        base_url: Address of the service, without a trailing slash.
        model: What the service calls the model.
        key: Sent as the service wants it; None for none.
        timeout_s: For each place asked.
        direct: Never through a proxy.
    """
    import httpx2

    headers = {} if not key else {"x-goog-api-key": key} if api == "google" else {"Authorization": f"Bearer {key}"}

    def asked(method: str, url: str, body: Mapping[str, Any] | None = None) -> Any:
        status, found = fetch_json(method, url, headers=headers, timeout_s=timeout_s, direct=direct, body=body)
        return found if status == 200 else None

    try:
        if api == "google":
            return _told(asked("GET", url := f"{base_url}/v1beta/models/{model}"), model, f"GET {url}")
        if api in ("server", "openrouter", "openai-chat"):
            facts = _told(asked("GET", url := f"{base_url}/models"), model, f"GET {url}")
            if facts.context is not None or api != "server":
                return facts
            root = base_url.removesuffix("/v1")
            facts = _told(asked("GET", url := f"{root}/props"), model, f"GET {url}")  # llama.cpp
            loaded = None if facts.context is not None else asked("GET", url := f"{root}/api/ps")
            if not (isinstance(loaded, dict) and isinstance(loaded.get("models"), list)):
                return facts
            facts = _told(loaded, model, f"GET {url}", ollama=True)
            if facts.context is not None:
                return facts
            return _ollama_setting(asked("POST", url := f"{root}/api/show", {"model": model}), f"POST {url}")
    except (httpx2.HTTPError, ReplyTooLargeError):
        pass
    return Facts()


def _told(found: Any, model: str, source: str, *, ollama: bool = False) -> Facts:
    length = _length(found, model)
    return Facts(length, "" if length is None else source, ollama)


def _ollama_setting(found: Any, source: str) -> Facts:
    """The context that a model which is not loaded will get, when its own settings fix one."""
    held = _NUM_CTX.search(str(found.get("parameters", ""))) if isinstance(found, dict) else None
    return Facts(int(held[1]), source, True) if held is not None else Facts(ollama=True)


def _length(found: Any, model: str) -> int | None:
    """The length in what came back: in the model's own entry of a list, else anywhere in it."""
    if isinstance(found, dict):
        listed = found.get("data", found.get("models"))
        if isinstance(listed, list):
            names = (model, f"{model}:latest")
            own = [
                entry
                for entry in listed
                if isinstance(entry, dict) and any(entry.get(name) in names for name in ("id", "name", "model"))
            ]
            return next((tokens for entry in own if (tokens := _anywhere(entry)) is not None), None)
    return _anywhere(found)


def _anywhere(value: Any) -> int | None:
    if not isinstance(value, dict):
        return None
    for name, item in value.items():
        if name in _NAMES and isinstance(item, int) and not isinstance(item, bool) and item > 0:
            return item
    return next((tokens for item in value.values() if (tokens := _anywhere(item)) is not None), None)
