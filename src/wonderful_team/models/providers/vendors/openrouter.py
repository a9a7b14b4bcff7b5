"""OpenRouter."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wonderful_team.models.providers.vendors.openai import openai_client
from wonderful_team.models.providers.vendors.vendor import Vendor, listed_facts

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model as LibraryModel


def _build(base_url: str, model: str, key: str, client: httpx2.AsyncClient) -> LibraryModel:
    from pydantic_ai.models.openrouter import OpenRouterModel
    from pydantic_ai.providers.openrouter import OpenRouterProvider

    class Lenient(OpenRouterModel):
        """The library insists on the name of who ran the model; gateways that speak the format may leave it out."""

        def _validate_completion(self, response: Any) -> Any:
            response.provider = getattr(response, "provider", None) or "unknown"
            return super()._validate_completion(response)

    return Lenient(model, provider=OpenRouterProvider(openai_client=openai_client(base_url, key, client)))


def _name_fault(name: str) -> str:
    if all(name.partition("/")[::2]):
        return ""
    return "OpenRouter's names are MAKER/NAME, as in openrouter:openai/gpt-5 or openrouter:qwen/qwen3-vl"


OPENROUTER = Vendor(
    "openrouter",
    "pydantic_ai.models.openrouter",
    _build,
    "https://openrouter.ai/api/v1",
    ("OPENROUTER_API_KEY",),
    "openrouter",
    "OpenRouter",
    facts=listed_facts,
    name_fault=_name_fault,
)
