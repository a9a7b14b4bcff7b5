"""OpenAI: Responses, and Chat Completions."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from wonderful_team.models.providers.vendors.vendor import Vendor, listed_facts, own_headers

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model as LibraryModel

MODULE = "pydantic_ai.models.openai"


def openai_client(base_url: str, key: str, client: httpx2.AsyncClient) -> Any:
    """OpenAI's own client, for everything that speaks its format."""
    from openai import AsyncOpenAI

    return own_headers(AsyncOpenAI)(base_url=base_url, api_key=key, http_client=client, max_retries=0)


def _chat(base_url: str, model: str, key: str, client: httpx2.AsyncClient) -> LibraryModel:
    from pydantic_ai.models.openai import OpenAIChatModel
    from pydantic_ai.providers.openai import OpenAIProvider

    return OpenAIChatModel(model, provider=OpenAIProvider(openai_client=openai_client(base_url, key, client)))


def _responses(base_url: str, model: str, key: str, client: httpx2.AsyncClient) -> LibraryModel:
    from pydantic_ai.models.openai import OpenAIResponsesModel
    from pydantic_ai.providers.openai import OpenAIProvider

    return OpenAIResponsesModel(model, provider=OpenAIProvider(openai_client=openai_client(base_url, key, client)))


RESPONSES = Vendor(
    "openai-responses",
    MODULE,
    _responses,
    "https://api.openai.com/v1",
    ("OPENAI_API_KEY",),
    "openai",
    settings={"max_retries": 0, "openai_store": False},
    takes_detail=True,
)
CHAT = replace(RESPONSES, api="openai-chat", build=_chat, settings={"max_retries": 0}, facts=listed_facts)
OPENAI = replace(RESPONSES, words="OpenAI (Responses); openai-chat:NAME for Chat Completions")
