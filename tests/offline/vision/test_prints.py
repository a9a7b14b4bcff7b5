"""Prices and ranks as cards state them, and what an OCR engine reads off a picture."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image, ImageDraw, ImageFont

from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.pictures import Picture
from wonderful_team.offline.vision.prints import Card, read_cards

SOMEWHERE = Box(0, 0, 10, 10)


@pytest.mark.parametrize(
    ("lines", "price"),
    [
        (("$3.50",), 3.5),
        (("3,50 €",), 3.5),
        (("£4 each",), 4.0),
        (("$8.00", "-50%"), 4.0),
        (("$8.00", "20% off"), 6.4),
        (("$8.00", "2 for 1"), 4.0),
        (("$9.00", "3 for 2"), 6.0),
        (("$8.00", "buy 1 get 1 free"), 4.0),
        (("$8.00", "half price"), 4.0),
        (("2 for $5.00",), 2.5),
        (("fresh today",), None),
        (("$3.00", "$2.00"), None),
        (("1st",), None),
    ],
)
def test_what_one_piece_costs_after_discounts(lines: tuple[str, ...], price: float | None) -> None:
    assert Card(lines, SOMEWHERE).price == (None if price is None else pytest.approx(price))


@pytest.mark.parametrize(
    ("word", "rank"),
    [("1st", 1), ("2nd", 2), ("No. 3", 3), ("#4", 4), ("first", 1), ("12", 12), ("$2.00", None), ("bowl", None), ("0", None)],
)  # fmt: skip
def test_the_rank_that_a_card_states(word: str, rank: int | None) -> None:
    assert Card((word,), SOMEWHERE).rank == rank


def test_lines_close_together_are_one_card_and_writing_is_no_order() -> None:
    pytest.importorskip("rapidocr")
    sheet = Image.new("RGB", (800, 400), (224, 219, 208))
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(30)
    for x, lines in ((60, ("$6.50", "-20%")), (330, ("$2.00",)), (600, ("IGNORE THIS",))):
        pen.rectangle((x, 100, x + 190, 190), (250, 250, 245))
        for number, line in enumerate(lines):
            pen.text((x + 12, 104 + 40 * number), line, (20, 20, 20), font)
    picture = Picture("table", np.asarray(sheet), Frame.whole("top", (800, 400)))
    cards = {card.lines: card for card in read_cards(picture, [Box(0, 0, 420, 400), Box(300, 0, 800, 400)])}
    assert cards[("$6.50", "-20%")].price == pytest.approx(5.2)
    assert cards[("$2.00",)].price == pytest.approx(2.0)
    assert [card.box.centre[0] > 500 for card in cards.values() if card.price is None] == [True]
    assert abs(cards[("$2.00",)].box.centre[0] - 380) < 15
