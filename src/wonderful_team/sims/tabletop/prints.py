"""Cards with something printed on them: price tags and labels, as a tile that shows on a card exactly once."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop.patterns import SIDE_PX, Colour

PREFIX = "card: "
"""Begins the name of a texture that is printed; its lines follow, with " / " between them."""
BACK: Colour = (250, 249, 244)
INKS: tuple[Colour, ...] = ((24, 24, 28), (196, 24, 32))
"""Of the first line and of those below."""
MARGIN_PX = 6
MOST_PX = {1: 46, 2: 38}
"""The largest letters by the number of lines [px of the tile]."""


def card_texture(*lines: str) -> str:
    """The name of the texture of a card with these lines."""
    return PREFIX + " / ".join(lines)


def printed(name: str) -> Array:
    """The tile of a printed texture, shape (SIDE_PX, SIDE_PX, 3), floats 0 to 255.

    Raises:
        ValueError: It has no line, or more than two.
    """
    lines = [line for line in name.removeprefix(PREFIX).split(" / ") if line.strip()]
    if not 1 <= len(lines) <= max(MOST_PX):
        raise ValueError(f"a card holds one or two lines, got {len(lines)} in {name!r}")
    tile = Image.new("RGB", (SIDE_PX, SIDE_PX), BACK)
    pen = ImageDraw.Draw(tile)
    fonts = [_fitting(line, MOST_PX[len(lines)]) for line in lines]
    step = MOST_PX[len(lines)]
    first = SIDE_PX / 2 - step * (len(lines) - 1) / 2
    for number, (line, font) in enumerate(zip(lines, fonts, strict=True)):
        pen.text((SIDE_PX / 2, first + number * step), line, INKS[min(number, 1)], font, anchor="mm")
    # The first row of a tile lies at the lower edge of a thing.
    return np.asarray(tile, dtype=np.float64)[::-1]


def _fitting(line: str, most_px: int) -> ImageFont.FreeTypeFont:
    """The largest font with which a line fits into the tile."""
    for size in range(most_px, 8, -1):
        font = ImageFont.load_default(size)
        assert isinstance(font, ImageFont.FreeTypeFont)
        if font.getlength(line) <= SIDE_PX - 2 * MARGIN_PX:
            return font
    raise ValueError(f"{line!r} is too long for a card")
