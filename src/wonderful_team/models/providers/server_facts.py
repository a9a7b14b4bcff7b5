"""Asks a service what it says of a model without being asked a question; where that stands, its vendor's file knows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wonderful_team.models.providers.bounded import ReplyTooLargeError, fetch_json
from wonderful_team.models.providers.facts import UNKNOWN, Facts
from wonderful_team.models.providers.vendors.vendor import Vendor


def server_facts(
    service: Vendor, base_url: str, model: str, key: str | None, *, timeout_s: float = 5.0, direct: bool = True
) -> Facts:
    """What the service says of the model; a place that does not answer, in time and in bounds, ends the asking.

    Args:
        service: What speaks there.
        base_url: Its address, without a trailing slash.
        model: What the service calls the model.
        key: Sent as the service wants it; None for none.
        timeout_s: For each place asked.
        direct: Never through a proxy.
    """
    import httpx2

    name, before = service.key_header
    headers = {name: f"{before}{key}"} if key else {}

    def ask(method: str, url: str, body: Mapping[str, Any] | None = None) -> Any:
        status, found = fetch_json(method, url, headers=headers, timeout_s=timeout_s, direct=direct, body=body)
        return found if status == 200 else None

    try:
        return service.facts(ask, base_url, model)
    except (httpx2.HTTPError, ReplyTooLargeError):
        return UNKNOWN
