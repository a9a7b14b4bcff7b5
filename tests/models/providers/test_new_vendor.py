"""A vendor that this file defines and adds as one row: its models are found, priced, keyed and asked as any other's."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from dataclasses import replace

import pytest

import wonderful_team as wt
from tests.models.wire.scenes import answer_px, picture, reading
from tests.servers.brains import AgentSession, Tapped, typed_brain
from tests.servers.server import KEY, Rules, WireServer
from tests.servers.wiring import WIRES
from wonderful_team.errors import ConfigError, ModelAuthError
from wonderful_team.models.client import ModelClient
from wonderful_team.models.prices import TablePrice
from wonderful_team.models.providers import is_provider_spec, library, parse_spec
from wonderful_team.models.providers.facts import Facts
from wonderful_team.models.providers.server_facts import server_facts
from wonderful_team.models.providers.vendors import VENDORS, Vendor
from wonderful_team.models.providers.vendors.openai import CHAT

VIEW = picture()
MODEL = WIRES["openai-chat"].model


@pytest.fixture
def desk() -> AgentSession:
    return AgentSession()


@pytest.fixture
def acme(monkeypatch: pytest.MonkeyPatch, desk: AgentSession) -> Iterator[Vendor]:
    brain = typed_brain(desk, lambda _: answer_px(VIEW), WIRES["openai-chat"].speech)
    with WireServer(brain, Rules()) as server:
        row = replace(CHAT, api="acme", base_url=f"{server.url}/v1", keys=("ACME_KEY",), price_id="acme", words="Acme")
        monkeypatch.setitem(VENDORS, "acme", row)
        yield row


def test_its_model_answers_at_its_own_address_with_its_own_key(
    acme: Vendor, desk: AgentSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ModelAuthError, match="ACME_KEY"):
        wt.make_model(f"acme:{MODEL}")
    monkeypatch.setenv("ACME_KEY", KEY)
    model = wt.make_model(f"acme:{MODEL}")
    answer = asyncio.run(ModelClient(Tapped(model, desk)).ask(reading(VIEW, ())))
    assert [target.found for target in answer.value.targets] == [one["found"] for one in answer_px(VIEW)["targets"]]
    assert model.identity["api"] == "acme"  # type: ignore[attr-defined]
    assert model.prices == TablePrice("acme", MODEL)  # type: ignore[attr-defined]
    assert KEY not in repr(model)


def test_its_name_means_it_wherever_names_are_read(acme: Vendor) -> None:
    assert is_provider_spec("acme:m")
    assert parse_spec("acme:m").service is acme
    assert not parse_spec("acme:m@http://127.0.0.1:9/v1").official
    assert server_facts(acme, acme.base_url, "unknown", KEY) == Facts()


def test_its_key_and_headers_may_be_its_own_and_no_others_leave(acme: Vendor, monkeypatch: pytest.MonkeyPatch) -> None:
    row = replace(acme, key_header=("X-Acme-Key", "Token "), headers=frozenset({"x-acme-version"}))
    monkeypatch.setitem(VENDORS, "acme", row)
    given = {"X-Acme-Key": f"Token {KEY}", "X-Acme-Version": "1", "X-Team": "leaked"}

    async def sent() -> dict[str, str]:
        client = library.http_client(parse_spec("acme:m"), KEY, True)
        try:
            return dict((await client.get(f"{row.base_url}/models", headers=given)).request.headers)
        finally:
            await client.aclose()

    headers = asyncio.run(sent())
    assert headers["x-acme-key"] == f"Token {KEY}"
    assert headers["x-acme-version"] == "1"
    assert "x-team" not in headers


def test_its_names_may_have_a_form(acme: Vendor, monkeypatch: pytest.MonkeyPatch) -> None:
    row = replace(acme, name_fault=lambda name: "" if "/" in name else "names are MAKER/NAME")
    monkeypatch.setitem(VENDORS, "acme", row)
    assert parse_spec("acme:a/m").model == "a/m"
    with pytest.raises(ConfigError, match="names are MAKER/NAME"):
        parse_spec("acme:m")


@pytest.mark.parametrize("name", sorted(VENDORS))
def test_every_vendor_says_what_the_table_asks_for(name: str) -> None:
    vendor = VENDORS[name]
    assert vendor.base_url.startswith("https://")
    assert all(key.isupper() for key in vendor.keys)
    assert vendor.keys
    assert vendor.price_id
    assert set(vendor.think("off")) == {"thinking"}
