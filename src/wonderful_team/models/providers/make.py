"""From a model's name to a provider that is ready to be asked."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wonderful_team.errors import ConfigError
from wonderful_team.models.conventions import PIXELS
from wonderful_team.models.families import Family, guess_family
from wonderful_team.models.prices import GivenPrice, Prices, TablePrice, Unpriced
from wonderful_team.models.providers import library
from wonderful_team.models.providers.listing import only_model, server_models
from wonderful_team.models.providers.provider import Provider
from wonderful_team.models.providers.settings import FIRST_WAIT_S, MAX_TOKENS, SERVER_MAX_TOKENS, Settings, Thinking
from wonderful_team.models.providers.specs import Spec, find_key, key_holder, parse_spec, require_local
from wonderful_team.models.wire import ENCODINGS, Encoding

if TYPE_CHECKING:
    from wonderful_team.models.profiles import Profile


def make_provider(
    spec: str,
    *,
    profile: Profile | None = None,
    thinking: Thinking | None = None,
    max_tokens: int | None = None,
    deadline_s: float | None = None,
    timeout_s: float | None = None,
    base_url: str | None = None,
    api_key: str | None = None,
    local_only: bool = False,
    encoding: Encoding = "auto",
    price: GivenPrice | None = None,
    tries: int = 5,
    first_wait_s: float = FIRST_WAIT_S,
) -> Provider:
    """A provider for a vendor's model or a server. Nothing is sent, except that a server without #NAME is asked for its models.

    Args:
        spec: VENDOR:NAME such as openai:NAME (also VENDOR:NAME@URL), or http://host:8000/v1[#NAME].
        profile: What `probe` measured; it takes the place of what the name suggests.
        thinking: off, low, medium or high; None leaves the service's default.
        max_tokens: Most tokens of one answer, thinking included.
        deadline_s: Longest time for one request with all its tries; None: time for two tries that time out.
        timeout_s: Longest time for one try; None: 150 s, with thinking 300 s, and more once the service has shown that it
            takes longer.
        base_url: Address to use instead of the vendor's own; a vendor's key is not sent there.
        api_key: Key to send; None takes it from the environment. It is kept out of every record, text and repr.
        local_only: Refuse addresses outside this machine and private networks.
        encoding: Of pictures' files: auto (photos without tick labels as JPEG, all else as PNG), png or jpeg.
        price: USD per million tokens, instead of the table's.
        tries: Most tries at one request when the provider fails.
        first_wait_s: Pause before the second try; it doubles.

    The client library is imported meanwhile, in a thread; whoever sends the first request waits for it.

    Raises:
        ConfigError: Wrong name, address, key, or option; the client library is missing.
        ModelUnavailableError: The server does not answer.
    """
    if thinking is not None and thinking not in MAX_TOKENS:
        raise ConfigError(f"thinking {thinking!r}: valid are off, low, medium, high")
    if encoding not in ENCODINGS:
        raise ConfigError(f"encoding {encoding!r}: valid are {', '.join(ENCODINGS)}")
    for name, value in {
        "deadline_s": deadline_s,
        "timeout_s": timeout_s,
        "tries": tries,
        "max_tokens": max_tokens,
    }.items():
        if value is not None and value <= 0:
            raise ConfigError(f"{name} must be positive, got {value}")
    parsed = parse_spec(spec, base_url)
    if local_only:
        require_local(parsed)
    key = find_key(parsed, api_key)
    library.preload(parsed.service, spec)
    holder = key_holder(parsed, api_key)
    model = parsed.model or only_model(
        parsed.base_url,
        server_models(
            parsed.base_url, key, timeout_s=min(10.0, deadline_s or 10.0), local_only=local_only, key_holder=holder
        ),
    )
    family = guess_family(model)
    most = max_tokens or (MAX_TOKENS[thinking] if parsed.vendor or thinking not in (None, "off") else SERVER_MAX_TOKENS)
    settings = Settings(
        thinking,
        most,
        deadline_s,
        tries,
        first_wait_s,
        timeout_s,
        weight=family.weight,
        encoding=encoding,
        tile_px=family.tile_px,
    )
    if parsed.service.takes_detail:
        settings = replace(settings, detail=family.detail)
    convention, weak = family.convention, family.weak_pointing
    if profile is not None:
        native = profile.native_points and profile.native_boxes
        convention = profile.convention if native else PIXELS
        weak = profile.axes or not native
        settings = replace(
            settings,
            schemas=profile.schemas != "refused",
            max_pictures=profile.max_pictures,
            context=profile.context_tokens,
            tile_px=None,  # measured with pictures in the sizes that they have
        )
    name = spec if parsed.model else f"{parsed.base_url}#{model}"
    return Provider(
        (profile.name if profile is not None else "") or name,
        parsed,
        model,
        convention,
        settings,
        _prices(parsed, model, price, profile),
        weak,
        local_only,
        "" if profile is not None else _note(name, family),
        key,
        holder,
    )


def load_library(spec: str) -> None:
    """Start to import, in a thread, what the service of such a name needs.

    Raises:
        ConfigError: No service has such a name, or its client library is missing.
    """
    library.preload(parse_spec(spec).service, spec)


def _note(name: str, family: Family) -> str:
    """Where the convention comes from, when it was not measured."""
    if family.sure == "unknown":
        return f"{name}: nothing is known of its numbers for places; it is asked for pixels. `probe` measures them"
    return (
        f"{name}: numbers for places as its name suggests (family {family.name}, {family.sure}). `probe` measures them"
    )


def _prices(spec: Spec, model: str, given: GivenPrice | None, profile: Profile | None) -> Prices:
    """A given price first, then the profile's; the table only for vendors at their own address."""
    if given is not None:
        return given
    if profile is not None and profile.usd_in is not None and profile.usd_out is not None:
        return GivenPrice(profile.usd_in, profile.usd_out)
    if spec.official:
        return TablePrice(spec.service.price_id, model)
    return Unpriced()
