"""What tokens cost, and when nobody knows."""

from __future__ import annotations

import pytest

from wonderful_team.core.caps import Caps
from wonderful_team.core.values import Usage
from wonderful_team.errors import ConfigError
from wonderful_team.models.prices import GivenPrice, TablePrice, Unpriced, read_price
from wonderful_team.models.providers import check_prices, make_provider

USAGE = Usage(1, tokens_in=1_000_000, tokens_cached=400_000, tokens_thinking=50_000, tokens_out=50_000)


def test_a_given_price_counts_cached_input_and_thinking() -> None:
    assert GivenPrice(2, 10).usd(USAGE) == pytest.approx(2 + 1)
    assert GivenPrice(2, 10, 0.5).usd(USAGE) == pytest.approx(0.6 * 2 + 0.4 * 0.5 + 1)


@pytest.mark.parametrize(("text", "price"), [("3,15", GivenPrice(3, 15)), ("0,0", GivenPrice(0, 0)), ("3,15,0.3", GivenPrice(3, 15, 0.3))])  # fmt: skip
def test_prices_are_read(text: str, price: GivenPrice) -> None:
    assert read_price(text) == price


@pytest.mark.parametrize("text", ["", "3", "a,b", "1,2,3,4", "-1,2", "nan,2", "inf,1"])
def test_prices_in_another_form_are_refused(text: str) -> None:
    with pytest.raises(ConfigError):
        read_price(text)


@pytest.mark.parametrize(("vendor", "model"), [("openai", "gpt-4o"), ("anthropic", "claude-sonnet-4-5"), ("google", "gemini-2.5-pro")])  # fmt: skip
def test_the_table_knows_the_vendors_models(vendor: str, model: str) -> None:
    usd = TablePrice(vendor, model).usd(USAGE)
    assert usd is not None
    assert 0.1 < usd < 100


def test_an_unknown_model_has_no_price() -> None:
    assert TablePrice("openai", "no-such-model-at-all").usd(USAGE) is None
    assert Unpriced().usd(USAGE) is None


def test_a_local_server_is_never_billed_as_the_vendor_whose_name_it_uses() -> None:
    assert make_provider("http://127.0.0.1:9/v1#gpt-4o").prices.usd(USAGE) is None
    assert make_provider("openai:gpt-4o@http://127.0.0.1:9/v1", api_key="x").prices.usd(USAGE) is None
    assert make_provider("openai:gpt-4o", api_key="x").prices.usd(USAGE) is not None


def test_an_unknown_price_needs_a_cap_on_tokens_or_consent() -> None:
    unpriced = make_provider("http://127.0.0.1:9/v1#mine")
    with pytest.raises(ConfigError, match=r"no price is known for http://127\.0\.0\.1:9/v1#mine: set --max-tokens"):
        check_prices([unpriced], Caps(usd=1.0), allow_unpriced=False)
    check_prices([unpriced], Caps(tokens=1000), allow_unpriced=False)
    check_prices([unpriced], Caps(), allow_unpriced=True)
    check_prices([make_provider("http://127.0.0.1:9/v1#mine", price=GivenPrice(0, 0))], Caps(), allow_unpriced=False)
