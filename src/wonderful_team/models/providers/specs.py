"""What a model's name says: which vendor or server, which model, at which address."""

from __future__ import annotations

import ipaddress
import os
import socket
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import urlsplit, urlunsplit

from wonderful_team.errors import ConfigError, LocalOnlyError, ModelAuthError
from wonderful_team.models.providers.vendors import SERVER, SERVER_KEY, VENDORS, Vendor
from wonderful_team.redaction import keep_secret

_PRIVATE = tuple(
    ipaddress.ip_network(text)
    for text in ("10.0.0.0/8", "172.16.0.0/12", "192.168.0.0/16", "169.254.0.0/16", "fc00::/7", "fe80::/10")
)


@dataclass(frozen=True)
class Spec:
    """A model's name, taken apart.

    Attributes:
        vendor: Key of VENDORS; None for a server named by its address.
        model: What the service calls the model; "" when the server is to be asked.
        base_url: Address of the service.
        official: The address is the vendor's own: only then are its key sent and its prices believed.
    """

    text: str
    vendor: str | None
    model: str
    base_url: str
    official: bool

    @property
    def service(self) -> Vendor:
        """What speaks at the address: the vendor's format, or that of servers."""
        return SERVER if self.vendor is None else VENDORS[self.vendor]


def is_provider_spec(text: str) -> bool:
    """Whether a name means a vendor's model or a server."""
    return text.partition(":")[0].lower() in (*VENDORS, "http", "https")


def parse_spec(text: str, base_url: str | None = None) -> Spec:
    """Take a name apart: `openai:NAME`, `anthropic:NAME[@URL]`, `http://host:8000/v1[#NAME]`.

    Args:
        text: The name.
        base_url: Address to use instead of the vendor's own; `NAME@URL` says the same.

    Raises:
        ConfigError: Neither, or an address that holds a password or a key.
    """
    head, _, rest = text.partition(":")
    if head.lower() in ("http", "https"):
        address, _, model = text.partition("#")
        return Spec(text, None, model, checked_url(address), False)
    vendor = VENDORS.get(head.lower())
    if vendor is None:
        raise ConfigError(
            f"model {text!r}: valid are {', '.join(f'{name}:NAME' for name in VENDORS)} or http://host:8000/v1[#NAME]"
        )
    name, marker, address = rest.partition("@http")
    if marker:
        base_url = f"http{address}"
    if not name:
        raise ConfigError(f"model {text!r}: the model's name is missing, as in {head}:NAME")
    wrong = vendor.name_fault(name)
    if wrong:
        raise ConfigError(f"model {text!r}: {wrong}")
    if base_url is None:
        return Spec(text, head.lower(), name, vendor.base_url, True)
    url = checked_url(base_url)
    return Spec(text, head.lower(), name, url, url == vendor.base_url)


def checked_url(address: str) -> str:
    """The address without a trailing slash.

    Raises:
        ConfigError: It is none, or holds what does not belong into records (a password, a key); it is not repeated.
    """
    try:
        parts = urlsplit(address)
        host, _ = parts.hostname, parts.port
    except ValueError as error:
        raise ConfigError("the model's address is malformed; valid: http://host:8000/v1[#NAME]") from error
    if parts.username or parts.password or parts.query:
        raise ConfigError(
            "the model's address must hold no user, password or query (addresses are recorded); "
            f"put a key into the environment variable {SERVER_KEY}"
        )
    if not host or parts.scheme not in ("http", "https"):
        raise ConfigError(f"address {address!r}: valid is http://host:8000/v1[#NAME]")
    return urlunsplit((parts.scheme, parts.netloc, parts.path.rstrip("/"), "", ""))


def find_key(spec: Spec, given: str | None, environment: Mapping[str, str] | None = None) -> str | None:
    """The key to send. A vendor's key goes to that vendor's own address only.

    Raises:
        ModelAuthError: A vendor needs a key and none is set, or it is none that can be sent; names the variable.
    """
    held = os.environ if environment is None else environment
    holder = key_holder(spec, given, held)
    key = given or held.get(holder)
    keep_secret(key)
    if not key and spec.official:
        raise ModelAuthError(
            f"model {spec.text!r} needs a key: set the environment variable {' or '.join(_holders(spec))}"
        )
    if key and not (key.isascii() and key.isprintable() and " " not in key):
        raise ModelAuthError(
            f"model {spec.text!r}: {holder} holds spaces, line breaks or other characters that no key has"
        )
    return key or None


def key_holder(spec: Spec, given: str | None, environment: Mapping[str, str] | None = None) -> str:
    """What holds the key that is sent: a variable's name, the one to set where there is no key, or the argument."""
    held = os.environ if environment is None else environment
    if given:
        return "the argument api_key"
    names = _holders(spec)
    return next((name for name in names if held.get(name)), names[0])


def _holders(spec: Spec) -> tuple[str, ...]:
    return spec.service.keys if spec.official else (SERVER_KEY,)


def is_loopback(base_url: str) -> bool:
    """Whether an address means this very machine, without asking a name server."""
    host = urlsplit(base_url).hostname or ""
    if host == "localhost" or host.endswith(".localhost"):
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def require_local(spec: Spec) -> None:
    """Refuse every address outside this machine and private networks.

    Raises:
        LocalOnlyError: The address is public, or its name cannot be resolved.
    """
    if is_loopback(spec.base_url):
        return
    parts = urlsplit(spec.base_url)
    host = parts.hostname or ""
    try:
        found = {str(entry[4][0]).partition("%")[0] for entry in socket.getaddrinfo(host, None)}
    except OSError as error:
        raise LocalOnlyError(f"--local-only: {host!r} cannot be resolved, so it is not known to be local") from error
    public = sorted(address for address in found if not _is_private(address))
    if public or not found:
        raise LocalOnlyError(
            f"--local-only: model {spec.text!r} is at {host} ({', '.join(public) or 'no address'}), outside this machine "
            "and private networks; valid: a server at localhost or a private address, or offline"
        )


def _is_private(address: str) -> bool:
    parsed = ipaddress.ip_address(address)
    return parsed.is_loopback or any(parsed in network for network in _PRIVATE if network.version == parsed.version)
