"""Any server that speaks OpenAI's Chat Completions, named by its address: vLLM, SGLang, llama.cpp, Ollama, and others."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from wonderful_team.models.providers.facts import UNKNOWN, Facts, read_facts
from wonderful_team.models.providers.settings import Thinking
from wonderful_team.models.providers.vendors.openai import MODULE, openai_client
from wonderful_team.models.providers.vendors.vendor import Ask, Vendor, listed_facts

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model as LibraryModel

SERVER_KEY = "WONDERFUL_TEAM_SERVER_KEY"
"""Environment variable with the key for servers named by their address."""
_NUM_CTX = re.compile(r"^\s*num_ctx\s+(\d+)\s*$", re.M)


def _build(base_url: str, model: str, key: str, client: httpx2.AsyncClient) -> LibraryModel:
    from pydantic_ai.models.openai import OpenAIChatModel
    from pydantic_ai.profiles.openai import OpenAIModelProfile
    from pydantic_ai.providers.openai_compatible import OpenAICompatibleProvider

    # A served name says nothing about the server, so the library's guesses by name are replaced by the plain protocol.
    profile = OpenAIModelProfile(
        # Servers take all of JSON Schema; OpenAI's form would write "minLength" into the description instead.
        json_schema_transformer=None,
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


def _think(level: Thinking, facts: Facts = UNKNOWN) -> dict[str, Any]:
    """Servers have no common switch: the first is that of vLLM, SGLang and llama.cpp for models that think."""
    body: dict[str, Any] = {"chat_template_kwargs": {"enable_thinking": level != "off"}}
    if level != "off":
        body["reasoning_effort"] = level
    elif facts.ollama:
        # https://docs.ollama.com/api/openai-compatibility; others refuse this word.
        body["reasoning_effort"] = "none"
    return {"extra_body": body}


def _facts(ask: Ask, base_url: str, model: str) -> Facts:
    """vLLM, SGLang and LM Studio say it in their list of models; llama.cpp and Ollama elsewhere."""
    facts = listed_facts(ask, base_url, model)
    if facts.context is not None:
        return facts
    root = base_url.removesuffix("/v1")
    url = f"{root}/props"
    facts = read_facts(ask("GET", url), model, f"GET {url}")  # llama.cpp
    if facts.context is not None:
        return facts
    url = f"{root}/api/ps"
    loaded = ask("GET", url)
    if not (isinstance(loaded, dict) and isinstance(loaded.get("models"), list)):
        return facts
    facts = read_facts(loaded, model, f"GET {url}", ollama=True)
    if facts.context is not None:
        return facts
    url = f"{root}/api/show"
    return _ollama_setting(ask("POST", url, {"model": model}), f"POST {url}")


def _ollama_setting(found: Any, source: str) -> Facts:
    """The context that a model which is not loaded will get, when its own settings fix one."""
    held = _NUM_CTX.search(str(found.get("parameters", ""))) if isinstance(found, dict) else None
    return Facts(int(held[1]), source, True) if held is not None else Facts(ollama=True)


SERVER = Vendor("server", MODULE, _build, keys=(SERVER_KEY,), think=_think, facts=_facts)
