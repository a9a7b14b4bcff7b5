"""An order by price: "rank the fruits from the most expensive to the cheapest and place them in the corresponding bowl"."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

from wonderful_team.offline.description import Description
from wonderful_team.offline.language.commands import Command, Destination

_PRICES = r"(?:(?:the(?:ir)? )?(?:price tags?|prices?|discounts?|deals|offers)|any discounts?)"
_GIVEN = rf"(?:(?:based|going|judging) (?:on|by)|by|using|according to|considering|look(?:ing)? at) {_PRICES}(?:(?:,| and|, and) {_PRICES})*(?: (?:on|of|at|for|beside|under) (?P<of>[\w ]+?))?"
_DEAREST = r"(?:most|more) (?:expensive|costly)|dearest|priciest|highest price"
_CHEAPEST = r"cheapest|least (?:expensive|costly)|lowest price"
_FROM = rf"from (?:the )?(?P<first>{_DEAREST}|{_CHEAPEST}) to (?:the )?(?P<last>{_DEAREST}|{_CHEAPEST})"
_PUT = r"(?:place|put|bring|move|sort) (?:them|each|each one|each of them|it) (?:in|into|to) (?:the|its|their) (?:corresponding|matching|right|numbered|labelled|labeled|proper) (?P<into>\w+)"
_RANKED = re.compile(
    rf"(?:{_GIVEN},? )?(?:rank|order|sort|arrange) (?P<what>[\w ]+?)(?: by (?:their )?prices?,?)? {_FROM},? (?:and|then|and then),? {_PUT}",
    re.IGNORECASE,
)


def read_ranking(text: str, describe: Callable[[str], Description | None]) -> Command | None:
    """The command of a text that orders things by price into places that say their ranks; None for any other text."""
    found = _RANKED.fullmatch(" ".join(text.split()).strip(" .!"))
    if found is None:
        return None
    descending = re.fullmatch(_DEAREST, found["first"], re.IGNORECASE) is not None
    if descending == (re.fullmatch(_DEAREST, found["last"], re.IGNORECASE) is not None):
        return None
    words = found["of"] if found["what"].lower() in ("them", "these", "those") else found["what"]
    thing, into = describe(words or ""), describe(f"the {found['into']}")
    if thing is None or into is None:
        return None
    every = replace(thing, quantity="all") if thing.quantity == "one" else thing
    return Command("put", every, Destination("ranked", into, side="descending" if descending else "ascending"))
