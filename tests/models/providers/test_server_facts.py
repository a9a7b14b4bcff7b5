"""How long the context is, wherever a service says so."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.lab.probing_helpers import LOCAL
from tests.servers.odd import OddEyes
from tests.servers.server import WireServer
from wonderful_team.models.providers.facts import Facts, read_facts
from wonderful_team.models.providers.server_facts import server_facts
from wonderful_team.models.providers.vendors import SERVER


def test_vllm_says_it_in_its_list_of_models() -> None:
    with WireServer(OddEyes(), replace(LOCAL, models=("a", "b"), context=32768)) as server:
        found = server_facts(SERVER, f"{server.url}/v1", "b", None)
        assert found == Facts(32768, f"GET {server.url}/v1/models")


def test_a_server_that_does_not_say_is_unknown() -> None:
    with WireServer(OddEyes(), replace(LOCAL, models=("a",))) as server:
        assert server_facts(SERVER, f"{server.url}/v1", "a", None) == Facts()


def test_nothing_there_is_unknown() -> None:
    assert server_facts(SERVER, "http://127.0.0.1:9/v1", "a", None, timeout_s=0.5) == Facts()


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ({"data": [{"id": "other", "context_length": 1}, {"id": "m", "context_length": 128000}]}, 128000),
        ({"default_generation_settings": {"n_ctx": 8192}}, 8192),
        ({"models": [{"name": "m:latest", "model": "m:latest", "context_length": 4096}]}, 4096),
        ({"name": "models/m", "inputTokenLimit": 1048576}, 1048576),
        ({"data": [{"id": "other", "max_model_len": 4096}]}, None),
        ({"n_ctx": True}, None),
        ([], None),
    ],
)
def test_every_known_place_is_read(said: object, expected: int | None) -> None:
    assert read_facts(said, "m", "there") == Facts(expected, "there" if expected else "")
