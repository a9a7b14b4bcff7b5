"""Orders by price: what they ask for in several people's words, and what is no such order."""

from __future__ import annotations

import pytest

from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.language import understand

PAPER = (
    "Based on the price tags and any discounts on the fruits, rank them from the most expensive to the cheapest and place "
    "them in the corresponding bowl."
)


@pytest.mark.parametrize(
    ("text", "order"),
    [
        (PAPER, "descending"),
        ("Rank the fruits from cheapest to most expensive and put each into its matching bowl", "ascending"),
        ("Sort the fruits by price, from the dearest to the cheapest, then put them into the numbered bowls.", "descending"),
        ("Judging by the price tags, order the fruits from the most expensive to the least expensive and place each one in the right bowl.", "descending"),
        ("Considering any discounts on the fruits, arrange them from the lowest price to the highest price and put them in their corresponding bowl", "ascending"),
    ],
)  # fmt: skip
def test_things_are_ordered_into_the_places_of_their_ranks(text: str, order: str) -> None:
    (command,) = understand(text).commands
    assert (command.kind, command.thing.noun, command.thing.quantity) == ("put", "fruit", "all")
    assert command.to is not None
    assert (command.to.how, command.to.side) == ("ranked", order)
    assert command.to.what is not None
    assert command.to.what.name == "bowl"


@pytest.mark.parametrize(
    "text",
    [
        "Rank the fruits from the most expensive to the dearest and place them in the corresponding bowl.",
        "Rank the fruits by weight from the heaviest to the lightest and place them in the corresponding bowl.",
        "Rank the unicorns from the most expensive to the cheapest and place them in the corresponding bowl.",
        "Rank them from the most expensive to the cheapest and place them in the corresponding bowl.",
    ],
)
def test_what_cannot_be_ordered_so_is_refused(text: str) -> None:
    with pytest.raises(NotUnderstoodError):
        understand(text)
