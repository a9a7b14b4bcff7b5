"""resolve(): which things in a scene a description means; nothing at all when nothing fits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from wonderful_team.core.pictures import Point
from wonderful_team.offline.description import Description
from wonderful_team.offline.vision.examples import alike, alike_pattern
from wonderful_team.offline.vision.kinds import formed, is_kind_here, kind_score, named_score
from wonderful_team.offline.vision.materials import material_score
from wonderful_team.offline.vision.relations import pick_in_corner, pick_superlative, relation_score
from wonderful_team.offline.vision.spots import free_spots
from wonderful_team.offline.vision.things import Example, Look, Match, NotSeen, Scene, Thing, with_margins

FITS = 0.4
"""Score from which a thing is taken to fit a description."""

_SAME_SURFACE = 0.45
"""Likeness from which two things have the same colour or texture."""

_NEARLY_AS_ALIKE = 0.83
"""Share of the best likeness of shapes from which another thing has that shape too."""

_NEARLY_AS_COLOURED = 0.8
"""Of several that are told by a colour, those that fit at least this share as well as the best are meant."""

NEAR_BEST = 0.75
"""Share of the best score from which things like an example are compared with each other or meant together."""
_OTHER_FORM = 0.8
"""What is left of the likeness to a form of one that has another name than the best one."""
_TEXTURE = 0.25
"""How much the likeness of its texture to the best one's counts there (an exponent)."""

_WEIGHTS = {"colour": 0.7, "pattern": 0.5, "outline": 1.0, "size": 0.35}
"""How much each aspect of an example counts (exponents of a weighted geometric mean)."""


def resolve(scene: Scene, description: Description, examples: Mapping[str, Example]) -> list[Match]:
    """Everything in a scene that fits a description, best first; [] when it is not here.

    Args:
        scene: What was seen.
        description: What is meant.
        examples: Studied example pictures by slot name.

    Raises:
        NotSeen: The description is like a picture that is not among the examples.
    """
    if description.noun == "area" and not _has_look(description):
        return _spots(scene, description, examples)
    matches = _fitting(scene, description, examples)
    if description.colours and not (description.pattern or description.material):
        # Beside a yellow block, one in yellow and blue is not meant.
        matches = [m for m in matches if m.score >= _NEARLY_AS_COLOURED * max(other.score for other in matches)]
    for related in description.related:
        matches = _related(scene, matches, related.relation, related.to, examples)
    several = description.quantity != "one" and description.like_only is None
    if matches and description.like is not None and (several or description.superlative is not None):
        matches = _like_the_best(matches, textured=description.like_only != "shape")
    if description.superlative is not None:
        corner = " " in description.name
        matches = (
            pick_in_corner(scene, matches, description.name)
            if corner
            else pick_superlative(matches, description.superlative, description.ordinal)
        )
    matches.sort(key=lambda match: -match.score)
    return with_margins(matches)


def suits(
    thing: Thing, description: Description, examples: Mapping[str, Example], view_scale: float
) -> tuple[float, dict[str, float]]:
    """How well one thing by itself fits a description's looks (not its relations): score and parts, each 0 to 1."""
    parts: dict[str, float] = {}
    score = 1.0
    if description.like is not None:
        if description.like not in examples:
            raise NotSeen(f"no example picture {description.like!r}; known: {', '.join(examples) or 'none'}")
        like = alike(examples[description.like], thing, view_scale, description.like_only)
        score *= example_score(like)
        parts |= like
    parts["kind"] = kind_score(thing, description)
    score *= parts["kind"]
    if description.name:
        parts["name"] = named_score(thing, description)
        score *= parts["name"]
    if description.colours:
        parts["words: colour"] = colour_fit(thing.look, description)
        score *= parts["words: colour"]
    if description.pattern is not None:
        parts["words: pattern"] = pattern_fit(thing.look, description.pattern)
        if not description.colours and description.pattern != "plain":
            # A pattern named without a colour is black and white where there is a choice.
            parts["words: pattern"] *= 0.6 + 0.4 * thing.look.colourless
        score *= parts["words: pattern"]
    if description.material is not None:
        parts["words: material"] = float(np.clip(material_score(thing.look, description.material) / 0.6, 0, 1))
        score *= parts["words: material"]
    if description.shape is not None:
        parts["words: shape"] = shape_fit(thing, description.shape)
        score *= parts["words: shape"]
    return float(score), parts


def example_score(parts: Mapping[str, float]) -> float:
    """One score from the aspects of an example: any aspect that is wholly wrong decides."""
    weights = np.array([_WEIGHTS[name] for name in parts])
    values = np.array([max(value, 1e-3) for value in parts.values()])
    mean = float(np.exp((weights * np.log(values)).sum() / weights.sum()))
    # A wrong colour is not outweighed by all the rest.
    return float(mean * parts.get("colour", 1.0) ** 0.7)


def colour_fit(look: Look, description: Description) -> float:
    """How well the colours named in words fit what shows, 0 to 1; all must show."""
    patterned = description.pattern not in (None, "plain") or description.material is not None
    needed = {1: 0.24 if patterned else 0.45, 2: 0.24}.get(len(description.colours), 0.1)
    scores, shown = [], 0.0
    for name in description.colours:
        own, *others = (look.memberships[alias] * weight for alias, weight in _aliases(name, description.dark))
        # Near colours add to what shows of a colour itself and do not stand in for it: an olive ring is not green.
        share = own + (min(sum(others), own) if description.dark is None else sum(others))
        score = float(np.clip(share / needed, 0, 1))
        shown += share
        if len(description.colours) == 1:
            score *= 0.75 + 0.25 * min(1.0, share / 0.9)
            if description.pattern is None and description.material is None:
                score *= 0.85 + 0.15 * look.patterns["plain"]
            score *= _shade_fit(look, name, description.dark)
        scores.append(score)
    together = float(np.clip(shown / 0.7, 0, 1)) if len(description.colours) > 1 else 1.0
    return float(min(scores) * together)


_CONFUSED = ("swirled", "dotted", "mottled", "checkered")
"""Patterns of patches that are hard to tell apart where only a little of them shows."""
_LITTLE = 1000
"""A thing of fewer pixels shows too little of a pattern to be sure of it."""


def pattern_fit(look: Look, pattern: str) -> float:
    """How well a pattern named in words fits, 0 to 1; thin and small things show too little of one to be sure of it."""
    own = float(np.clip(look.patterns[pattern] / 0.45, 0, 1))
    if pattern == "multicoloured":
        return max(own, _rainbow(look))
    if pattern in _CONFUSED and (look.outline.hole_share > 0.2 or look.outline.filled_area < _LITTLE):
        own = max(own, 0.7 * float(np.clip(max(look.patterns[name] for name in _CONFUSED) / 0.45, 0, 1)))
    return max(own, _bands(look)) if pattern == "swirled" else own


def _bands(look: Look) -> float:
    """How far broad bands of one colour run through white, as in a swirl of which a part shows, 0 to 1."""
    white = float(np.clip((look.memberships["white"] - 0.25) / 0.08, 0, 1))
    return 0.8 * white * float(np.clip((look.surface.two_tone - 0.88) / 0.06, 0, 1))


def _rainbow(look: Look) -> float:
    """How far a surface runs smoothly through several hues, 0 to 1."""
    hues = sum(share > 0.08 for name, share in look.memberships.items() if name not in ("white", "grey", "black"))
    return float(np.clip(hues - 2, 0, 1) * np.clip((14 - look.surface.contrast) / 2, 0, 1))


def _aliases(name: str, dark: bool | None) -> tuple[tuple[str, float], ...]:
    """Names under which a colour may show: dark orange looks brown, dark yellow olive, …"""
    near: dict[str, tuple[tuple[str, float], ...]] = {
        "orange": (("brown", 0.9 if dark else 0.2), ("red", 0.05)),
        "yellow": (("olive", 0.9 if dark else 0.2), ("brown", 0.4 if dark else 0.0)),
        "pink": (("purple", 0.7 if dark else 0.15), ("red", 0.4 if dark else 0.1)),
        "purple": (("pink", 0.15), ("blue", 0.12)),
        "red": (("brown", 0.5 if dark else 0.15), ("pink", 0.15)),
        "blue": (("cyan", 0.9 if dark is False else 0.2), ("purple", 0.1)),
    }
    even = {"cyan": "blue green", "green": "olive cyan", "olive": "green yellow brown", "brown": "orange red olive",
            "grey": "white black", "white": "grey", "black": "grey"}  # fmt: skip
    return ((name, 1.0), *near.get(name, tuple((alias, 0.2) for alias in even.get(name, "").split())))


def _shade_fit(look: Look, name: str, dark: bool | None) -> float:
    """How well light or dark fits: asked for, or a mild preference for neither when nothing was said."""
    shares = [colour for colour in look.colours if colour.name == name] or list(look.colours[:1])
    colour = shares[0]
    renamed = colour.name != name
    if dark is None:
        return 1.0 - 0.15 * colour.dark - 0.05 * colour.light
    stands_for_it = renamed and colour.name in (("brown", "olive") if dark else ("cyan",))
    return 0.3 + 0.7 * max(
        colour.dark if dark else colour.light, 0.8 * stands_for_it * (1.0 if dark else 1 - colour.dark)
    )


_ON_A_CORNER = 0.56
"""A square fills at most this share of the upright box round it where it stands on a corner, as a diamond does."""


def shape_fit(thing: Thing, shape: str) -> float:
    """How well a shape named in words fits, 0 to 1: its own fit, and not far behind the best shape."""
    standing = shape == "diamond" and thing.area_px < _ON_A_CORNER * thing.box.width * thing.box.height
    outlines = ("diamond", "square") if standing else (shape,)
    own = max(thing.look.shapes[name] for name in outlines)
    return float(np.clip((own - 0.2) / 0.4, 0, 1)) * formed(thing.look, outlines)


def _has_look(description: Description) -> bool:
    return bool(
        description.colours or description.pattern or description.material or description.shape or description.like
    )


_MOST_KEPT = 1024
_kept: WeakKeyDictionary[Scene, dict[Any, tuple[Match, ...]]] = WeakKeyDictionary()
"""What fits looks, by scene: plans, their checks and their words ask the same of the same things again and again."""


def _fitting(scene: Scene, description: Description, examples: Mapping[str, Example]) -> list[Match]:
    """The things whose looks fit, whatever they are related to."""
    said = description
    example = examples.get(said.like) if said.like is not None else None
    key = (
        said.noun,
        said.name,
        said.colours,
        said.dark,
        said.pattern,
        said.shape,
        said.material,
        said.like,
        said.like_only,
    )
    known = _kept.setdefault(scene, {})
    found = known.get((key, example))
    if found is None:
        if len(known) >= _MOST_KEPT:
            known.clear()
        found = known[key, example] = tuple(_judged(scene, description, examples))
    return list(found)


def _judged(scene: Scene, description: Description, examples: Mapping[str, Example]) -> list[Match]:
    out = []
    for thing in scene.things:
        score, parts = suits(thing, description, examples, scene.view_scale)
        if score < FITS or not is_kind_here(thing, description.noun, scene):
            continue
        why = f"{thing.look.words}: " + ", ".join(f"{name} {value:.2f}" for name, value in parts.items())
        out.append(Match(thing, thing.box, _point_on(scene, thing), score, score, why, parts))
    return out


def _like_the_best(matches: list[Match], *, textured: bool) -> list[Match]:
    """Those nearly as like an example as the best one, and like that one: within one picture this shows better."""
    looks = [(match, match.thing.look) for match in matches if match.thing is not None]
    best, look = max(looks, key=lambda pair: pair[0].score)

    def same(own: Look) -> float:
        if textured:
            return float(alike_pattern(look, own) ** _TEXTURE)
        return 1.0 if (own.shape, own.letter) == (look.shape, look.letter) else _OTHER_FORM

    return [match for match, own in looks if match.score * same(own) >= NEAR_BEST * best.score]


def _point_on(scene: Scene, thing: Thing) -> Point:
    """A point on a thing; on an area with things on it, the best free place if there is one."""
    if thing.flat and scene.on(thing):
        room = free_spots(scene, inside=thing, radius_px=0.2 * thing.radius_px, count=1)
        if room:
            return room[0].point
    return thing.steady_point()


def _related(
    scene: Scene, matches: list[Match], relation: str, to: tuple[Description, ...], examples: Mapping[str, Example]
) -> list[Match]:
    """Keep what stands in a relation to the best match of each description in `to`."""
    anchors = []
    for description in to:
        found = [match for match in resolve(scene, description, examples) if match.thing is not None]
        if not found:
            return []
        anchors.append(found)
    rated: list[tuple[float, Match]] = []
    for match in matches:
        assert match.thing is not None
        others = [next((a for a in found if a.thing is not match.thing), None) for found in anchors]
        things = [other.thing for other in others if other is not None and other.thing is not None]
        if len(things) == len(anchors):
            rated.append((relation_score(relation, match.thing, things, scene), match))
    least = _SAME_SURFACE if relation in ("same_colour", "same_pattern") else 0.3
    if relation == "same_shape":
        least = max(least, _NEARLY_AS_ALIKE * max((fit for fit, _ in rated), default=0.0))
    return [
        replace(match, score=match.score * fit, why=f"{match.why}, {relation} {fit:.2f}")
        for fit, match in rated
        if fit > least
    ]


def _spots(scene: Scene, description: Description, examples: Mapping[str, Example]) -> list[Match]:
    """Free table for "an empty area" or "left of …"."""
    anchors: list[tuple[str, list[Thing]]] = []
    for related in description.related:
        things = []
        for to in related.to:
            found = [match.thing for match in resolve(scene, to, examples) if match.thing is not None]
            if not found:
                return []
            things.append(found[0])
        anchors.append((related.relation, things))
    return free_spots(scene, relations=anchors)
