"""What is known of a model without asking it a question: how long its context is, and whether an Ollama serves it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

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


UNKNOWN = Facts()
"""Of a service that says nothing, or was not asked yet."""


def read_facts(found: Any, model: str, source: str, *, ollama: bool = False) -> Facts:
    """The length of the model's context in what one place said, wherever it stands there."""
    length = _length(found, model)
    return Facts(length, "" if length is None else source, ollama)


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
