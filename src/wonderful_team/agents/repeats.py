"""No picture twice in one request: words that name the other one stand in a repeated picture's place."""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team.core.pictures import Axes, Picture
from wonderful_team.core.values import Part, Words
from wonderful_team.images import same_pixels


def without_repeats(parts: Sequence[Part]) -> tuple[Part, ...]:
    """The parts without pictures that another one shows: the same pixels, and at least the same marks.

    Of two that show the same, the later stays, which for an instruction's picture is the view of the scene now. The picture
    in whose pixels an answer is given always stays.
    """
    pictures = [part for part in parts if isinstance(part, Picture)]
    named = {id(part.picture) for part in parts if isinstance(part, Words) and part.says == "positions"}
    kept = list(pictures)
    instead: dict[int, Picture] = {}
    for picture in pictures:
        other = next((one for one in kept if one is not picture and _shows(one, picture)), None)
        if other is not None and id(picture) not in named:
            kept.remove(picture)
            instead[id(picture)] = other
    about = {id(part.picture): part.about for part in parts if isinstance(part, Words) and part.says == "caption"}
    order = {id(picture): number for number, picture in enumerate(pictures)}

    def standing_for(picture: Picture) -> Picture:
        while id(picture) in instead:
            picture = instead[id(picture)]
        return picture

    said: list[Part] = []
    for part in parts:
        if (
            isinstance(part, Words)
            and part.says == "caption"
            and id(part.picture) in instead
            and part.picture is not None
        ):
            other = standing_for(part.picture)
            where = "below" if order[id(other)] > order[id(part.picture)] else "above"
            which = f"{where} ({about[id(other)]})" if about.get(id(other)) else where
            head = f'Picture "{part.picture.name}"' + (f", {part.about}" if part.about else "")
            said.append(Words(f'{head}: the same as picture "{other.name}" {which}, and not sent twice.'))
        elif not (isinstance(part, Picture) and id(part) in instead):
            said.append(part)
    return tuple(said)


def _shows(one: Picture, other: Picture) -> bool:
    """Whether `one` shows all that `other` does: the same pixels with at least its marks."""
    if not same_pixels(one, other):
        return False
    ticked = any(isinstance(mark, Axes) for mark in one.marks)
    return all(ticked if isinstance(mark, Axes) else mark in one.marks for mark in other.marks)
