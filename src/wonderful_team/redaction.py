"""No key leaves this process: the one place that knows every secret in use, and takes them out of text.

A key is registered where it is read (`keep_secret`); what the environment holds under a secret's name is known without that.
Whatever is written, printed, stored or raised passes through `redact`.
"""

from __future__ import annotations

import base64
import contextlib
import functools
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, TextIO, cast

HIDDEN = "[redacted]"
SHORTEST = 6
"""Shortest key that can be told from ordinary words [characters]; servers without keys are given "none" or "EMPTY"."""
SHORTEST_UNUSED = 8
"""The same for a variable of the environment that nothing has used as a key."""
_LOOKS = (
    (re.compile(r"\b(?:sk|pk|rk)-[A-Za-z0-9_\-]{8,}"), ("sk-", "pk-", "rk-")),
    (re.compile(r"\bAIza[0-9A-Za-z_\-]{10,}"), ("AIza",)),
    (
        re.compile(r"\b(?:gh[pousr]_|github_pat_|hf_|xox[baprs]-|gsk_|xai-|AKIA)[A-Za-z0-9_\-]{10,}"),
        ("gh", "github_pat_", "hf_", "xox", "gsk_", "xai-", "AKIA"),
    ),
    (re.compile(r"\beyJ[A-Za-z0-9_\-]{8,}\.[A-Za-z0-9_\-]{8,}\.[A-Za-z0-9_\-]*"), ("eyJ",)),
)
"""What keys look like, each with words of which any match begins with one: to look for these takes a tenth of the time."""
_AFTER_NAME = re.compile(
    r"""(?ix)
    (\b(?:bearer|basic)\s+                                                       # an Authorization header
    |(?:\b|_)(?:x-)?(?:api[_-]?key|access[_-]?token|auth[_-]?token|client[_-]?secret|password)\\?["']?\s*[:=]\s*\\?["']?  # name: value
    |[?&](?:key|token|api_key)=                                                  # part of an address
    |://[^/\s:@"']+:(?=[^/\s@"']+@))                                             # user:password@host
    ([A-Za-z0-9_\-./+~%]{6,}=*)
    """
)
_NAMES = ("bearer", "basic", "key", "token", "secret", "password", "://")
"""Any match of `_AFTER_NAME` holds one of these, in any case, at most so many characters after it begins:"""
_BEFORE_NAME = len("_x-client_")
_ODD = re.compile("[\u0130\u0131\u017f\u212a]")
"""The only letters outside of ASCII that are i, s or k when case does not count."""
_EMBEDDED = re.compile(r"(;base64,[A-Za-z0-9+/=]+)")
"""A picture inside of a page: pixels may look like anything."""
_SECRET_VARIABLE = re.compile(r"(?i)(key|token|secret|password|passwd|passphrase|credentials?)(_?\d+)?$")
_ESCAPES = re.compile(r"[\\%&]")
_NAMED = {'"': "quot", "&": "amp", "<": "lt", ">": "gt", "'": "apos"}
_used: set[str] = set()


def keep_secret(value: str | None) -> None:
    """Take a key out of everything that leaves this process from now on."""
    if value is not None and len(value.strip()) >= SHORTEST:
        _used.add(value.strip())


def names_secret(variable: str) -> bool:
    """Whether a variable's name says that its value is secret."""
    return _SECRET_VARIABLE.search(variable) is not None


def redact(text: str) -> str:
    """The text without any known secret, in whichever coding, and without anything that looks like a key."""
    return _redact_looks(_known().hide(text))


def redact_known(text: str) -> str:
    """The text without any secret that is known: plain, as JSON, an address or HTML writes it, in hex or in base64."""
    return _known().hide(text)


def holds_secret(text: str) -> bool:
    """Whether a text holds a known secret, or something that has the shape of a vendor's key."""
    return redact_known(text) != text or any(pattern.search(text) for pattern, _ in _LOOKS)


def known_secrets() -> object:
    """What is known to be secret now: the same object for as long as nothing is added to it or taken away."""
    return _known()


def redact_all(value: Any, *, looks: bool = True) -> Any:
    """A copy of a JSON value with every text in it redacted; picture data (key "png") keeps what merely looks like a key.

    Args:
        value: Mappings, lists and texts; what else it holds stays as it is.
        looks: Also what merely looks like a key.
    """
    known = _known()
    if not looks and known.empty:
        return value
    # Most of a record is numbers and short words.
    shortest = min(known.shortest or _SHORTEST_LOOK, _SHORTEST_LOOK)

    def hide(text: str) -> str:
        if len(text) < shortest:
            return text
        return _redact_looks(known.hide(text)) if looks else known.hide(text)

    def clean(value: Any) -> Any:
        if type(value) in _NUMBERS:
            return value
        if isinstance(value, str):
            return hide(value)
        if isinstance(value, dict | Mapping):
            return {
                hide(str(key)): known.hide(item) if key == "png" and isinstance(item, str) else clean(item)
                for key, item in value.items()
            }
        if isinstance(value, list | tuple):
            return [clean(item) for item in value]
        return value

    return clean(value)


_NUMBERS = frozenset({int, float, bool, type(None)})


def redact_streams() -> None:
    """From now on, whatever is printed is redacted."""
    sys.stdout, sys.stderr = (
        stream if isinstance(stream, RedactedStream) else cast(TextIO, RedactedStream(stream))
        for stream in (sys.stdout, sys.stderr)
    )


@contextlib.contextmanager
def redacted_streams() -> Iterator[None]:
    """Redact what anybody prints meanwhile: libraries, warnings, threads that end with an exception, the user's own code."""
    before = sys.stdout, sys.stderr
    redact_streams()
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


class RedactedStream:
    """A text stream that redacts each piece as it is written."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        self._stream.write(redact(text) if isinstance(text, str) else text)
        return len(text)

    def writelines(self, lines: Any) -> None:
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._stream)


_SHORTEST_LOOK = 11
"""Nothing shorter looks like a key: `sk-` and eight letters, `?key=` and six."""
_OFTEN = 120
"""Texts of so many characters come again."""


def _redact_looks(text: str) -> str:
    if len(text) < _SHORTEST_LOOK:
        return text
    return _without_looks_again(text) if len(text) <= _OFTEN else _without_looks(text)


def _without_looks(text: str) -> str:
    if ";base64," in text:
        pieces = _EMBEDDED.split(text)
        return "".join(piece if k % 2 else _redact_looks(piece) for k, piece in enumerate(pieces))
    for pattern, words in _LOOKS:
        text = _without(pattern, text, _places(text, words), lambda match: HIDDEN)
    if not text.isascii() and _ODD.search(text):
        return _AFTER_NAME.sub(_name_alone, text)
    return _without(_AFTER_NAME, text, _places(text.lower(), _NAMES), _name_alone, _BEFORE_NAME)


_without_looks_again = functools.lru_cache(maxsize=4096)(_without_looks)
"""The same for short texts, most of which come again: what things are called, and what is said of them."""


def _name_alone(match: re.Match[str]) -> str:
    return match.group(1) + HIDDEN


def _places(text: str, words: Sequence[str]) -> list[int]:
    """Where any of these words stands, in order."""
    found = []
    for word in words:
        place = text.find(word)
        while place >= 0:
            found.append(place)
            place = text.find(word, place + 1)
    return sorted(found)


def _without(
    pattern: re.Pattern[str], text: str, places: Sequence[int], instead: Callable[[re.Match[str]], str], before: int = 0
) -> str:
    """`pattern.sub` where every match begins at one of `places`, or at most so many characters `before` it."""
    pieces, end, tried = [], 0, 0
    for place in places:
        start = max(tried, place - before)
        while start <= place:
            match = pattern.match(text, start)
            tried = start = start + 1 if match is None else match.end()
            if match is not None:
                pieces += [text[end : match.start()], instead(match)]
                end = match.end()
    return "".join([*pieces, text[end:]]) if pieces else text


def _known() -> _Known:
    global _latest
    # The environment as CPython holds it: to compare two of them takes a hundredth of reading one.
    raw = getattr(os.environ, "_data", None)
    if raw is not None and (raw, _used) == _latest[:2]:
        return _latest[2]
    set_now = (
        value.strip() for name, value in os.environ.items() if len(value) >= SHORTEST_UNUSED and names_secret(name)
    )
    known = _known_of(frozenset(_used), frozenset(value for value in set_now if len(value) >= SHORTEST_UNUSED))
    _latest = (dict(raw or {}), set(_used), known)
    return known


@functools.lru_cache(maxsize=4)
def _known_of(used: frozenset[str], in_environment: frozenset[str]) -> _Known:
    # A variable such as SSH_KEY may name a file, which is no secret.
    return _Known({*used, *(value for value in in_environment if not os.path.exists(value))})


class _Known:
    """Finds these secrets in every coding and case; the longest first, so that a shorter one leaves no half of another."""

    def __init__(self, secrets: set[str]) -> None:
        # Each is compiled by itself and once: a process that uses a key for each of its users does not compile all of them anew
        # with every one.
        self._finders = tuple(_finder(secret) for secret in sorted(secrets, key=lambda secret: (-len(secret), secret)))
        self.shortest = min((finder.shortest for finder in self._finders), default=0)

    @property
    def empty(self) -> bool:
        return not self._finders

    def hide(self, text: str) -> str:
        if len(text) < self.shortest or not self._finders:
            return text
        if _ESCAPES.search(text):
            # A picture inside of a page holds no escapes.
            pieces = _EMBEDDED.split(text)
            text = "".join(piece if k % 2 else self._without_coded(piece) for k, piece in enumerate(pieces))
        lower = text.lower()
        for finder in self._finders:
            if any(form in lower for form in finder.lower):
                text = finder.plain.sub(HIDDEN, text)
                lower = text.lower()
        return text

    def _without_coded(self, piece: str) -> str:
        for finder in self._finders:
            piece = finder.coded.sub(HIDDEN, piece)
        return piece


class _Finder:
    """Finds one secret.

    Attributes:
        lower: Its whole forms in lower case: plain, in hex, in base64.
        plain: Finds these in any case.
        coded: Finds it where letters of it are escaped.
        shortest: Length of its shortest form.
    """

    def __init__(self, secret: str) -> None:
        whole = _whole_forms(secret)
        # Base64 may be escaped once more where it holds more than letters and digits.
        escaped = [secret, *(form for form in whole if not form.isalnum() and form != secret)]
        first = "".join(re.escape(letter) for letter in sorted({form[0] for form in escaped}))
        forms = "|".join("".join(map(_character, form)) for form in escaped)
        # The look ahead makes it ten times as fast.
        self.coded = re.compile(rf"(?=[{first}\\%&])(?:{forms})", re.IGNORECASE)
        self.plain = re.compile("|".join(map(re.escape, whole)), re.IGNORECASE)
        self.lower = tuple(dict.fromkeys(form.lower() for form in whole))
        self.shortest = min(map(len, whole))


@functools.lru_cache(maxsize=8192)
def _finder(secret: str) -> _Finder:
    return _Finder(secret)


def _whole_forms(secret: str) -> list[str]:
    """The secret as it is, in hex, and in base64 of either alphabet."""
    raw = secret.encode("utf-8", errors="surrogatepass")
    coded = _base64_forms(raw)
    swapped = [form.replace("+", "-").replace("/", "_") for form in coded]
    return list(dict.fromkeys([secret, raw.hex(), *coded, *swapped]))


def _character(letter: str) -> str:
    """A letter as itself, or as JSON, Python, an address or HTML may write it, escaped once or several times."""
    units = letter.encode("utf-16-be", errors="surrogatepass").hex()
    octets = letter.encode("utf-8", errors="surrogatepass").hex()
    forms = [
        re.escape(letter),
        "".join(rf"\\+u{units[k : k + 4]}" for k in range(0, len(units), 4)),
        "".join(rf"\\+x{octets[k : k + 2]}" for k in range(0, len(octets), 2)),
        "".join(f"%(?:25)*{octets[k : k + 2]}" for k in range(0, len(octets), 2)),
        rf"&(?:amp;)*\#0*{ord(letter)};",
        rf"&(?:amp;)*\#[xX]0*{ord(letter):x};",
    ]
    if 127 < ord(letter) < 256:
        forms.append(rf"\\+x{ord(letter):02x}")
    if letter in "\"'\\/+":
        forms.append(rf"\\+{re.escape(letter)}")
    if letter in _NAMED:
        forms.append(f"&(?:amp;)*{_NAMED[letter]};")
    return f"(?:{'|'.join(forms)})"


def _base64_forms(raw: bytes) -> list[str]:
    """What stands in base64 for these bytes wherever they begin: the letters that no byte before or after has a part in."""
    forms = []
    for before, shared in enumerate((0, 2, 3)):
        coded = base64.b64encode(b"\0" * before + raw).decode("ascii")
        forms.append(coded[shared : (before + len(raw)) * 8 // 6])
    return forms


_latest: tuple[dict[Any, Any], set[str], _Known] = ({}, set(), _Known(set()))
"""The environment and the keys in use when the secrets were looked for last, and what was found."""
