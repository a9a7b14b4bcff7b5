"""The textures by name: a table of tiles. Nothing outside the simulator may import this."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.errors import UnknownNameError
from wonderful_team.sims.tabletop import patterns, prints, table_patterns
from wonderful_team.sims.tabletop.patterns import SIDE_PX, TILE_M, Colour, mixed

__all__ = ["PAPER_SHADES", "SIDE_PX", "TILE_M", "texture", "texture_names"]

PLAIN: dict[str, Colour] = {
    "blue": (58, 110, 196),
    "red": (216, 48, 48),
    "green": (66, 164, 72),
    "orange": (242, 142, 43),
    "yellow": (238, 202, 50),
    "purple": (140, 76, 168),
    "pink": (244, 154, 190),
    "cyan": (92, 200, 214),
    "olive": (128, 130, 42),
}
DARK = {f"dark {name}": mixed(rgb, (0, 0, 0), 0.48) for name, rgb in PLAIN.items() if name != "olive"}
SKINS: dict[str, Colour] = {
    "apple": (196, 34, 40),
    "lime": (92, 160, 44),
    "orange": (240, 132, 24),
    "banana": (240, 208, 60),
    "plum": (112, 50, 128),
    "blueberry": (52, 74, 150),
}
GREY = "grey"
"""Of things in pictures that show a shape alone."""
TABLE_COVERS = ("planks table", "gingham table", "terrazzo table")
"""What covers the table in harder scenes, tier after tier."""
PAPER_SHADES = {
    "paper": ((235, 235, 235), 0.2),
    "pale paper": ((250, 250, 250), 0.4),
    "deep paper": ((30, 30, 30), 0.12),
}
"""What a paper's colour is mixed with, and how much."""
PAIRED = ("red", "yellow", "green", "blue", "purple")
PAIRS = tuple((PAIRED[i], PAIRED[j]) for i in range(5) for j in range(i + 1, 5))


def _makers() -> dict[str, Callable[[], Array]]:
    colours = {**PLAIN, **DARK}
    made: dict[str, Callable[[], Array]] = {name: partial(patterns.plain, rgb) for name, rgb in colours.items()}
    for shade in ("", "dark "):
        for first, second in PAIRS:
            pair = colours[shade + first], colours[shade + second]
            made[f"{shade}{first} and {second} stripe"] = partial(patterns.stripe, *pair)
            made[f"{shade}{first} and {second} polka dot"] = partial(patterns.dots, *pair)
        for name in PAIRED:
            made[f"{shade}{name} swirl"] = partial(patterns.swirl, colours[shade + name])
    made |= {f"{name} paisley": partial(patterns.paisley, colours[name]) for name in PAIRED}
    made |= {
        "brick": patterns.brick,
        "tiles": patterns.tiles,
        "wooden": patterns.wooden,
        "granite": patterns.granite,
        "plastic": patterns.plastic,
        "polka dot": partial(patterns.dots, (246, 246, 242), (42, 44, 52)),
        "checkerboard": patterns.checkerboard,
        "tiger": patterns.tiger,
        "magma": patterns.magma,
        "rainbow": patterns.rainbow,
    }
    return made


def _special() -> dict[str, Callable[[], Array]]:
    """Skins of fruits, colours of papers, covers of tables and the grey of examples; not offered for other things."""
    made: dict[str, Callable[[], Array]] = {f"{f} skin": partial(patterns.skin, f, rgb) for f, rgb in SKINS.items()}
    made[GREY] = partial(patterns.plain, (150, 150, 150))
    made |= dict(
        zip(TABLE_COVERS, (table_patterns.planks, table_patterns.gingham, table_patterns.terrazzo), strict=True)
    )
    for kind, (other, share) in PAPER_SHADES.items():
        made |= {f"{name} {kind}": partial(patterns.plain, mixed(rgb, other, share)) for name, rgb in PLAIN.items()}
    return made


_GENERAL = _makers()
_ALL = _GENERAL | _special()


def texture_names(*, dark: bool = False) -> tuple[str, ...]:
    """All names but those of fruits and papers, without the dark ones unless asked for."""
    return tuple(name for name in _GENERAL if dark or not name.startswith("dark "))


@cache
def texture(name: str) -> Array:
    """A seamless tile, or what is printed on a card, shape (SIDE_PX, SIDE_PX, 3), uint8.

    Raises:
        UnknownNameError: No such texture; lists the known ones.
    """
    if name not in _ALL and not name.startswith(prints.PREFIX):
        raise UnknownNameError("texture", name, _ALL)
    drawn = _ALL[name]() if name in _ALL else prints.printed(name)
    tile = np.clip(np.rint(drawn), 0, 255).astype(np.uint8)
    tile.setflags(write=False)
    return tile
