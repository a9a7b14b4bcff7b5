"""Kinds of things by eye: containers, fruit by colour and outline, letters, balls, areas, bottles and what is on them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from wonderful_team.offline.description import Description
from wonderful_team.offline.vision.things import Look, Scene, Thing

FRUITS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "banana": (("yellow",), ("crescent", "long")), "apple": (("red", "green"), ("round",)),
    "orange": (("orange",), ("round",)), "lemon": (("yellow",), ("oval", "round")),
    "lime": (("green",), ("oval", "round")), "plum": (("purple", "blue"), ("round", "oval")),
    "strawberry": (("red",), ("heart", "triangle", "round", "oval")), "pear": (("green", "yellow", "olive"), ("tapered",)),
    "blueberry": (("blue", "purple", "black"), ("round",)), "peach": (("orange", "pink"), ("round",)),
    "tomato": (("red",), ("round",)), "cherry": (("red",), ("round",)), "grape": (("purple", "green"), ("round", "oval")),
    "kiwi": (("brown", "green", "olive"), ("oval", "round")), "avocado": (("green", "olive", "brown"), ("oval",)),
    "mango": (("orange", "yellow", "green", "red"), ("oval",)), "coconut": (("brown",), ("round",)),
    "mandarin": (("orange",), ("round",)), "tangerine": (("orange",), ("round",)), "apricot": (("orange",), ("round",)),
    "grapefruit": (("orange", "pink", "yellow"), ("round",)), "melon": (("green", "yellow"), ("round", "oval")),
    "watermelon": (("green",), ("round", "oval")), "fig": (("purple", "brown"), ("round", "oval")),
    "blackberry": (("black", "purple"), ("round",)),
}  # fmt: skip
"""Everyday looks of fruit, the commonest on a table first: colours and outlines."""
_AS_WELL = 0.95
"""A fruit is another, commoner one that fits at least this share as well: a red round one is an apple, no tomato."""

_ROUND, _ANGULAR = ("circle", "ring", "bowl"), ("square", "rectangle", "frame")
_OUTLINES = {
    "bowl": _ROUND, "plate": _ROUND, "dish": (*_ROUND, "oval"), "pan": ("pan",), "box": _ANGULAR, "tray": _ANGULAR,
    "pallet": _ANGULAR,
}  # fmt: skip
"""Outlines of containers by name."""
_HOLDS = (*_ROUND, *_ANGULAR, "oval", "pan")
"""Outlines of what things are put into."""
_FRUITY = ("circle", "oval", "long", "crescent")
"""Outlines of fruit."""


def unrivalled(own: float, rivals: Iterable[float]) -> float:
    """How far a word fits beside all others of its family, 0 to 1: what another one names clearly better is that other."""
    return float(np.clip((own / max(*rivals, 1e-6) - 0.75) / 0.15, 0, 1))


def formed(look: Look, outlines: Iterable[str]) -> float:
    """How far one of these is a thing's outline beside all others, 0 to 1."""
    return unrivalled(max(look.shapes[name] for name in outlines), look.shapes.values())


def named_score(thing: Thing, description: Description) -> float:
    """How well a particular name fits: a letter, a fruit or a container; 1 for names that say nothing to the eye."""
    name, letters = description.name, thing.look.letters
    if description.noun == "letter" and name.upper() in letters:
        own = letters[name.upper()]
        return float(np.clip((own - 0.3) / 0.35, 0, 1)) * unrivalled(own, letters.values())
    if name.lower() in FRUITS:
        own = _fruit_fit(thing, name.lower(), named=bool(description.colours))
        fits = {other: _fruit_fit(thing, other, named=False) for other in FRUITS if other != name.lower()}
        commoner = [fits[other] for other in list(FRUITS)[: list(FRUITS).index(name.lower())]]
        return own * unrivalled(own, fits.values()) * float(max(commoner, default=0.0) < _AS_WELL * own)
    return formed(thing.look, _OUTLINES[name]) if name in _OUTLINES else 1.0


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
    calm = 1 - 0.6 * max(look.patterns[name] for name in ("striped", "dotted", "checkered"))
    return float(coloured * whole * formed(look, _FRUITY) * calm)


def container_score(thing: Thing, *, thin: bool = False) -> float:
    """How much a thing looks like something to put things into: a round or angular outline, 0 to 1; `thin`: it may be as flat as a plate."""
    flat = thing.flat and not (thin and (thing.height_m or 0.0) >= THIN_M)
    return 0.25 if flat else formed(thing.look, _HOLDS)


ROOMY = 0.45
"""What holds things is at least this share of the largest object of its table."""
SLIM = 6.0
"""A thing so many times as long as wide is a line and no block."""
SOLID = 0.85
"""A long block fills at least this share of the rectangle round it."""
BLOCKS = 3.0
"""A round object more than so many times the smallest of its table is no block, ball or fruit."""
FITS_ROUND = 0.6
"""Fit of a circle from which something is round."""


ROUND_ASPECT, STANDS_M, THIN_M = 1.6, 0.05, 0.003
"""A bottle, seen from above and a little aslant, is at most so many times as long as wide, and at least so high; what is flat and
yet higher than the last is a plate or tray and no paper [m]."""


def is_round(thing: Thing) -> bool:
    """Whether a thing's outer outline is round, as of what stands upright and is seen from above, a little aslant."""
    outline = thing.look.outline
    return outline.aspect < ROUND_ASPECT and outline.solidity > SOLID and max(
        thing.look.shapes[name] for name in ("circle", "ring", "oval", "bowl")
    ) > max(thing.look.shapes[name] for name in ("square", "rectangle", "frame"))  # fmt: skip


def part_on(thing: Thing, scene: Scene) -> Thing | None:
    """What stands up from the middle of a thing: its neck, cap, or handle, the highest one; None without depth or where nothing does."""
    middle = thing.box.scaled(0.8)
    parts = [part for part in scene.on(thing) if _higher(part, thing) and middle.contains(part.box.centre)]
    return max(parts, key=lambda part: part.height_m or 0.0, default=None)


def _higher(part: Thing, thing: Thing) -> bool:
    return part.height_m is not None and thing.height_m is not None and part.height_m > thing.height_m + HIGHER_M


LOW_M, SAME_COLOUR = 0.02, 0.5
"""What lies on the table no higher than this may be a lid without its box [m]; from which share of colour in common a part is one with it."""
HIGHER_M = 0.01
"""What stands up from a thing is at least so much higher [m]."""


def _is_part(thing: Thing, scene: Scene) -> bool:
    """Whether a round thing stands on the middle of another round one: a neck or a cap."""
    host = next((other for other in scene.things if other.number == thing.on), None)
    return host is not None and is_round(host) and not host.flat and _higher(thing, host)


def _is_bottom(thing: Thing, scene: Scene) -> bool:
    """Whether a thing is the inner part of a plate: level with what it lies on, which is flat and yet no paper."""
    host = next((other for other in scene.things if other.number == thing.on), None)
    if host is None or not host.flat or host.height_m is None or host.height_m < THIN_M:
        return False
    return thing.height_m is not None and thing.height_m < host.height_m + THIN_M


def _is_lid(thing: Thing, scene: Scene) -> bool:
    """Whether a thing has a handle on its middle, which has none itself, and lies on another or is not round, as a bottle is."""
    part = part_on(thing, scene)
    return part is not None and part_on(part, scene) is None and (thing.on is not None or not is_round(thing))


def _lies_aside(thing: Thing, scene: Scene) -> bool:
    """Whether a thing is a lid that was put down on the table: low, and its handle of its own colour, as no tray's load is."""
    part = part_on(thing, scene)
    if part is None or is_round(thing) or (thing.height_m or 0.0) > LOW_M:
        return False
    one, other = thing.look.memberships, part.look.memberships
    return sum(min(one[name], other[name]) for name in one.keys() & other.keys()) > SAME_COLOUR


def is_kind_here(thing: Thing, noun: str, scene: Scene) -> bool:
    """Whether a thing is of a kind beside what else is there: next to a bowl, a block of a tenth of its size is no bowl."""
    if noun in ("bottle", "cap"):
        return _is_part(thing, scene) == (noun == "cap")
    if noun == "lid":
        return _is_lid(thing, scene)
    if noun == "container" and thing.on is not None and (_is_lid(thing, scene) or _is_bottom(thing, scene)):
        return False
    if noun == "container" and _lies_aside(thing, scene):
        return False
    sizes = [other.area_px for other in (scene.things if noun == "container" else scene.objects)] or [thing.area_px]
    if noun == "container":
        return thing.area_px >= ROOMY * max(sizes)
    return (
        noun not in ("block", "ball", "fruit")
        or thing.look.shapes["circle"] < FITS_ROUND
        or thing.area_px <= BLOCKS * min(sizes)
    )


def _stands_score(thing: Thing, noun: str) -> float:
    """How well a bottle, a cap, a lid or a tool fits by its outline and height: by elimination, nothing of it says what it is for, 0 to 1."""
    if noun == "tool" or thing.flat:
        return 0.0  # no picture tells a pen from a stick
    low = noun == "bottle" and (thing.height_m or STANDS_M) < STANDS_M
    return float(noun == "lid" or is_round(thing)) * (0.3 if low else 1.0)


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
            # A flower or cross resembles some letter too, but itself more.
            return float(np.clip(look.shapes["letter"] / 0.55, 0, 1)) * formed(look, ("letter",))
        case "ball":
            return float(np.clip(look.shapes["circle"] / FITS_ROUND, 0, 1)) * formed(look, ("circle",))
        case "container":
            return container_score(thing, thin=description.name in ("plate", "dish", "tray"))
        case "bottle" | "cap" | "lid" | "tool":
            return _stands_score(thing, description.noun)
        case "block" if not (thing.flat or description.shape):
            bar = look.outline.aspect <= SLIM and look.outline.fill > SOLID
            return formed(look, ("square", "rectangle", "l-shape", *(("long",) if bar else ())))
        case "object" | "block" | "toy":
            return 0.3 if thing.flat else 1.0
        case _:
            return 0.8 if thing.flat else 1.0
