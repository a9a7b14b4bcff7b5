"""What is done to a thing where it is, rather than where it goes: a figure drawn on it, its surface wiped, it is shaken, it is opened."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wonderful_team.offline.description import Description, Figure
from wonderful_team.offline.language.clause_meaning import related_to
from wonderful_team.offline.language.clause_parts import PLACES, VERBS, Parts, Unclear
from wonderful_team.offline.language.meaning import Meaning
from wonderful_team.offline.language.tokens import Token
from wonderful_team.offline.language.vocabulary import FIGURES

HANDLED = ("DRAW", "WIPE", "SHAKE", "OPEN")
"""Kinds of verbs that are read here."""
_TO = frozenset(("INTO", "ONTO", "TO", "ORIGIN", "BETWEEN"))
_HEADS = frozenset("NOUN SHAPE LETTER SLOT ONE IT THEY TABLE EVERYTHING".split())
_ENDS = frozenset(("SEP", "THEN"))
_ALSO = ("line", "spiral")
"""Figures whose words otherwise say what a thing is like: long, swirled."""
_LARGE, _SMALL = 1.2, 0.6
"""How much larger or smaller a figure is that is called large or small."""
_SILENT = frozenset(("np", "place", "FIGURE", "TIMES", "AND", "COMMA", "AUX", "WANT", "GIVE", "TAKE", "there"))
"""Parts that may stand beside the verb; `there` is "put it back there" said of what is shaken."""
_BESIDE = {
    "OPEN": ("off", "from", "REMOVE", "ROTATE", "angle", "turn"),
    "SHAKE": ("PUT", "RETURN", "origin"),
    "DRAW": ("off",),
    "WIPE": ("off",),
}
"""What may stand beside each verb besides: "unscrew the cap from the bottle", "trace out a star", "wipe off the plate"."""
_PARTS = ("cap", "stopper", "cork", "lid")
"""What is on a thing and comes off it: "the cap of the bottle" stands on the bottle."""
_MOST_TIPS, _MOST_TIMES = 9, 9
"""More of them do not fit into the points that a path may have."""


def handled(tokens: Sequence[Token]) -> list[Token]:
    """The tokens with figures and counts as one token each; wiping a thing to a place is pushing it there."""
    out: list[Token] = []
    at, drawing, placing = 0, False, False
    while at < len(tokens):
        token = tokens[at]
        drawing = (drawing or token.kind == "DRAW") and token.kind not in _ENDS
        placing = (placing or token.kind in PLACES) and token.kind != "DRAW"
        # After "on", a shape is what is drawn on: "draw a star on the square".
        taken, figure = _figure(tokens, at) if drawing and not placing else (0, None)
        placing = placing and token.kind not in _HEADS
        if figure is not None:
            out.append(Token("FIGURE", figure, " ".join(item.text for item in tokens[at : at + taken])))
            at += taken
            continue
        if token.kind == "NUMBER" and at + 1 < len(tokens) and tokens[at + 1].text == "times":
            out.append(Token("TIMES", token.value, f"{token.text} times"))
            at += 2
            continue
        before = tokens[at - 1] if at else token
        if token.kind == "OF" and before.kind == "NOUN" and before.text in _PARTS:
            token = Token("FROM", "from", token.text)
        if (
            token.kind == "ASPECT"
            and before.kind in HANDLED
            and [item.kind for item in tokens[at + 1 : at + 2]] == ["OF"]
        ):
            at += 2  # "wipe the surface of the plate"
            continue
        if token.kind == "WIPE" and _goes_somewhere(tokens[at + 1 :]):
            token = Token("PUSH", "push", token.text)
        out.append(token)
        at += 1
    return out


def _goes_somewhere(after: Sequence[Token]) -> bool:
    """Whether a place follows in the same clause."""
    for token in after:
        if token.kind in (*_ENDS, *VERBS):
            return False
        if token.kind in _TO or (token.kind == "SIDE_POST" and token.text.startswith(("to", "all way to"))):
            return True
    return False


def _figure(tokens: Sequence[Token], start: int) -> tuple[int, Figure | None]:
    """The figure that starts there ("five pointed star", "small circle", "star with six tips") and how many tokens it takes."""
    at, count, size = start, 0, 1.0
    if (
        tokens[at].kind == "SUPER"
        and not tokens[at].text.endswith("est")
        and tokens[at].value in ("largest", "smallest")
    ):
        size, at = (_LARGE if tokens[at].value == "largest" else _SMALL), at + 1
    if _is_count(tokens[at : at + 2]):
        count, at = int(float(str(tokens[at].value))), at + 2
    name = _name(tokens[at]) if at < len(tokens) else ""
    if not name:
        return 0, None
    at += 1
    if at < len(tokens) and tokens[at].kind == "WITH" and _is_count(tokens[at + 1 : at + 3]):
        count, at = int(float(str(tokens[at + 1].value))), at + 3
    return at - start, Figure(name, count, size)


def _is_count(tokens: Sequence[Token]) -> bool:
    """Whether two tokens are "five pointed" or "six tips"."""
    return [token.kind for token in tokens] in (["NUMBER", "TIPS"], ["NUMBER", "FACE"])


def _name(token: Token) -> str:
    """The figure that a word in the singular stands for, or ""."""
    if token.kind == "FIGURE" or token.text in _ALSO:
        return token.text
    shape, many = token.value if token.kind == "SHAPE" and isinstance(token.value, tuple) else ("", False)
    return str(shape) if shape in FIGURES and not many else ""


def read_handled(parts: Parts, meaning: Meaning) -> bool:
    """Read a clause that says what is done to a thing where it is; False where it is none."""
    nouns = {value.noun for value in parts.of("np")}
    verb = next((kind for kind in HANDLED if kind in parts.kinds), "")
    if (
        not verb
        and nouns & {"cap", "lid"}
        and parts.kinds & {"REMOVE", "ROTATE", "TAKE"}
        and parts.kinds & {"off", "from", "REMOVE"}
    ):
        verb = "OPEN"
    if not verb:
        return _put_back(parts, meaning)
    extra = parts.kinds - _SILENT - {verb, *_BESIDE[verb]}
    if extra:
        raise Unclear(f"it is not clear what {', '.join(sorted(extra)).lower()} is for")
    things, tool = _things(parts, meaning)
    for thing in things:
        if verb == "SHAKE":
            meaning.handle("shake", thing, Figure("shake", _count(parts.of("TIMES"), _MOST_TIMES, "times")))
        elif verb == "OPEN":
            meaning.handle("open", thing, rotate_deg=next(iter(parts.of("angle")), 0.0))
        else:
            figure = Figure("area") if verb == "WIPE" else _drawn(parts)
            meaning.handle("trace", thing, figure, tool)
    return True


def _put_back(parts: Parts, meaning: Meaning) -> bool:
    """Whether a clause only says that what was shaken is put down again: that is part of it."""
    says = parts.kinds & {"PUT", "RETURN", "origin"} and parts.kinds <= {"np", "PUT", "RETURN", "origin", "there"}
    return bool(says) and all(map(meaning.shaken, parts.of("np") or meaning.or_last(())))


def _things(parts: Parts, meaning: Meaning) -> tuple[list[Description], Description | None]:
    """What it is done to, and the tool that is named: in this clause, or in the one before ("take the sponge and wipe …")."""
    found: list[Description] = []
    tool = meaning.last_thing if meaning.last_thing is not None and meaning.last_thing.noun == "tool" else None
    word, tools = "", 0
    for kind, value in parts.items:
        if kind == "place":
            word = str(value)
        elif kind != "np" or value.name == "table":
            continue
        elif value.noun == "tool":
            tool, tools = value, tools + 1
        elif found and value.noun != "cap" and found[-1].noun == "cap":
            found[-1] = value  # what the cap is on: that is opened
        elif found and value.noun != "lid" and found[-1].noun == "lid":
            found[-1] = value
        elif found and word:
            found[-1] = related_to(found[-1], word, value)
            word = ""
        else:
            found.append(value)
            word = ""
    if tools > 1:
        raise Unclear("it is not clear which tool is meant")
    return meaning.or_last(found), tool


def _drawn(parts: Parts) -> Figure:
    figures: list[Figure] = parts.of("FIGURE")
    if len(figures) != 1:
        raise Unclear(f"I draw one figure at a time: {', '.join(FIGURES)}; I read {len(figures)}")
    figure = figures[0]
    usual = FIGURES[figure.name]
    if figure.count and figure.name != "star" and figure.count != usual:
        raise Unclear(f"a {figure.name} has no {figure.count} corners")
    if figure.name != "star":
        return replace(figure, count=0)
    if figure.count and not 3 <= figure.count <= _MOST_TIPS:  # noqa: PLR2004  fewer tips make no star
        raise Unclear(f"a star of mine has 3 to {_MOST_TIPS} tips, not {figure.count}")
    return replace(figure, count=figure.count or usual)


def _count(said: Sequence[object], most: int, what: str) -> int:
    count = int(float(str(said[0]))) if said else 0
    if count > most:
        raise Unclear(f"at most {most} {what} fit into one path, not {count}")
    return count
