"""Cut a text into tokens of the vocabulary, and name the words that are not in it."""

from __future__ import annotations

import re
from dataclasses import dataclass

from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.language.phrases import PHRASES
from wonderful_team.offline.language.vocabulary import ARTICLES, FILLERS, NUMBERS, WORDS, kind_of, nearest_words

_PIECE = re.compile(r"\{[^{}]+\}|beside_[a-z]+|\d+(?:\.\d+)?(?:st|nd|rd|th)?|°|[^\W\d_]+|[,;.:!?()]", re.UNICODE)
_LONGEST = max(len(phrase) for phrase in PHRASES)
_STARTS_NOUN_PHRASE = frozenset(
    "NOUN SHAPE COLOUR ORANGE PATTERN ONE SIDE SLOT DARK SUPER LETTER MATERIAL LOOK".split()
)


_SIDES_OF_IT = {"north": "above", "south": "below", "west": "left_of", "east": "right_of", "left": "left_of",
                "right": "right_of", "top": "above", "bottom": "below", "upper": "above", "lower": "below"}  # fmt: skip
"""In the main view: north is up."""


@dataclass(frozen=True)
class Token:
    """A word or phrase: its kind in the grammar, its canonical value, and how it was written."""

    kind: str
    value: object
    text: str


def tokenise(text: str) -> list[Token]:
    """Tokens of a text in order, articles and fillers dropped.

    Raises:
        NotUnderstoodError: A word is not in the vocabulary; says which were used and which are unknown.
    """
    tokens, unknown = cut(text)
    if unknown:
        raise NotUnderstoodError(refusal(tokens, unknown))
    return tokens


def cut(text: str) -> tuple[list[Token], list[str]]:
    """Tokens of a text in order, and the words that are not in the vocabulary."""
    pieces = _with_verbs(_with_heads(_with_fruits(_PIECE.findall(_plain(text)))))
    pieces = [piece for piece in pieces if piece not in ARTICLES]
    tokens: list[Token] = []
    unknown: list[str] = []
    position = 0
    while position < len(pieces):
        token, length = _next(pieces, position)
        if token is not None:
            tokens.append(token)
        elif length == 0:
            unknown.append(pieces[position])
        position += max(length, 1)
    return _with_choices(tokens), unknown


def _with_fruits(pieces: list[str]) -> list[str]:
    """The word "fruit" without an article or an adjective speaks of many: "put fruit in the bowl"."""
    return [
        "fruits" if piece == "fruit" and not (at >= 0 and _is_adjective(pieces[at])) else piece
        for at, piece in enumerate(pieces, -1)
    ]


def _is_adjective(piece: str) -> bool:
    kind = kind_of(piece)
    return piece in ("the", "a", "this", "that", "of") or kind in (*_BEFORE_HEAD, "EACH", "ONE", "ANY")


def _with_choices(tokens: list[Token]) -> list[Token]:
    """What "any" means: a free choice of what is to be moved ("put any block"), all of several ("any blocks"), and
    every one in a rule ("any block that is red goes there"); it stays unread where it may mean one or all.
    """
    out: list[Token] = []
    for at, token in enumerate(tokens):
        if token.kind == "ANY":
            end = next((k for k in range(at + 1, len(tokens)) if tokens[k].kind in _ENDS_CHOICE), len(tokens))
            value = tokens[end].value if end < len(tokens) else ()
            many = isinstance(value, tuple) and bool(value and value[-1])
            told = [item.kind for item in tokens[end + 1 :]]
            limited = bool({*told[:2]} & _LIMITS)
            rule = not any(item.kind in _VERBS_OF_CHOICE for item in tokens[:at]) and "AUX" in told
            if tokens[at + 1 : at + 2] and tokens[at + 1].kind == "NUMBER":
                continue
            if many or (rule and limited):
                token = Token("EACH", "each", token.text)
            elif not rule and not limited:
                token = Token("ONE_OF", 1.0, token.text)
        out.append(token)
    return out


_ENDS_CHOICE = ("NOUN", "SHAPE", "SLOT", "ORANGE", "ONE", "EVERYTHING")
_LIMITS = frozenset(("THAT", "WITH", "WHOSE", "ON_TABLE", "SHARE", "LIKE", "MATCH", "SAME", "OF", "ASPECT"))
_VERBS_OF_CHOICE = ("PUT", "TAKE", "ROTATE", "STACK", "PUSH", "SORT", "SWAP", "RETURN", "REMOVE", "GIVE", "WANT")
_CLAUSE_STARTS = frozenset((*",;.:!?", "and", "then", "to"))
_PUTTING = frozenset(("lower", "centre", "center"))
_BEFORE_HEAD = ("COLOUR", "ORANGE", "PATTERN", "MATERIAL", "LOOK", "SUPER", "SIDE", "DARK", "ORDINAL", "LETTER", "SLOT")


def _with_heads(pieces: list[str]) -> list[str]:
    """The words "the red and the green block" names two things: each article gets the noun that they share."""
    out: list[str] = []
    for at, piece in enumerate(pieces):
        if piece in ("and", ",") and pieces[at + 1 : at + 2] == ["the"] and _is_open(out):
            noun = next((word for word in pieces[at + 2 :] if kind_of(word) in ("NOUN", "SHAPE", "ONE")), None)
            words = pieces[at + 2 : pieces.index(noun, at + 2)] if noun is not None else []
            before = all(kind_of(word) in (*_BEFORE_HEAD, "AND") or word in (",", "the") for word in words)
            if noun is not None and words and before:
                out.append(noun)
        out.append(piece)
    return out


def _with_verbs(pieces: list[str]) -> list[str]:
    """Words for a side, a size or free room that start a clause before an article are verbs: "lower the block" puts it."""
    out: list[str] = []
    for at, piece in enumerate(pieces):
        starts = at == 0 or pieces[at - 1] in _CLAUSE_STARTS or (pieces[at - 1] in FILLERS and pieces[at - 1] != "all")
        named = pieces[at + 1 : at + 2]
        before_thing = bool(named) and (named[0] in ARTICLES or named[0] in ("it", "them") or named[0][0] == "{")
        kind = kind_of(piece)
        if starts and before_thing and kind in ("SIDE", "SUPER", "FREE") and (piece,) not in PHRASES:
            piece = "put" if piece in _PUTTING else f"to {piece}"
        out.append(piece)
    return out


def _is_open(pieces: list[str]) -> bool:
    """Whether the last words are "the" and adjectives alone: their noun is still to come."""
    for at in range(len(pieces) - 1, -1, -1):
        piece = pieces[at]
        if piece == "the":
            return pieces[-1] != "the" and pieces[at - 1] not in ("at", "on", "in", "to", "from", "of", "with")
        if kind_of(piece) not in _BEFORE_HEAD:
            return False
    return False


OTHERS_MAY = "For photos like this name a vision-language model: --model anthropic:..., or probe your own server."


def refusal(tokens: list[Token], unknown: list[str]) -> str:
    """Which words were used, which are not known, and what to do."""
    used = (
        ", ".join(dict.fromkeys(token.text for token in tokens if token.kind not in ("SEP", "THEN", "AND")))
        or "nothing"
    )
    return f"I used: {used}. I do not know: {', '.join(dict.fromkeys(unknown))}. {nearest_words(unknown)} {OTHERS_MAY}"


def _plain(text: str) -> str:
    """Lower case except inside slots; possessives and contractions opened; hyphens are spaces."""
    parts = re.split(r"(\{[^{}]+\})", text)
    plain = [part if part.startswith("{") else _plain_words(part) for part in parts]
    return "".join(plain)


def _plain_words(text: str) -> str:
    text = text.replace("\u2019", "'").replace("\u00ba", "°")
    # A capital letter on its own is the name of a letter block; "A" and "I" are words unless quoted or after "letter".
    text = re.sub(r"""(?i:\bletters?\s+)["']?([A-Za-z])["']?\b""", r"letter_\1", text)
    text = re.sub(r"""["']([A-Z])["'](?=\W|$)""", r"letter_\1", text)
    text = re.sub(r"""\b([B-HJ-Z])\b(?!['-])""", r"letter_\1", text)
    text = re.sub(r"""(?<!^)(?<![.!?]\s)\b(?<=the )(A|I)\b""", r"letter_\1", text)
    text = re.sub(r"\s*(?:->|=>|\u2192)\s*", " into ", text)
    text = re.sub(r"(?<!the )\bfirst\b", " ", text.lower())
    text = text.replace("-", " ").replace("'s ", " ").replace("'", " ").replace('"', " ")
    return re.sub(r"letter_([a-z])\b", lambda match: f"{{letter:{match.group(1).upper()}}}", text)


def _next(pieces: list[str], start: int) -> tuple[Token | None, int]:
    """The token that starts there and how many pieces it takes; (None, n) is skipped, (None, 0) is unknown."""
    piece = pieces[start]
    if piece.startswith("{"):
        if piece.startswith("{letter:"):
            return Token("LETTER", piece[8:-1], f"letter {piece[8:-1]}"), 1
        return Token("SLOT", piece[1:-1], piece), 1
    if piece.startswith("beside_"):
        return Token("BESIDE_IT", _SIDES_OF_IT[piece[7:]], f"at its {piece[7:]}"), 1
    if piece in ",;.:!?()":
        return (None, 1) if piece in "()" else (Token("COMMA" if piece == "," else "SEP", piece, piece), 1)
    for length in range(min(_LONGEST, len(pieces) - start), 0, -1):
        words = tuple(pieces[start : start + length])
        entry = PHRASES.get(words)
        if entry is None or (entry[0] == "SIDE_POST" and _noun_phrase_follows(pieces, start + length)):
            continue
        return (None if entry[0] == "SKIP" else Token(entry[0], entry[1], " ".join(words))), length
    before = kind_of(pieces[start - 1]) if start else ""
    if piece == "one" and _noun_phrase_follows(pieces, start + 1) and before not in (*_BEFORE_HEAD, "ALL", "EACH"):
        return Token("ONE_OF", 1.0, piece), 1  # "one pink block": any of them
    angle = _angle(pieces, start)
    if angle is not None:
        return angle
    if piece in WORDS:
        kind, value = WORDS[piece]
        return Token(kind, value, piece), 1
    if piece in FILLERS:
        return None, 1
    return None, 0


def _noun_phrase_follows(pieces: list[str], at: int) -> bool:
    if at >= len(pieces):
        return False
    word = pieces[at]
    return word.startswith("{") or kind_of(word) in _STARTS_NOUN_PHRASE


def _angle(pieces: list[str], start: int) -> tuple[Token, int] | None:
    """An angle such as "120 degrees", "120°", "ninety degrees", "one hundred and twenty degrees"; a bare number is a count."""
    total, position = 0.0, start
    sign = 1.0
    if pieces[start] == "minus":
        sign, position, start = -1.0, start + 1, start + 1
        if start >= len(pieces):
            return None
    first = start - (sign < 0)
    while position < len(pieces):
        word = pieces[position]
        if re.fullmatch(r"\d+(\.\d+)?", word):
            total += float(word)
        elif word == "hundred":
            total = max(total, 1.0) * 100
        elif word in NUMBERS:
            total += NUMBERS[word]
        elif not (
            position > start and word in ("and",) and position + 1 < len(pieces) and pieces[position + 1] in NUMBERS
        ):
            if not (word == "one" and position + 1 < len(pieces) and pieces[position + 1] == "hundred"):
                break
        position += 1
    if position == start:
        return None
    text = " ".join(pieces[start:position])
    if position < len(pieces) and pieces[position] in ("degrees", "degree", "deg", "degs", "°"):
        return Token("ANGLE", sign * total, f"{text} degrees"), position - first + 1
    if position == start + 1 and sign > 0:
        return Token("NUMBER", total, text), 1
    return None
