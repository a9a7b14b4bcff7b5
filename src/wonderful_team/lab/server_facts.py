"""What a service says of a model without being asked a question: how long its context is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wonderful_team.models.providers.bounded import ReplyTooLargeError, fetch_json
from wonderful_team.models.providers.vendors import Vendor

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


def context_length(
    service: Vendor, base_url: str, model: str, key: str | None, *, timeout_s: float = 5.0, direct: bool = True
) -> tuple[int, str] | None:
    """The model's context length [tokens] and where that stands; None when the service does not say.

    Args:
        service: What speaks there.
        base_url: Its address, without a trailing slash.
        model: What the service calls the model.
        key: Sent as the service wants it; None for none.
        timeout_s: For each place asked.
        direct: Never through a proxy.
    """
    name, before = service.key_header
    headers = {name: f"{before}{key}"} if key else {}
    for method, url, body in service.context(base_url, model):
        found = _fetched(method, url, body, headers, timeout_s, direct)
        tokens = _length(found, model)
        if tokens is not None:
            return tokens, f"{method} {url}"
    return None


def _fetched(
    method: str, url: str, body: Mapping[str, Any] | None, headers: dict[str, str], timeout_s: float, direct: bool
) -> Any:
    import httpx2

    try:
        status, found = fetch_json(method, url, headers=headers, timeout_s=timeout_s, direct=direct, body=body)
        return found if status == 200 else None
    except (httpx2.HTTPError, ReplyTooLargeError):
        # Most services have only one of these places.
        return None


def _length(found: Any, model: str) -> int | None:
    """The length in what came back: in the model's own entry of a list, else anywhere in it."""
    if isinstance(found, dict):
        listed = found.get("data", found.get("models"))
        if isinstance(listed, list):
            own = [
                entry for entry in listed if isinstance(entry, dict) and model in (entry.get("id"), entry.get("name"))
            ]
            return next((tokens for entry in own if (tokens := _anywhere(entry)) is not None), None)
    return _anywhere(found)


def _anywhere(value: Any) -> int | None:
    if not isinstance(value, dict):
        return None
    for name, item in value.items():
        is_length = name in _NAMES or (name.endswith(".context_length") and "." in name)
        if is_length and isinstance(item, int) and not isinstance(item, bool) and item > 0:
            return item
    return next((tokens for item in value.values() if (tokens := _anywhere(item)) is not None), None)
