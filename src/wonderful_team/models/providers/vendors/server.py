"""Any server that speaks OpenAI's Chat Completions, named by its address: vLLM, SGLang, llama.cpp, Ollama, and others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wonderful_team.models.providers.settings import Thinking
from wonderful_team.models.providers.vendors.openai import MODULE, openai_client
from wonderful_team.models.providers.vendors.vendor import Place, Vendor

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model as LibraryModel

SERVER_KEY = "WONDERFUL_TEAM_SERVER_KEY"
"""Environment variable with the key for servers named by their address."""


def _build(base_url: str, model: str, key: str, client: httpx2.AsyncClient) -> LibraryModel:
    from pydantic_ai.models.openai import OpenAIChatModel
    from pydantic_ai.profiles.openai import OpenAIJsonSchemaTransformer, OpenAIModelProfile
    from pydantic_ai.providers.openai_compatible import OpenAICompatibleProvider

    # A served name says nothing about the server, so the library's guesses by name are replaced by the plain protocol.
    profile = OpenAIModelProfile(
        json_schema_transformer=OpenAIJsonSchemaTransformer,
        supports_json_schema_output=True,
        supports_json_object_output=True,
        native_output_requires_schema_in_instructions=False,
        openai_chat_supports_max_completion_tokens=False,
        openai_supports_strict_tool_definition=False,
    )
    provider = OpenAICompatibleProvider(
        "server", openai_client=openai_client(base_url, key, client), profile=lambda _: profile
    )
    return OpenAIChatModel(model, provider=provider)


def _think(level: Thinking) -> dict[str, Any]:
    """Servers have no common switch: this is the one of vLLM, SGLang and llama.cpp for models that think."""
    body: dict[str, Any] = {"chat_template_kwargs": {"enable_thinking": level != "off"}}
    if level != "off":
        body["reasoning_effort"] = level
    return {"extra_body": body}


def _context(base_url: str, model: str) -> tuple[Place, ...]:
    root = base_url.removesuffix("/v1")
    return (
        ("GET", f"{base_url}/models", None),
        ("GET", f"{root}/props", None),  # llama.cpp
        ("POST", f"{root}/api/show", {"model": model}),  # Ollama
    )


SERVER = Vendor("server", MODULE, _build, keys=(SERVER_KEY,), think=_think, context=_context)
