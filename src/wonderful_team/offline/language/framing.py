"""What is said round an instruction, to whoever listens, and asks for nothing: "do you think you could", "that is all I want".

It is told by its words: they are those of talk between people, and some of them speak to someone. Words that name a thing, deny
or forbid are not among them, so that nothing else is ever passed over.
"""

from __future__ import annotations

import re

from wonderful_team.offline.language.clause_parts import VERBS
from wonderful_team.offline.language.vocabulary import kind_of

_TALK = frozenset(
    """i you we me us my your it that this there here would could can will may might shall should must do does doing did be is are was were am been
    being have has had having like love want wants wanted need needs wish hope hoping think thinking guess reckon suppose believe wonder wondering
    figure mind please kindly if whether when whenever once as soon possible time chance moment minute second sec favour favor help helping sure able
    ask asking asked request task job goal aim thing something thanks thank great nice good lovely wonderful perfect brilliant happy glad grateful
    appreciate appreciated kind dear so very much really just maybe perhaps okay ok hey hi hello robot buddy mate now well right alright let lets go
    going ahead try trying make see get got to a the of for and or but about how what which why all any too trouble bother problem done finished
    ready through sorry found whatever happens however many matter chap lot bunch million take care following instruction instructions read listen
    attention pay work order request simple before carefully says say oh um er uh tell know mean look by with on at out up first next then ever
    awfully terribly quick quickly today free""".split()
)
"""Words of talk between people: alone they name nothing and move nothing."""
_TO_SOMEONE = frozenset(
    """i you we me us your mind kind please thanks thank task job goal aim time chance possible sorry trouble bother matter happens however good hi
    hey hello all read listen""".split()
)
"""One of these makes it talk."""
_ASKED_POLITELY = re.compile(
    r"\b(?:why )?(?:do|does|could|can|would|will|is) not (?=you|we|it|mind)|\bwhy not\b|\bnot (?=too much\b|a (?:problem|bother)\b)",
    re.IGNORECASE,
)
NOTHING_ELSE = "do nothing else"
"""What is left of talk that forbids more."""
_NOTHING_MORE = re.compile(r"\bdo no more than (?:it|this|that|i|we) (?:says?|said)\b", re.IGNORECASE)
_VAGUE = re.compile(r"(?<=\bsomething) on the table\b|\bone (?=thing\b)", re.IGNORECASE)
_LINKS = frozenset(("if", "when", "whenever", "once", "before", "as"))
"""What begins with one of these says when, or under which condition."""
_WORD = re.compile(r"\{[^{}]*\}|[a-z']+|\d+")
_TAILS = re.compile(r"\s+(?:when|whenever|once|as soon as|by the time|if|before|and i|thanks|thank)\b", re.IGNORECASE)
_LEADS = re.compile(r"\s*(?:(?:and|but|then|next|finally|first|after that|or)\b,?\s*)*", re.IGNORECASE)


def without_talk(text: str) -> str:
    """The text without what is said to the listener alone: "do you think you could", ", when you get a chance"."""
    text = _ASKED_POLITELY.sub("", text)
    sentences = [_without_talk(sentence) for sentence in re.split(r"(?<=[.!?;])\s+", text)]
    return " ".join(sentence for sentence in sentences if sentence) or text


def _without_talk(sentence: str) -> str:
    """A sentence without the parts between its marks that are talk, and without the talk at either end of the others."""
    parts = re.split(r"(\s*[,:]\s*|\s+[-\u2013\u2014]\s+|[.!?;]+$)", sentence)
    out = ""
    for piece, mark in zip(parts[::2], [*parts[1::2], ""], strict=True):
        if not _is_talk(_NOTHING_MORE.sub("", piece)):
            out += _without_tail(_from_its_verb(piece)) + mark
        elif _NOTHING_MORE.search(piece):
            out += NOTHING_ELSE + mark
    return out


def _without_tail(piece: str) -> str:
    ends = (found.start() for found in _TAILS.finditer(piece))
    return piece[: next((end for end in ends if _is_talk(piece[end:])), None)]


def _is_talk(text: str) -> bool:
    words = {*_WORD.findall(_VAGUE.sub("", text.lower()))}
    return bool(_TO_SOMEONE & words) and words <= _TALK


def _from_its_verb(piece: str) -> str:
    """A piece from its first verb on where nothing but talk stands before; what links it to others stays."""
    leads = _LEADS.match(piece)
    start = leads.end() if leads is not None else 0
    before = ""
    for found in _WORD.finditer(piece.lower(), start):
        word, after = found.group(), _WORD.search(piece.lower(), found.end())
        if kind_of(word) in VERBS and not (after is not None and after.group() in ("you", "if", "to")):
            named = before.split()[-1:] in (["a"], ["an"], ["the"]) or word in ("see", "look", "find")
            plain = _is_talk(before) and not named and before.split()[0] not in _LINKS
            return piece[:start] + piece[found.start() :] if plain else piece
        if word not in _TALK:
            return piece
        before = piece[start : found.end()].lower()
    return piece
