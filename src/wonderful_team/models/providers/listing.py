"""Which models a server has: asked once, before anything else is sent."""

from __future__ import annotations

from typing import Any

from wonderful_team.errors import (
    ConfigError,
    MissingExtraError,
    ModelAuthError,
    ModelUnavailableError,
    UnknownModelError,
)
from wonderful_team.models.providers.bounded import ReplyTooLargeError, fetch_json
from wonderful_team.models.providers.faults import key_refused
from wonderful_team.models.providers.specs import is_loopback
from wonderful_team.models.providers.vendors import SERVER_KEY
from wonderful_team.redaction import redact


def server_models(
    base_url: str,
    key: str | None,
    *,
    timeout_s: float = 10.0,
    local_only: bool = False,
    key_holder: str = SERVER_KEY,
) -> list[str]:
    """Names of the models that an OpenAI-compatible server offers.

    Raises:
        ModelUnavailableError: Nothing answers there, or the server failed.
        UnknownModelError: What answers has no list of models: the address is probably wrong.
        ModelAuthError: It wants a key, or another one.
    """
    try:
        import httpx2
    except ImportError as error:
        raise MissingExtraError("models of vendors and servers", "vendors") from error
    headers = {"Authorization": f"Bearer {key}"} if key else {}
    direct = local_only or is_loopback(base_url)
    try:
        status, said = fetch_json("GET", f"{base_url}/models", headers=headers, timeout_s=timeout_s, direct=direct)
    except (httpx2.HTTPError, httpx2.InvalidURL, ReplyTooLargeError) as error:
        reason = f"{type(error).__name__}: {redact(str(error))}"
        raise ModelUnavailableError(f"no model server answers at {base_url} ({reason})") from None
    if status in (401, 403):
        raise ModelAuthError(key_refused(base_url, key, key_holder))
    if status >= 500:
        raise ModelUnavailableError(f"{base_url}/models failed with status {status}")
    found = _names(said) if status == 200 else None
    if found is None:
        raise UnknownModelError(
            f"{base_url}/models gives no list of models (status {status}); valid is the address under which the server "
            "offers the OpenAI interface, such as http://host:8000/v1"
        )
    return found


def only_model(base_url: str, names: list[str]) -> str:
    """The server's only model.

    Raises:
        ConfigError: It has none, or several: then one must be named.
    """
    if len(names) == 1:
        return names[0]
    if not names:
        raise ConfigError(f"{base_url} has no model loaded; name one as {base_url}#NAME")
    listed = ", ".join(f"{base_url}#{name}" for name in names)
    raise ConfigError(f"{base_url} has {len(names)} models; say which: {listed}")


def _names(data: Any) -> list[str] | None:
    entries = data.get("data", data.get("models")) if isinstance(data, dict) else data
    if not isinstance(entries, list):
        return None
    names = [
        entry if isinstance(entry, str) else entry.get("id") or entry.get("name")
        for entry in entries
        if isinstance(entry, str | dict)
    ]
    return [str(name) for name in names if name]
