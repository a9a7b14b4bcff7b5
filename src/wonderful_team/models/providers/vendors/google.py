"""Google Gemini."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wonderful_team.models.providers.facts import Facts, read_facts
from wonderful_team.models.providers.vendors.vendor import Ask, Vendor

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model as LibraryModel


def _build(base_url: str, model: str, key: str, client: httpx2.AsyncClient) -> LibraryModel:
    from pydantic_ai.models.google import GoogleModel
    from pydantic_ai.providers.google import GoogleProvider

    return GoogleModel(model, provider=GoogleProvider(api_key=key, base_url=base_url, http_client=client))


def _facts(ask: Ask, base_url: str, model: str) -> Facts:
    url = f"{base_url}/v1beta/models/{model}"
    return read_facts(ask("GET", url), model, f"GET {url}")


GOOGLE = Vendor(
    "google",
    "pydantic_ai.models.google",
    _build,
    "https://generativelanguage.googleapis.com",
    ("GOOGLE_API_KEY", "GEMINI_API_KEY"),
    "google",
    "Google Gemini",
    settings={},  # its client knows no max_retries; it does not try again by itself
    facts=_facts,
    key_header=("x-goog-api-key", ""),
    package="google.genai",
)
