"""Values, texts and files as nobody should write them: what the tests of bad input draw from."""

from __future__ import annotations

import copy
import json
from typing import Any

from hypothesis import strategies as st

HUGE, DEEP = "@HUGE@", "@DEEP@"
"""Stand for a number of 5,000 digits and for lists 100,000 deep, which no Python value can be written as."""

WRONG: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 2, 0.5, -1e308, 1e308, 1e-308, float("nan"), float("inf"), 10**400, 2**63, HUGE, DEEP,
    "", " ", "x", "1", "nan", "\ud800", "a\u202eb\x1b[2J\x07", "x" * 10_000, "../x.py:W", "/etc/passwd", "a/../../b", "{x}",
    [], {}, [[]], [None], {"x": 1}, [1, 2, 3], [1e308] * 4, ["x", "x"],
)  # fmt: skip

WRONG_TEXTS = [one for one in WRONG if isinstance(one, str) and one not in (HUGE, DEEP) and "\ud800" not in one]
LETTERS = st.sampled_from(
    [*"0123456789.,:;=x/@#?&-+ {}[]()\"'%*~\n", "\u202e", "é", "1e308", "-", "nan", "inf", "px", "10000"]
)


def _wrong() -> st.SearchStrategy[Any]:
    """One of the wrong values, a copy: it may be damaged further, and would otherwise come to hold itself."""
    return st.sampled_from(WRONG).map(copy.deepcopy)


def _places(value: Any) -> list[tuple[Any, Any]]:
    """Every (container, key) inside a JSON value."""
    places: list[tuple[Any, Any]] = []
    waiting = [value]
    while waiting:
        one = waiting.pop()
        keys = list(one) if isinstance(one, dict) else range(len(one)) if isinstance(one, list) else []
        places += [(one, key) for key in keys]
        waiting += [one[key] for key in keys]
    return places


@st.composite
def damaged_json(draw: st.DrawFn, text: str) -> bytes:
    """A JSON file in which something is wrong, or now and then nothing: what is read must be reached too."""
    held = [json.loads(text)]
    for _ in range(draw(st.sampled_from([0, 1, 1, 1, 2, 3]))):
        places = _places(held)
        # Places near the root are few and matter most: take them as often as all others.
        chosen = places if draw(st.booleans()) else places[: 1 + len(places) // 20]
        home, key = draw(st.sampled_from(chosen)) if chosen else (held, 0)
        match draw(st.sampled_from(["replace", "replace", "replace", "remove", "add", "move"])):
            case "replace":
                home[key] = draw(_wrong())
            case "remove" if home is not held:
                del home[key]
            case "add":
                if isinstance(home, dict):
                    home[draw(st.sampled_from(WRONG_TEXTS))] = draw(_wrong())
                else:
                    home.append(draw(_wrong()))
            case _:
                other, other_key = draw(st.sampled_from(places))
                home[key] = json.loads(json.dumps(other[other_key]))
    words = json.dumps(held[0]).replace(f'"{HUGE}"', "9" * 5_000).replace(f'"{DEEP}"', "[" * 100_000 + "]" * 100_000)
    written = words.encode()
    return draw(damaged_bytes(written)) if draw(st.integers(0, 9)) == 0 else written


@st.composite
def damaged_bytes(draw: st.DrawFn, good: bytes) -> bytes:
    """A file of which some bytes are changed, missing or too many."""
    held = bytearray(good)
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.integers(0, min(len(held), 200))) if draw(st.booleans()) else draw(st.integers(0, len(held)))
        match draw(st.sampled_from(["change", "change", "cut", "insert", "remove", "zero", "empty"])):
            case "change" if place < len(held):
                held[place] = draw(st.integers(0, 255))
            case "cut":
                del held[place:]
            case "insert":
                held[place:place] = draw(st.binary(min_size=1, max_size=8))
            case "remove":
                del held[place : place + draw(st.integers(1, 64))]
            case "zero":
                width = draw(st.integers(1, 64))
                held[place : place + width] = bytes(min(width, max(0, len(held) - place)))
            case "empty" if draw(st.integers(0, 9)) == 0:
                held.clear()
    return bytes(held)


@st.composite
def damaged_text(draw: st.DrawFn, *good: str) -> str:
    """The value of an option or an argument in which something is wrong."""
    if draw(st.integers(0, 4)) == 0:
        return draw(st.sampled_from(WRONG_TEXTS))
    if draw(st.integers(0, 9)) == 0:
        # No argument of a program holds a NUL.
        return draw(st.text(st.characters(blacklist_categories=["Cs"], blacklist_characters="\0"), max_size=20))
    held = list(draw(st.sampled_from(good)))
    for _ in range(draw(st.sampled_from([0, 1, 1, 1, 2, 3]))):
        place = draw(st.integers(0, len(held)))
        if draw(st.booleans()):
            held[place : place + draw(st.integers(0, 3))] = [draw(LETTERS)]
        else:
            del held[place : place + draw(st.integers(1, 3))]
    return "".join(held)


@st.composite
def lying_array(draw: st.DrawFn) -> bytes:
    """An .npy file whose header need not fit what follows."""
    shape = draw(
        st.sampled_from(
            ["(240, 320)", "(240, 320, 1)", "(3,)", "()", "(-1, 5)", "(10**9, 10**9)", "(99999999, 99999999)"]
        )
    )
    kind = draw(st.sampled_from(["<f4", "<f8", "|O", "<U5", "<c16", "|V8", "<M8[ns]", "x", "|b1", "<i2"]))
    header = (
        f"{{'descr': '{kind}', 'fortran_order': {draw(st.sampled_from(['False', 'True', '3']))}, 'shape': {shape}, }}"
    )
    size = draw(st.sampled_from([len(header) + 1, 0, 65_535]))
    version = draw(st.sampled_from([b"\x01\x00", b"\x02\x00", b"\x09\x09"]))
    body = bytes(draw(st.sampled_from([240 * 320 * 4, 240 * 320 * 8, 0, 13])))
    return b"\x93NUMPY" + version + size.to_bytes(2, "little") + header.encode() + b"\n" + body
