"""Kinds of things by eye: containers, fruit by colour and outline, letters, balls, areas."""

from __future__ import annotations

import numpy as np

from wonderful_team.offline.description import Description
from wonderful_team.offline.vision.things import Look, Scene, Thing

FRUITS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "apple": (("red", "green"), ("round",)), "apricot": (("orange",), ("round",)),
    "avocado": (("green", "olive", "brown"), ("oval",)), "banana": (("yellow",), ("crescent", "long")),
    "blackberry": (("black", "purple"), ("round",)), "blueberry": (("blue", "purple", "black"), ("round",)),
    "cherry": (("red",), ("round",)), "coconut": (("brown",), ("round",)),
    "fig": (("purple", "brown"), ("round", "oval")), "grape": (("purple", "green"), ("round", "oval")),
    "grapefruit": (("orange", "pink", "yellow"), ("round",)),
    "kiwi": (("brown", "green", "olive"), ("oval", "round")), "lemon": (("yellow",), ("oval", "round")),
    "lime": (("green",), ("oval", "round")), "mandarin": (("orange",), ("round",)),
    "mango": (("orange", "yellow", "green", "red"), ("oval",)), "melon": (("green", "yellow"), ("round", "oval")),
    "orange": (("orange",), ("round",)), "peach": (("orange", "pink"), ("round",)),
    "pear": (("green", "yellow", "olive"), ("tapered",)), "plum": (("purple", "blue"), ("round", "oval")),
    "strawberry": (("red",), ("round", "heart", "triangle", "oval")), "tangerine": (("orange",), ("round",)),
    "tomato": (("red",), ("round",)), "watermelon": (("green",), ("round", "oval")),
}  # fmt: skip
"""Everyday looks of fruit: colours and outlines."""


_ROUND, _ANGULAR = ("circle", "ring", "oval", "bowl"), ("square", "rectangle", "frame", "diamond")
_CONTAINERS = {"bowl": (_ROUND, _ANGULAR), "pan": (_ROUND, _ANGULAR), "box": (_ANGULAR, _ROUND), "pallet": (_ANGULAR, _ROUND)}  # fmt: skip
"""Outlines of containers by name, and those that they do not have."""
CLEARLY = 0.2
"""A form that fits better by this much decides."""
FITS_ROUND = 0.6
"""Fit of a circle from which something is round."""
RIVAL_FRUIT = 0.5
"""A fruit that fits at most this share as well as another fruit is that other one: a green round fruit is a lime, no apple."""


def named_score(thing: Thing, description: Description) -> float:
    """How well a particular name fits: a letter, or a fruit; 1 for names that say nothing to the eye."""
    name = description.name
    if description.noun == "letter" and name.upper() in thing.look.letters:
        letters = thing.look.letters
        own, best = letters[name.upper()], max(letters.values())
        return float(np.clip((own - 0.3) / 0.35, 0, 1) * np.clip((own / max(best, 1e-6) - 0.6) / 0.3, 0, 1))
    if name.lower() in FRUITS:
        own = _fruit_fit(thing, name.lower(), named=bool(description.colours))
        if description.colours:
            return own  # "the green apple": the words say which of its colours is meant
        best = max(_fruit_fit(thing, other, named=False) for other in FRUITS)
        return own * float(np.clip((own / max(best, 1e-6) - RIVAL_FRUIT) / (0.85 - RIVAL_FRUIT), 0, 1))
    own_form, other_form = _CONTAINERS.get(name, ((), ()))
    shapes = thing.look.shapes
    if own_form and max(shapes[form] for form in own_form) < max(shapes[form] for form in other_form) - CLEARLY:
        return 0.3
    return 1.0


def _fruit_fit(thing: Thing, name: str, *, named: bool) -> float:
    """How well a fruit's colours and outline fit; its first colour counts most unless the words name one."""
    colours, outlines = FRUITS[name]
    shown = sum(thing.look.memberships[colour] for colour in colours)
    form = max(_form(thing.look, outline) for outline in outlines)
    first = 1.0 if named else thing.look.memberships[colours[0]]
    return float(np.clip(shown / 0.55, 0, 1) * (0.35 + 0.65 * form) * (0.45 + 0.55 * min(1.0, first / 0.5)))


def _form(look: Look, outline: str) -> float:
    """How well a loosely named form fits, 0 to 1."""
    aspect, solidity = look.outline.aspect, look.outline.solidity
    smooth = float(np.clip((solidity - 0.86) / 0.06, 0, 1))
    if outline == "round":
        return smooth * float(np.clip((1.45 - aspect) / 0.25, 0, 1))
    if outline == "oval":
        return smooth * float(np.clip((aspect - 1.05) / 0.12, 0, 1)) * float(np.clip((2.4 - aspect) / 0.4, 0, 1))
    if outline == "tapered":
        ends = np.abs(look.outline.profile - np.roll(look.outline.profile, len(look.outline.profile) // 2))
        return smooth * float(np.clip((ends.max() - 0.12) / 0.12, 0, 1))
    if outline == "long":
        return float(np.clip((aspect - 1.6) / 0.4, 0, 1))
    if outline == "crescent":
        bent = float(np.clip((0.93 - solidity) / 0.08, 0, 1))
        return max(look.shapes["crescent"], bent * float(np.clip((aspect - 1.4) / 0.3, 0, 1)))
    return look.shapes[outline]


def fruit_score(thing: Thing) -> float:
    """How much a thing looks like some fruit: not flat, one main hue, a curved outline without holes, 0 to 1."""
    look = thing.look
    if thing.flat:
        return 0.0
    chroma = max((np.hypot(colour.lab[1], colour.lab[2]) * colour.share for colour in look.colours), default=0.0)
    coloured = float(np.clip(chroma / 14, 0, 1))
    whole = float(np.clip((0.06 - look.outline.hole_share) / 0.03, 0, 1))
    curved = max(_form(look, "round"), _form(look, "oval"), _form(look, "long"), _form(look, "crescent"))
    angular = max(look.shapes[name] for name in ("square", "rectangle", "frame", "cross", "l-shape", "letter"))
    rounded = max(look.shapes[name] for name in ("circle", "oval", "crescent", "long", "heart", "triangle"))
    corners = float(np.clip((angular - rounded + 0.02) / 0.2, 0, 1))
    calm = 1 - 0.6 * max(look.patterns[name] for name in ("striped", "dotted", "checkered"))
    return float(coloured * whole * (0.3 + 0.7 * curved) * (1 - 0.75 * corners) * calm)


def container_score(thing: Thing) -> float:
    """How much a thing looks like something to put things into: large, round or angular outline, 0 to 1."""
    if thing.flat:
        return 0.25
    look = thing.look
    hollow = float(np.clip(look.outline.hole_share / 0.1, 0, 1))
    form = max(look.shapes[name] for name in ("square", "rectangle", "frame", "circle", "ring", "oval"))
    return float(0.45 + 0.55 * max(hollow, 0.8 * form))


ROOMY = 0.45
"""What holds things is at least this share of the largest object of its table."""
GLYPH = 1.3
"""What fits a letter so many times as well as any other shape is a letter and holds nothing."""
BENT = 0.3
"""Fit of a crescent from which a thing is no block."""
SLIM = 6.0
"""A thing so many times as long as wide is a line and no block."""
BLOCKS = 4.0
"""A round object more than so many times the smallest of its table is no block."""


def is_kind_here(thing: Thing, noun: str, scene: Scene) -> bool:
    """Whether a thing is of a kind beside what else is there: next to a bowl, a block of a tenth of its size is no bowl."""
    sizes = [other.area_px for other in scene.objects] or [thing.area_px]
    if noun == "container":
        others = max(fit for name, fit in thing.look.shapes.items() if name != "letter")
        return thing.area_px >= ROOMY * max(sizes) and thing.look.shapes["letter"] <= GLYPH * others
    return noun != "block" or thing.look.shapes["circle"] < FITS_ROUND or thing.area_px <= BLOCKS * min(sizes)


def kind_score(thing: Thing, description: Description) -> float:
    """How well the head noun fits, 0 to 1."""
    look = thing.look
    if description.like is not None and description.noun in ("object", "thing"):
        return 1.0  # the example says what kind it is, such as a line that lies flat
    match description.noun:
        case "area":
            if thing.height_m is not None:
                return 1.0 if thing.flat else 0.15
            if thing.flat:
                return 1.0
            even = look.patterns["plain"] * float(look.outline.solidity > 0.85)
            return (0.45 + 0.45 * even) * (1 - 0.35 * fruit_score(thing))
        case "fruit":
            return fruit_score(thing)
        case "letter":
            own = look.shapes["letter"]
            # A flower or cross resembles some letter too, but itself more.
            return float(
                np.clip(own / 0.55, 0, 1) * np.clip((own / max(max(look.shapes.values()), 1e-6) - 0.6) / 0.3, 0, 1)
            )
        case "ball":
            return float(np.clip(look.shapes["circle"] / 0.6, 0, 1))
        case "container":
            return container_score(thing)
        case "object" | "block" | "toy":
            bent = look.shapes["crescent"] > BENT or look.shapes["oval"] >= max(look.shapes.values())
            bent |= look.outline.aspect > SLIM
            return 0.3 if thing.flat or (bent and description.noun == "block" and not description.shape) else 1.0
        case _:
            return 0.8 if thing.flat else 1.0
