"""Names, addresses and keys of models."""

from __future__ import annotations

import pytest

from wonderful_team.errors import ConfigError, LocalOnlyError, ModelAuthError
from wonderful_team.models.providers import SERVER_KEY, is_provider_spec, make_provider, parse_spec
from wonderful_team.models.providers.specs import find_key, require_local
from wonderful_team.models.providers.vendors import VENDORS


@pytest.mark.parametrize(
    ("text", "api", "model", "url", "official"),
    [
        ("openai:gpt-5", "openai-responses", "gpt-5", "https://api.openai.com/v1", True),
        ("openai-chat:gpt-5", "openai-chat", "gpt-5", "https://api.openai.com/v1", True),
        ("anthropic:claude-opus-5", "anthropic", "claude-opus-5", "https://api.anthropic.com", True),
        ("google:gemini-3", "google", "gemini-3", "https://generativelanguage.googleapis.com", True),
        ("openrouter:qwen/qwen3-vl", "openrouter", "qwen/qwen3-vl", "https://openrouter.ai/api/v1", True),
        ("anthropic:x@http://127.0.0.1:80/", "anthropic", "x", "http://127.0.0.1:80", False),
        ("openai-chat:x@https://proxy.example/v1", "openai-chat", "x", "https://proxy.example/v1", False),
        ("google:claude@20240229", "google", "claude@20240229", "https://generativelanguage.googleapis.com", True),
        ("http://gpu3:8000/v1", "server", "", "http://gpu3:8000/v1", False),
        ("http://gpu3:8000/v1/#Qwen/Qwen3-VL", "server", "Qwen/Qwen3-VL", "http://gpu3:8000/v1", False),
    ],
)
def test_names_are_taken_apart(text: str, api: str, model: str, url: str, official: bool) -> None:
    spec = parse_spec(text)
    assert is_provider_spec(text)
    assert (spec.service.api, spec.model, spec.base_url, spec.official) == (api, model, url, official)


@pytest.mark.parametrize(
    "text", ["openai:", "gpt-5", "http:///v1", "ftp://host/v1#x", "http://host:99999/v1", "http://[::1/v1"]
)
def test_other_names_are_refused(text: str) -> None:
    with pytest.raises(ConfigError):
        parse_spec(text)


@pytest.mark.parametrize(
    "text", ["openrouter:gpt-5.6", "openrouter:openai/", "openrouter:/gpt", "openrouter:m@http://h/v1"]
)
def test_an_openrouter_name_without_a_maker_says_what_is_valid(text: str) -> None:
    with pytest.raises(ConfigError, match="MAKER/NAME, as in openrouter:openai/gpt-5"):
        parse_spec(text)


@pytest.mark.parametrize(
    "text", ["http://me:s3cret@gpu3/v1#x", "http://gpu3/v1?api_key=s3cret#x", "openai:x@http://a:s3cret@gpu3/v1"]
)
def test_an_address_that_holds_a_secret_is_refused_without_repeating_it(text: str) -> None:
    with pytest.raises(ConfigError, match=SERVER_KEY) as caught:
        parse_spec(text)
    assert "s3cret" not in str(caught.value)


def test_a_vendors_key_goes_to_the_vendor_alone() -> None:
    held = {"OPENAI_API_KEY": "vendor-key", SERVER_KEY: "server-key"}
    assert find_key(parse_spec("openai:gpt-5"), None, held) == "vendor-key"
    assert find_key(parse_spec("openai:gpt-5@http://127.0.0.1:9/v1"), None, held) == "server-key"
    assert find_key(parse_spec("http://127.0.0.1:9/v1#gpt-5"), None, held) == "server-key"
    assert find_key(parse_spec("http://127.0.0.1:9/v1#gpt-5"), None, {"OPENAI_API_KEY": "vendor-key"}) is None


@pytest.mark.parametrize("vendor", sorted(VENDORS))
def test_a_missing_key_is_named_before_anything_is_sent(vendor: str) -> None:
    with pytest.raises(ModelAuthError, match=VENDORS[vendor].keys[0]):
        find_key(parse_spec(f"{vendor}:maker/m"), None, {})


@pytest.mark.parametrize(
    "address", ["127.0.0.1", "localhost", "[::1]", "10.1.2.3", "192.168.0.7", "172.31.9.9", "169.254.1.1", "[fd00::1]"]
)
def test_local_addresses_pass(address: str) -> None:
    require_local(parse_spec(f"http://{address}:8000/v1#m"))


@pytest.mark.parametrize("address", ["8.8.8.8", "172.32.0.1", "192.0.2.1", "100.64.0.1", "[2001:db8::1]", "0.0.0.0"])
def test_public_addresses_are_refused(address: str) -> None:
    with pytest.raises(LocalOnlyError, match="outside this machine and private networks"):
        require_local(parse_spec(f"http://{address}:8000/v1#m"))


def test_local_only_refuses_a_name_that_resolves_elsewhere_or_not_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    found = [(2, 1, 6, "", ("10.0.0.1", 0)), (2, 1, 6, "", ("8.8.8.8", 0))]
    monkeypatch.setattr("socket.getaddrinfo", lambda *_: found)
    with pytest.raises(LocalOnlyError, match=r"8\.8\.8\.8"):
        make_provider("http://gpu3:8000/v1#m", local_only=True)
    with pytest.raises(LocalOnlyError):
        make_provider("anthropic:claude-opus-5", api_key="x", local_only=True)

    def unknown(*_: object) -> list[object]:
        raise OSError("no such host")

    monkeypatch.setattr("socket.getaddrinfo", unknown)
    with pytest.raises(LocalOnlyError, match="cannot be resolved"):
        make_provider("http://gpu3:8000/v1#m", local_only=True)
    monkeypatch.setattr("socket.getaddrinfo", lambda *_: found[:1])
    assert make_provider("http://gpu3:8000/v1#m", local_only=True).local_only


def test_no_key_in_what_is_printed_or_recorded() -> None:
    provider = make_provider("anthropic:claude-opus-5", api_key="very-own-secret-word")
    assert "very-own-secret-word" not in repr(provider) + str(provider.identity) + provider.name
