"""What the answers ask of the eyes: the scene and the instruction's pictures of one question, and who is meant."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from wonderful_team.contracts import ShownSlot, ShownTask
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.core.text import MOST_IN_ORDER
from wonderful_team.core.values import Target
from wonderful_team.images.colours import COLOURS
from wonderful_team.offline.description import LINE_BY_LINE, SHAPES, Description, Way
from wonderful_team.offline.language import describe, render, try_describe, worded
from wonderful_team.offline.language.wording import corner_words
from wonderful_team.offline.pushing.sweeping import find_place, read_place
from wonderful_team.offline.vision import (
    Example,
    Match,
    NotSeen,
    Scene,
    Thing,
    free_spots,
    likeness,
    resolve,
    see,
    study_example,
    with_heights,
)
from wonderful_team.offline.vision.changes import came_to
from wonderful_team.offline.vision.relations import in_lines, shares_from

NEARLY_EQUAL = 0.06
"""Two scores closer than this, both good, are a genuine ambiguity (0 to 1)."""
GOOD = 0.55
"""A match with at least this score fits (0 to 1)."""
FEW = 5
"""So many things one counts at a glance; a field of more is counted line by line where its lines are clear."""
SHOWN = 0.5
"""Likeness from which a picture of a table shows a thing (0 to 1)."""
CLEARLY_LESS = 0.15
"""A thing whose likeness is this much lower is another one (0 to 1)."""
COLOURLESS = 0.6
"""From this degree of grey and plainness on, an example picture shows a shape and no looks (0 to 1)."""
RIM_FILL, RIM_ASPECT = 0.4, 4.0
"""A rim fills at most this share of the rectangle round it, which is at most so many times as long as wide."""
WHOLE = frozenset(
    ("whole", "centre", "center", "middle", "body", "inside", "interior", "surface", "top", "all", "top surface")
)
"""Parts that mean the thing as a whole."""


@dataclass(frozen=True, eq=False)
class Eyes:
    """One picture and the instruction's pictures shown with it.

    Attributes:
        looked_at: The picture that `scene` is seen in.
        examples: What the pictures of single things show, by name.
        pictures: The instruction's pictures of a whole table (scenes, frames), by name: the main camera's.
        heights: A second view that tells how tall things are where the first has no depth; None without one.
        facts: What is known of the robot and its place.
    """

    looked_at: Picture
    examples: Mapping[str, Example] = field(default_factory=dict)
    pictures: Mapping[str, Picture] = field(default_factory=dict)
    heights: Picture | None = None
    facts: tuple[str, ...] = ()

    @cached_property
    def scene(self) -> Scene:
        seen = see(self.looked_at)
        return seen if seen.has_depth or self.heights is None else with_heights(seen, self.heights)

    def here(self, shown: Picture, point: Point) -> Point:
        """Where the picture looked at shows a point of another picture of the same camera."""
        return self.looked_at.frame.point_to_picture(shown.frame.point_to_view(point))

    def find(self, description: Description) -> list[Match]:
        """What fits, best first; empty when nothing does or it cannot be judged by eye."""
        if description.placed is not None:
            return place_shown(description, self)
        if description.way is not None:
            return self.on_the_way(description.way, ())
        if description.like is not None and description.like not in self.examples:
            return []
        if is_free_area(description) and description.superlative is not None:
            return self._spots_at(description)
        try:
            found = resolve(self.scene, description, self.examples)
            by_shape = shape_alone(description, self.examples)
            if by_shape is not description:
                # A grey picture shows a shape; where something of that shape is grey too, that is meant.
                formed = resolve(self.scene, by_shape, self.examples)
                both = [match for match in found if match.thing in [other.thing for other in formed]]
                found = both if both and description.superlative is None else formed
            if not found and description.noun == "object" and description.shape is not None:
                # "the blue square" may well be a flat one, such as a sheet of paper.
                found = resolve(self.scene, replace(description, noun="thing"), self.examples)
            if not found and description.shape == "frame":
                # A frame may be open on one side: then it is a thin form that is no line.
                loose = resolve(self.scene, replace(description, noun="thing", shape=None), self.examples)
                found = [match for match in loose if match.thing is not None and is_rim(match.thing)]
        except NotSeen:
            return []
        return found

    def on_the_way(self, place: Way, plan: Sequence[str]) -> list[Match]:
        """Where a pushed thing comes to rest, by the plan's lines."""
        return find_place(place, self.scene, self.number, plan)

    def _spots_at(self, description: Description) -> list[Match]:
        """Free spots towards a side or corner of the picture, or with room for the largest thing, best first."""
        if description.superlative == "largest":
            most = max((thing.radius_px for thing in self.scene.objects), default=None)
            return free_spots(self.scene, radius_px=most) or free_spots(self.scene)
        wishes = description.name if " " in description.name else str(description.superlative)

        def away(match: Match) -> float:
            return float(sum(shares_from(self.scene, match.point, wishes))) - 0.1 * match.score

        return sorted(free_spots(self.scene, side=wishes, count=60), key=lambda match: round(away(match), 6))

    def best(self, description: Description) -> Match | None:
        """The best match, or None."""
        return next(iter(self.find(description)), None)

    def number(self, description: Description) -> int | None:
        """Number of the thing that is meant, or None."""
        best = self.best(one_of(description))
        return best.thing.number if best is not None and best.thing is not None else None

    def thing(self, number: int | None) -> Thing | None:
        return next((thing for thing in self.scene.things if thing.number == number), None)


def is_rim(thing: Thing) -> bool:
    outline = thing.look.outline
    return outline.fill < RIM_FILL and outline.aspect < RIM_ASPECT


def as_pictured(description: Description, matches: list[Match], eyes: Eyes) -> list[Match]:
    """Of several things that fit, those that a picture of a table among the instruction's pictures shows; else all.

    "the wooden object in {scene}" is the one of that form which the picture shows.
    """
    things = [match for match in matches if match.thing is not None]
    if len(things) < 2 or description.like is not None or description.placed is not None:  # noqa: PLR2004
        return matches
    for picture in eyes.pictures.values():
        shown = [match.thing for match in Eyes(picture).find(description) if match.thing is not None]
        rated = [max((likeness(match.thing, one) for one in shown), default=0.0) for match in things if match.thing]
        best = max(rated)
        if best >= SHOWN:
            return [match for match, value in zip(things, rated, strict=True) if value > best - CLEARLY_LESS]
    return matches


def shape_alone(description: Description, examples: Mapping[str, Example]) -> Description:
    """The same description, its example counting for its shape only where the picture shows a plain grey thing."""
    example = examples.get(description.like or "")
    if example is None or description.like_only is not None:
        return description
    look = example.look
    if look.colourless < COLOURLESS or look.patterns["plain"] < COLOURLESS:
        return description
    return replace(description, like_only="shape")


def is_free_area(description: Description) -> bool:
    """Whether free table is meant and not a thing or coloured region with looks of its own."""
    if description.placed is not None or description.way is not None:
        return False
    looks = description.colours or description.pattern or description.material or description.shape or description.like
    return description.noun == "area" and not looks


def eyes_of(picture: Picture, slots: Iterable[ShownSlot]) -> Eyes:
    """Look at a picture and at the instruction's pictures."""
    slots = tuple(slots)
    tables = {slot.name: slot.pictures[0] for slot in slots if slot.kind != "object" and slot.pictures}
    return Eyes(picture, examples_of(slots), tables)


def examples_of(slots: Iterable[ShownSlot]) -> dict[str, Example]:
    """What each of the instruction's pictures of a single object shows; those that show nothing are left out."""
    examples: dict[str, Example] = {}
    for slot in slots:
        if slot.kind != "object" or not slot.pictures:
            continue
        try:
            examples[slot.name] = study_example(slot.pictures[0])
        except NotSeen:
            continue
    return examples


def eyes_of_task(task: ShownTask) -> Eyes:
    """Look at a task's main view; without depth, a second view tells how tall things are."""
    return replace(eyes_of(task.main, task.slots), heights=next(iter(task.views[1:]), None), facts=task.facts)


def one_of(description: Description) -> Description:
    """The same description of a single thing."""
    return replace(description, quantity="one", number=1)


def target_description(target: Target) -> Description:
    """What a target's words say; its example picture decides where the words say more than the vocabulary holds.

    Raises:
        NotUnderstoodError: The words hold something unknown and no picture shows it.
    """
    description = _read_words(target)
    if target.alike != "both" and description.like is not None and description.like_only is None:
        return replace(description, like_only="texture" if target.alike == "surface" else "shape")
    return description


def _read_words(target: Target) -> Description:
    words = target.words
    on_the_way = read_place(words, target.where)
    if on_the_way is not None:
        return on_the_way
    if target.part and target.part.lower().strip() not in WHOLE:
        describe(target.part)  # refuses by name: parts are not told apart by eye
        words = f"{target.part} {target.words}" if try_describe(f"{target.part} {target.words}") else words
    placed = try_describe(words)
    if placed is not None and placed.placed is not None:
        since = target.like[0] if len(target.like) > 1 else None
        return replace(placed, like=target.like[-1] if target.like else placed.like, since=since)
    if target.like and "{" not in words and not target.where and "texture" not in target.like[0]:
        # The words say what the thing looks like; the picture decides.
        return Description(noun="object", text=words, like=target.like[0])
    if target.like:
        description = try_describe(words, target.where) or try_describe(words)
        if description is None:
            description = Description(noun="object", text=target.words, like=target.like[0])
        if description.like is None:
            description = replace(description, like=target.like[0])
            if "texture" in target.like[0]:
                description = replace(description, like_only="texture")
    else:
        description = describe(words, target.where)
    if target.kind == "area" and description.noun in ("object", "thing") and not description.like:
        description = worded(replace(description, noun="area"))
    return one_of(description)


def unique_words(eyes: Eyes, thing: Thing, noun: str, name: str = "", shape: str | None = None) -> Description:
    """Words that lead to this very thing alone in this picture, as simple as possible, checked by reading them back."""
    base = Description(noun=noun, text="", name=name, shape=shape)
    colour = thing.look.colours[0].name
    second = tuple(share.name for share in thing.look.colours[:2])
    tries = [replace(base, colours=(colour,))]
    if thing.look.pattern != "plain":
        tries.append(replace(base, colours=(colour,), pattern=thing.look.pattern))
        if len(second) == 2:
            tries.append(replace(base, colours=second, pattern=thing.look.pattern))
    if noun in ("object", "thing", "container") and shape is None and thing.look.shape in SHAPES:
        tries.append(replace(base, colours=(colour,), shape=thing.look.shape))
    tries = [replace(item, colours=tuple(c for c in item.colours if c in COLOURS)) for item in tries]
    for description in tries:
        # As it will be read: "the brown letter" is a letter, not an object shaped like one.
        matches = eyes.find(try_describe(render(description)) or description)
        if _means(matches, thing):
            return worded(description)
    return _by_place(eyes, thing, tries[0])


def _means(matches: list[Match], thing: Thing) -> bool:
    if not matches or matches[0].thing is None or matches[0].thing.number != thing.number:
        return False
    return len(matches) == 1 or matches[0].score - matches[1].score >= NEARLY_EQUAL


def _by_place(eyes: Eyes, thing: Thing, base: Description) -> Description:
    """Words such as "the second red block from the left"."""
    matches = [match for match in eyes.find(replace(base, quantity="all")) if match.thing is not None]
    fitting = [match.thing for match in matches if match.thing is not None]
    columns = [item.number for item in sorted(fitting, key=lambda item: item.centre[0])]
    rows = [item.number for item in sorted(fitting, key=lambda item: item.centre[1])]
    if thing.number not in columns:
        return worded(base)
    place = columns.index(thing.number) + 1
    candidates = [
        replace(base, superlative="leftmost", ordinal=place),
        replace(base, superlative="rightmost", ordinal=len(columns) + 1 - place),
        replace(base, superlative="topmost", ordinal=rows.index(thing.number) + 1),
    ]
    if len(fitting) <= FEW:
        return worded(next((one for one in candidates if _means(eyes.find(one), thing)), candidates[0]))
    counted = {way: [match.thing for match in in_lines(matches, way)] for way in LINE_BY_LINE}
    lines = [replace(base, superlative=way, ordinal=order.index(thing) + 1) for way, order in counted.items()]
    for description in (*lines, *candidates):
        found = eyes.find(description) if description.ordinal <= MOST_IN_ORDER else []
        if _means(found, thing) and found[0].score >= GOOD:
            return worded(description)
    return worded(candidates[0])


PICTURE_SIDES = {"leftmost": "on the left", "rightmost": "on the right", "topmost": "at the top",
                  "bottommost": "at the bottom", "middle": "in the middle"}  # fmt: skip


def side_words(side: str) -> str:
    """Such as "on the left", "in the top left corner"."""
    return f"in the {corner_words(side)} corner" if " " in side else PICTURE_SIDES[side]


def is_shown_alone(description: Description) -> bool:
    """Whether nothing but an example picture says which thing is meant."""
    told = description.superlative or description.related or description.placed or description.excluded
    return description.like is not None and description.like_only is None and not told


def seen_as(eyes: Eyes, thing: Thing) -> str:
    """Words such as "turquoise letter G" that lead to this thing alone wherever it lies, or "" where none do."""
    words = unique_words(eyes, thing, "letter" if thing.look.letter else "object", thing.look.letter)
    return words.text if words.superlative is None and eyes.number(words) == thing.number else ""


def told_apart(eyes: Eyes, thing: Thing, noun: str, name: str = "", shape: str | None = None) -> str:
    """Words for a thing in a choice: what it looks like and where it lies."""
    return f"the {unique_words(eyes, thing, noun, name, shape).text} ({place_words(thing, eyes.scene.size_px)})"


def place_words(thing: Thing, size_px: tuple[int, int]) -> str:
    """Where a thing lies in a picture, for a choice: "top left", "centre", "bottom right"."""
    column = ("left", "centre", "right")[min(2, int(3 * thing.centre[0] / size_px[0]))]
    row = ("top", "middle", "bottom")[min(2, int(3 * thing.centre[1] / size_px[1]))]
    if row == "middle":
        return column
    return row if column == "centre" else f"{row} {column}"


def place_shown(description: Description, eyes: Eyes) -> list[Match]:
    """The place where one of the instruction's pictures shows a thing, in the picture looked at; [] when it does not."""
    shown, box = eyes.pictures.get(description.like or ""), None
    if shown is None or description.placed is None:
        return []
    if description.since is not None and description.since in eyes.pictures:
        box = came_to(eyes.pictures[description.since], shown)
    elif (found := Eyes(shown).best(replace(description.placed, noun="thing"))) is not None:
        box = found.box
    if box is None:
        return []
    there = eyes.looked_at.frame.box_to_picture(shown.frame.box_to_view(box))
    why = f"picture {{{description.like}}} shows the {description.placed.text} there"
    return [Match(None, there, there.centre, 1.0, 1.0, why)]
