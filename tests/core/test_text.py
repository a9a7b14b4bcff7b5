"""Counts, and characters that hide: what a person reads is what is there."""

from __future__ import annotations

import json
import sys
import unicodedata

from wonderful_team.core.text import (
    MOST_IN_ORDER,
    ORDINALS,
    counted,
    ordinal,
    picture_names,
    spoken,
    visible,
    visible_json,
)

SEEN_ANYWAY = set(map(chr, (*range(0x600, 0x606), 0x6DD, 0x890, 0x891, 0x8E2, 0x110BD, 0x110CD)))
"""Format characters that are drawn: signs of numbers and verses in Arabic and Kaithi."""


def test_every_control_format_and_surrogate_character_becomes_its_escape() -> None:
    hiding = [
        chr(code)
        for code in range(sys.maxunicode + 1)
        if unicodedata.category(chr(code)) in ("Cc", "Cf", "Cs", "Zl", "Zp") and chr(code) not in SEEN_ANYWAY
    ]
    assert len(hiding) > 2000
    assert [sign for sign in hiding if sign in visible(sign)] == []
    assert visible("\x1b[2J\u202egnp.exe\u200b") == "\\x1b[2J\\u202egnp.exe\\u200b"


def test_visible_text_and_our_own_line_ends_stay() -> None:
    words = "Käse, 杯子, кружка, كوب, 🍌: 5 °C → “ok”"
    assert visible(words) == words
    assert visible("one\n\ttwo", layout=True) == "one\n\ttwo"
    assert visible("one\nPLAN two") == "one\\nPLAN two"


def test_a_json_document_reads_back_as_the_same_values() -> None:
    value = {"words": "a\x9bb\u202ec\U000e0041d\u2028", "lines": "x\ny"}
    text = visible_json(json.dumps(value, indent=2, ensure_ascii=False))
    assert json.loads(text) == value
    assert visible(text, layout=True) == text


def test_counts_agree_with_their_nouns() -> None:
    assert [counted(number, "action") for number in (0, 1, 2, 1200)] == [
        "0 actions",
        "1 action",
        "2 actions",
        "1,200 actions",
    ]


def test_pictures_are_called_by_number_in_the_order_of_the_words() -> None:
    names = picture_names("Put {dragged_obj_1} on {base} like {dragged_obj_1}.", ["base", "dragged_obj_1", "unsaid"])
    assert names == {"dragged_obj_1": "picture 1", "base": "picture 2", "unsaid": "picture 3"}
    assert spoken("the thing of {base}, not {other}", names) == "the thing of [picture 2], not {other}"


def test_places_in_an_order_are_read_as_they_are_written() -> None:
    assert [ordinal(number) for number in (1, 10, 11, 13, 21, 22, 23, 100, 111)] == [
        "first", "tenth", "11th", "13th", "21st", "22nd", "23rd", "100th", "111th"
    ]  # fmt: skip
    assert all(ORDINALS[ordinal(number)] == number for number in range(1, MOST_IN_ORDER + 1))
    assert ORDINALS["1st"] == ORDINALS["first"]
