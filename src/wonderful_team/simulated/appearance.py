"""How well words fit a thing: names of covers and shapes, other words for them, and the colours that really show."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from wonderful_team.core.text import ORDINALS
from wonderful_team.core.values import TrueThing
from wonderful_team.images.colours import COLOURS, memberships, to_lab
from wonderful_team.simulated.seeing import Seen

SAME: tuple[tuple[str, ...], ...] = (
    ("stripe", "striped", "stripes", "stripy", "lined"),
    ("dot", "dotted", "dots", "spotted", "spots", "polka", "speckled"),
    ("swirl", "swirled", "swirls", "swirly", "spiral"),
    ("paisley", "mottled"),
    ("checkerboard", "checkered", "chequered", "checked"),
    ("round", "circle", "circular", "disc", "disk"),
    ("ring", "doughnut", "donut"),
    ("diamond", "rhombus"),
    ("triangle", "triangular"),
    ("pentagon", "pentagonal"),
    ("hexagon", "hexagonal"),
    ("line", "bar", "strip"),
    ("paper", "sheet", "mat"),
    ("rectangle", "rectangular", "three-sided"),
    ("purple", "violet"),
    ("cyan", "turquoise", "teal"),
    ("grey", "gray"),
    ("wooden", "wood"),
    ("l-shaped", "l"),
)
"""Words that mean the same; the first of each is the one that is compared."""
ONE = {word: group[0] for group in SAME for word in group}
ALSO: Mapping[str, tuple[str, ...]] = {
    "block": ("cube", "square"),
    "shorter block": ("square", "cube"),
    "small block": ("cube", "square"),
    "pan": ("frypan", "container"),
    "bowl": ("dish", "container"),
    "frame": ("container", "square"),
    "square": ("container", "tray"),
    "container": ("box", "square", "bin"),
    "pallet": ("container", "tray", "square"),
    "three-sided rectangle": ("frame", "container", "rectangle"),
    "paper": ("square", "area"),
}
"""What else a shape is called."""
GENERAL = frozenset(
    "object objects thing things item items piece one the a an of in at to with from left right and shown picture "
    "it that which is area place letter free for shape patterned coloured colored leftmost rightmost lightest lighter darkest darker tallest taller highest shortest lowest "
    "largest biggest larger smallest smaller".split()
).union(ORDINALS)
"""Words that fit everything, or choose among what fits."""
LEAST_SHARE = 0.25
"""A colour is plain on a thing when it covers at least this much of it."""
TRACE = 0.06
"""Less than this of a colour does not show."""
SURPLUS = 0.25
"""What a thing's own word that was not said costs."""
SHARE_COUNTS = 0.2
"""What a colour counts more on a thing that shows much of it."""
MEASURED = 0.8
"""What a colour that only shows, and is not in the cover's name, counts."""


def tokens(text: str) -> list[str]:
    """The telling words of a text, each in its one form."""
    said = re.findall(r"[a-z][a-z\-]*", re.sub(r"\{[^}]*\}", " ", text.lower()))
    return [ONE.get(word, word) for word in said if word not in GENERAL]


def known(words: list[str], name: str, thing: TrueThing, seen: Seen) -> int:
    """How many of the words fit a thing."""
    return sum(fit([word], name, thing, seen) > 0.0 for word in words)


def fit(words: list[str], name: str, thing: TrueThing, seen: Seen) -> float:
    """How well words fit a thing: one for each that does, minus one for each that does not, less for what was not said."""
    cover, shape = set(tokens(thing.cover)), set(tokens(thing.shape))
    also = {ONE.get(word, word) for word in ALSO.get(thing.shape, ())}
    shows = colours(name, seen)
    total = 0.0
    for word in words:
        total += SHARE_COUNTS * shows.get(word, 0.0)
        if word in cover or word in shape or (word == "container" and thing.kind == "container"):
            total += 1.0
        elif word in also:
            total += 0.9
        elif word in COLOURS:
            share = shows.get(word, 0.0)
            total += MEASURED * min(1.0, share / LEAST_SHARE) if share >= TRACE else -1.0
        else:
            total -= 0.5
    if words:
        told = set(words)
        own = cover - told if cover & told else set()
        total -= SURPLUS * len(own)
    return total


def colours(name: str, seen: Seen) -> Mapping[str, float]:
    """Which share of what shows of a thing has which colour."""
    mask = seen.sight.masks.get(name)
    if mask is None or not mask.any():
        return {}
    pixels = seen.sight.view.rgb[mask]
    shares = memberships(to_lab(pixels[None]))[0].mean(axis=0)
    return {colour: float(share) for colour, share in zip(COLOURS, shares, strict=True)}


def lightness(name: str, seen: Seen) -> float:
    """Mean lightness of what shows of a thing, 0 to 100."""
    mask = seen.sight.masks.get(name)
    if mask is None or not mask.any():
        return 0.0
    return float(np.mean(to_lab(seen.sight.view.rgb[mask][None])[..., 0]))
