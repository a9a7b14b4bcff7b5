"""Things ordered by the prices beside them, into places that say their ranks."""

from __future__ import annotations

import math
from dataclasses import replace

from wonderful_team.core.geometry import Box
from wonderful_team.offline.description import Description
from wonderful_team.offline.eyes import Eyes, unique_words
from wonderful_team.offline.goals.aims import Aim, Aims, Named
from wonderful_team.offline.language import render
from wonderful_team.offline.vision import Thing
from wonderful_team.offline.vision.prints import Card, read_cards

NEAR = 0.1
"""A card farther from a thing than this share of the picture's longer side says nothing of it."""
CLOSE = (0.08, 0.13)
"""So far round a thing, in shares of that side, cards are looked for: twice, as an engine misses a line now and then."""
WIDER = 0.065
"""So much wider than a thing, on each side, its card may be, in shares of that side."""
SAME_PRICE = 0.005
"""Prices that differ by less than this share are equal."""


def ranked_aims(things: list[Named], into: Description, descending: bool, eyes: Eyes, result: Aims) -> list[Aim]:
    """One aim per thing: into the place that states its rank by price, the dearest first if `descending`."""
    places = [match.thing.number for match in eyes.find(into) if match.thing is not None]
    ranked = [thing.number for thing in things if thing.number is not None]
    priced, ranks = _cards_of(ranked, places, eyes)
    numbered = {card.rank: number for number, card in ranks.items()}
    result.absent += [f"no price shows beside the {thing.words}" for thing in things if thing.number not in priced]
    cost = {number: card.price or 0.0 for number, card in priced.items()}
    ordered = sorted((t for t in things if t.number in cost), key=lambda t: cost[t.number or 0], reverse=descending)
    aims = []
    for rank, thing in enumerate(ordered, start=1):
        after = ordered[rank] if rank < len(ordered) else None
        if after is not None and math.isclose(cost[thing.number or 0], cost[after.number or 0], rel_tol=SAME_PRICE):
            result.absent.append(f"the {thing.words} and the {after.words} cost the same")
        if rank not in numbered:
            result.absent.append(f"no {into.text} that says it is number {rank} is in the picture")
            continue
        to = Named(_by_place(numbered[rank], places, into, eyes), numbered[rank])
        aims.append(
            Aim("put", thing, "in", to, why=f"{cost[thing.number or 0]:.2f} is number {rank} of {len(ordered)}")
        )
        result.notes.append(f"the {thing.words} costs {cost[thing.number or 0]:.2f} and is number {rank}")
    return aims


def _cards_of(ranked: list[int], places: list[int], eyes: Eyes) -> tuple[dict[int, Card], dict[int, Card]]:
    """The price of each thing and the rank of each place.

    Above and below them is looked first: what a thing's own pattern shows beside its card can keep an engine from seeing the card. Where
    that is not enough, all round them.
    """
    picture, longest = eyes.looked_at, max(eyes.looked_at.size_px)
    priced: dict[int, Card] = {}
    numbered: dict[int, Card] = {}
    boxes = [_thing(number, eyes).box for number in (*ranked, *places)]
    parts = [part for box in boxes for part in _above_and_below(box, longest)]
    for more in ([], [box.grown(*[share * longest] * 4) for share in CLOSE for box in boxes]):
        cards = read_cards(picture, [*parts, *more])
        priced = _beside(ranked, [card for card in cards if card.price is not None], eyes)
        numbered = _beside(places, [card for card in cards if card.rank is not None], eyes)
        if len(priced) == len(ranked) and len(numbered) == len(places):
            break
    return priced, numbered


def _above_and_below(box: Box, longest: int) -> tuple[Box, Box]:
    x0, x1, away = box.x0 - WIDER * longest, box.x1 + WIDER * longest, max(CLOSE) * longest
    return Box(x0, box.y0 - away, x1, box.y0), Box(x0, box.y1, x1, box.y1 + away)


def _by_place(number: int, places: list[int], into: Description, eyes: Eyes) -> Description:
    """Words such as "second bowl from the left": what says the ranks looks alike but for that."""
    ordered = sorted(places, key=lambda place: _thing(place, eyes).centre[0])
    words = replace(into, superlative="leftmost", ordinal=ordered.index(number) + 1)
    place = _thing(number, eyes)
    if eyes.number(words) != number:
        return unique_words(eyes, place, into.noun, into.name, into.shape)
    return replace(words, text=render(words))


def _thing(number: int, eyes: Eyes) -> Thing:
    thing = eyes.thing(number)
    assert thing is not None  # its number was found in this picture
    return thing


def _beside(numbers: list[int], cards: list[Card], eyes: Eyes) -> dict[int, Card]:
    """The card of each thing: nearest pairs first, each card and each thing once."""
    limit = NEAR * max(eyes.looked_at.size_px)
    pairs = []
    for number in numbers:
        pairs += [(_apart(_thing(number, eyes).box, card.box), at, number) for at, card in enumerate(cards)]
    found: dict[int, Card] = {}
    used: set[int] = set()
    for distance, at, number in sorted(pairs):
        if distance <= limit and at not in used and number not in found:
            found[number] = cards[at]
            used.add(at)
    return found


def _apart(one: Box, other: Box) -> float:
    """The gap between two boxes; a little more where they lie diagonally [px]."""
    dx = max(0.0, one.x0 - other.x1, other.x0 - one.x1)
    dy = max(0.0, one.y0 - other.y1, other.y0 - one.y1)
    aside = abs((one.x0 + one.x1) - (other.x0 + other.x1)) / 2
    return math.hypot(dx, dy) + 0.1 * aside
