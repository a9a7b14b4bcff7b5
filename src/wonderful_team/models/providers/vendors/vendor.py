"""What has to be known of a maker's service or a kind of server: one value each, in the file that is named after it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

from wonderful_team.models.providers.facts import UNKNOWN, Facts, read_facts
from wonderful_team.models.providers.settings import Thinking

if TYPE_CHECKING:
    import httpx2
    from pydantic_ai.models import Model as LibraryModel

Build: TypeAlias = "Callable[[str, str, str, httpx2.AsyncClient], LibraryModel]"
"""The client library's model from base address, model, key and our connection pool; it may import the vendor's client."""


class Ask(Protocol):
    """A question beside the library: what the service sends back as JSON; None for every status but 200."""

    def __call__(self, method: str, url: str, body: Mapping[str, Any] | None = None) -> Any: ...


class Think(Protocol):
    """Settings of a request for a level of thinking."""

    def __call__(self, level: Thinking, facts: Facts = ...) -> dict[str, Any]: ...


def no_facts(ask: Ask, base_url: str, model: str) -> Facts:
    """The service says nothing of a model without being asked a question."""
    return UNKNOWN


def listed_facts(ask: Ask, base_url: str, model: str) -> Facts:
    """What the service says of a model stands in its list of them."""
    url = f"{base_url}/models"
    return read_facts(ask("GET", url), model, f"GET {url}")


def library_think(level: Thinking, facts: Facts = UNKNOWN) -> dict[str, Any]:
    """The client library's own switch."""
    return {"thinking": False if level == "off" else level}


def any_name(name: str) -> str:
    """Whatever stands there may be a model's name."""
    return ""


def own_headers(client_class: type[Any]) -> type[Any]:
    """A vendor's client that gives no header a value from OPENAI_CUSTOM_HEADERS or ANTHROPIC_CUSTOM_HEADERS.

    Every copy that the library makes of it reads these variables again.
    """

    class Own(client_class):  # type: ignore[misc]
        @property
        def default_headers(self) -> Any:
            self._custom_headers: Any = {}
            return super().default_headers

    return Own


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
        takes_detail: It has a switch for the detail in which pictures are to be looked at.
        facts: What the service says of a model without being asked a question.
        name_fault: What is wrong with a model's name; "" when nothing is.
        key_header: How a question beside the library carries the key, and a request may: name, and what goes before the key.
        headers: Further headers of its format, in lower case; no others leave this machine.
        package: The vendor's own client, which `module` imports.
    """

    api: str
    module: str
    build: Build
    base_url: str = ""
    keys: tuple[str, ...] = ()
    price_id: str = ""
    words: str = ""
    settings: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({"max_retries": 0}))
    think: Think = library_think
    takes_detail: bool = False
    facts: Callable[[Ask, str, str], Facts] = no_facts
    name_fault: Callable[[str], str] = any_name
    key_header: tuple[str, str] = ("Authorization", "Bearer ")
    headers: frozenset[str] = frozenset()
    package: str = "openai"
