"""Text for people: counts with their nouns, and characters that nobody could see made visible."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

Text = TypeVar("Text", bound=str)

PLACEHOLDER = re.compile(r"\{(\w+)\}")
"""Where an instruction speaks of one of its pictures."""

_HIDDEN = (
    "\x00-\x1f\x7f-\x9f\u00ad\u034f\u061c\u070f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u200b-\u200f\u2028-\u202e"
    "\u2060-\u206f\u2800\u3164\ud800-\udfff\ufe00-\ufe0f\ufeff\uffa0\ufff0-\ufffb\U00013430-\U0001343f"
    "\U0001bca0-\U0001bca3\U0001d173-\U0001d17a\U000e0000-\U000e0fff"
)
"""Control characters (C0, C1), what changes the direction of writing, what has no width, and lone surrogates."""
_ANY = re.compile(f"[{_HIDDEN}]")
_BUT_LAYOUT = re.compile(f"(?![\n\t])[{_HIDDEN}]")


def counted(number: int, noun: str) -> str:
    """`3 calls`, `1 call`."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


MOST_IN_ORDER = 100
"""The last place in an order that is read."""
_WORDS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")


def _in_digits(number: int) -> str:
    ending = "th" if 10 < number % 100 < 14 else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{ending}"


ORDINALS: Mapping[str, int] = {
    **{word: number for number, word in enumerate(_WORDS, 1)},
    **{_in_digits(number): number for number in range(1, MOST_IN_ORDER + 1)},
}
"""Places in an order by the words for them, in letters and in digits."""


def ordinal(number: int) -> str:
    """`third`, and `13th` from eleven on.

    Args:
        number: From 1 on.
    """
    return _WORDS[number - 1] if number <= len(_WORDS) else _in_digits(number)


def visible(text: Text, *, layout: bool = False) -> Text:
    """The text with every character that hides, moves or reorders what is read written as its escape (ESC: backslash, x1b).

    Words of a model go through this at every way out: terminal, log, tables, pages, notebooks.

    Args:
        text: Any text; markup that is escaped already stays markup.
        layout: Keep line ends and tabs, for text of several lines of our own; else they are escaped too.
    """
    pattern = _BUT_LAYOUT if layout else _ANY
    # Of a long text, its letters are looked through once each.
    if pattern.search("".join(set(text))) is None:
        return text
    return type(text)(pattern.sub(_escape, str(text)))


def visible_json(text: str) -> str:
    """A JSON document with the same characters escaped as JSON does it: it reads back as the same values."""
    return _BUT_LAYOUT.sub(_json_escape, text)


def _escape(found: re.Match[str]) -> str:
    short = {"\n": "\\n", "\t": "\\t", "\r": "\\r"}.get(found[0])
    code = ord(found[0])
    return short or (f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}")


def _json_escape(found: re.Match[str]) -> str:
    code = ord(found[0])
    if code < 0x10000:
        return f"\\u{code:04x}"
    return f"\\u{0xD800 + ((code - 0x10000) >> 10):04x}\\u{0xDC00 + ((code - 0x10000) & 0x3FF):04x}"


def picture_names(instruction: str, pictures: Iterable[str]) -> dict[str, str]:
    """What people call an instruction's pictures: "picture 1", "picture 2", in the order in which the words name them."""
    held = list(pictures)
    named = [name for name in dict.fromkeys(PLACEHOLDER.findall(instruction)) if name in held]
    return {name: f"picture {number}" for number, name in enumerate(dict.fromkeys([*named, *held]), start=1)}


def recorded_names(instruction: Mapping[str, Any] | None) -> dict[str, str]:
    """The same for an instruction as a record holds it; empty without one."""
    return {} if instruction is None else picture_names(instruction["text"], instruction["slots"])


def spoken(text: str, names: Mapping[str, str]) -> str:
    """The text with every `{name}` that stands for a picture replaced by what people call it: "[picture 1]"."""
    return PLACEHOLDER.sub(lambda found: f"[{names[found[1]]}]" if found[1] in names else found[0], text)


def ending_words(ending: str, reason: str | None) -> tuple[str, str]:
    """How something ended and why, as every terminal, log and page says it; the reason does not say the ending again."""
    words = ending.replace("_", " ")
    return words, (reason or "").removeprefix(f"{words}: ")


def user_path(path: str | Path) -> Path:
    """A path as a user writes it: ~ is a home folder where there is one of that name.

    On another machine that works for the user, it is the copy that was sent along, where there is one.
    """
    if _copies is None:
        return Path(os.path.expanduser(path))
    folder, home = _copies
    text = os.fspath(path)
    found = Path(home + text[1:] if text == "~" or text.startswith("~/") else os.path.expanduser(text)).absolute()
    copy = folder / found.relative_to(found.anchor)
    return copy if copy.exists() else found


_copies: tuple[Path, str] | None = None


def look_in_copies(folder: Path, home: str) -> None:
    """From now on this process finds a user's files in copies of them, which lie below `folder` as they do below the root.

    Args:
        folder: Absolute.
        home: The user's home folder on the machine that they were copied from.
    """
    global _copies
    _copies = folder, home
