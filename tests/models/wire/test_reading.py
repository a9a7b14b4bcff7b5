"""The JSON in what models say."""

from __future__ import annotations

import pytest

from wonderful_team.models.wire.reading import read_json, read_point_tags

GOOD = '{"found": true, "points": [[1, 2]]}'
KEYS = frozenset({"found", "points"})


@pytest.mark.parametrize(
    ("text", "repaired"),
    [
        (GOOD, None),
        (f"\ufeff {GOOD}\n", None),
        (f"```json\n{GOOD}\n```", "text round the JSON dropped"),
        (f"Sure, here it is:\n```\n{GOOD}\n```\nAnything else?", "text round the JSON dropped"),
        (f"I see a {{mug}} there. {GOOD} Good luck!", "text round the JSON dropped"),
        (f'First {{"maybe": 1}}, no: {GOOD}', "text round the JSON dropped"),
        (f'{GOOD}\n{{"note": "done"}}', "text round the JSON dropped"),
        (f'<think>Is it {{"found": false}}? No.</think>{GOOD}', "thinking before the answer dropped"),
        (f"It could be so.</think>\n{GOOD}", "thinking before the answer dropped"),
        ('"{\\"found\\": true, \\"points\\": [[1, 2]]}"', "double-encoded JSON decoded"),
        (f"[{GOOD}]", "a list round the answer dropped"),
        (f'{{"answer": {GOOD}}}', "the wrapper 'answer' round the answer dropped"),
    ],
)
def test_the_answer_is_found_and_what_was_mended_is_said(text: str, repaired: str | None) -> None:
    reading = read_json(text, KEYS)
    assert reading.value == {"found": True, "points": [[1, 2]]}
    assert (repaired in reading.repairs) if repaired else (reading.repairs == ())


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "empty"),
        ("   ", "empty"),
        ("I cannot see it.", "no JSON"),
        (GOOD[:20], "cut off or malformed"),
        ("[1, 2, 3]", "expected one JSON object, got list"),
        ("null", "expected one JSON object"),
        ('{"x": NaN}', "NaN is not a valid number"),
        ('so: {"x": -Infinity} yes', "Infinity is not a valid number"),
        ("{" * 100_000, "cut off or malformed"),
        ("[" * 100_000, "no JSON"),
    ],
)
def test_what_is_no_answer_is_refused_with_words_for_the_model(text: str, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        read_json(text, KEYS)


@pytest.mark.parametrize(
    ("text", "pairs"),
    [
        ('<point x="12.5" y="30.1" alt="mug">mug</point>', [[12.5, 30.1]]),
        ('<points x1="10" y1="20" x2="30" y2="40" alt="mugs">mugs</points>', [[10, 20], [30, 40]]),
        ('<points coords="1 123 456">mug</points>', [[123, 456]]),
        ('<points coords="1 123 456 2 30 40">mugs</points>', [[123, 456], [30, 40]]),
        ('<points coords="1 1 123 456">mug</points>', [[123, 456]]),
        ("nothing here", []),
    ],
)
def test_molmos_tags_hold_points(text: str, pairs: list[list[float]]) -> None:
    assert read_point_tags(text) == pairs


@pytest.mark.parametrize("before", ["", "<think>Hm.</think>"])
def test_control_characters_in_a_text_are_taken_as_they_are(before: str) -> None:
    """Models write line breaks into texts; vLLM's enforcement of schemas let others through."""
    said = before + '{"reasoning": "one\ntwo\x1f\tthree", "inner": {"found": true}}'
    reading = read_json(said, frozenset({"reasoning", "inner"}))
    assert reading.value == {"reasoning": "one\ntwo\x1f\tthree", "inner": {"found": True}}
    assert reading.repairs[-1] == "control characters in a text taken as they are"


def test_escaped_control_characters_and_line_breaks_between_fields_are_no_repair() -> None:
    assert read_json('{\n\t"reasoning": "one\\ntwo"\n}').repairs == ()
