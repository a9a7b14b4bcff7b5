"""Anthropic."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wonderful_team.models.providers.vendors.vendor import Vendor, own_headers

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model as LibraryModel


def _build(base_url: str, model: str, key: str, client: httpx2.AsyncClient) -> LibraryModel:
    from anthropic import AsyncAnthropic
    from pydantic_ai.models.anthropic import AnthropicModel
    from pydantic_ai.providers.anthropic import AnthropicProvider

    sdk = own_headers(AsyncAnthropic)(base_url=base_url, api_key=key, http_client=client, max_retries=0)
    return AnthropicModel(model, provider=AnthropicProvider(anthropic_client=sdk))


ANTHROPIC = Vendor(
    "anthropic",
    "pydantic_ai.models.anthropic",
    _build,
    "https://api.anthropic.com",
    ("ANTHROPIC_API_KEY",),
    "anthropic",
    "Anthropic",
    headers=frozenset({"anthropic-version"}),
    package="anthropic",
)
