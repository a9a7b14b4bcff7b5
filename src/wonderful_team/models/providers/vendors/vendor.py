"""What has to be known of a maker's service or a kind of server: one value each, in the file that is named after it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias

from wonderful_team.models.providers.settings import Thinking

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model as LibraryModel

Build: TypeAlias = "Callable[[str, str, str, httpx2.AsyncClient], LibraryModel]"
"""The client library's model from base address, model, key and our connection pool; it may import the vendor's client."""
Place: TypeAlias = tuple[str, str, Mapping[str, Any] | None]
"""Method, address and body of a question beside the library."""


def no_places(base_url: str, model: str) -> tuple[Place, ...]:
    """The service says nothing of a model without being asked a question."""
    return ()


def listed_models(base_url: str, model: str) -> tuple[Place, ...]:
    """What the service says of its models stands in its list of them."""
    return (("GET", f"{base_url}/models", None),)


@dataclass(frozen=True)
class Vendor:
    """A service.

    Attributes:
        api: The format that it speaks, as records and cache keys name it.
        module: What is imported of the client library before the first request.
        build: Makes the library's model.
        base_url: Where the maker's own service is; "" for servers, which say where they are.
        keys: Environment variables that may hold its key.
        price_id: What the table of prices calls the maker.
        words: What `list models` says of it; "" for a further name of one that is listed.
        settings: Of every request.
        think: Settings of a request for a level of thinking.
        context: Where the length of a model's context stands, in order.
        key_header: How a question beside the library carries the key: name, and what goes before the key.
    """

    api: str
    module: str
    build: Build
    base_url: str = ""
    keys: tuple[str, ...] = ()
    price_id: str = ""
    words: str = ""
    settings: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({"max_retries": 0}))
    think: Callable[[Thinking], dict[str, Any]] = lambda level: {"thinking": False if level == "off" else level}
    context: Callable[[str, str], tuple[Place, ...]] = no_places
    key_header: tuple[str, str] = ("Authorization", "Bearer ")
