"""What is said round an instruction and asks for nothing: "I would like you to take care of something. ... That is all."

Such a sentence speaks of the task in general. One that names a thing, a place or a picture, asks for an action or forbids
something is never passed over, whether its words are known or not.
"""

from __future__ import annotations

import re

from wonderful_team.offline.language.clause_parts import VERBS
from wonderful_team.offline.language.tokens import cut
from wonderful_team.offline.language.vocabulary import WORDS

_SPEAKS = re.compile(
    r"\s*(?:(?:please|so|now|well|ok|okay|hello|hi|hey),?\s+)*(?:i|we|you|there|here|this|that|these|it|all|do|read|listen|pay)\b",
    re.IGNORECASE,
)
"""A sentence about the task, not an order."""
_THE_TASK = re.compile(
    r"\b(?:something|things?|tasks?|jobs?|works?|requests?|instructions?|this|that|following|all|everything)\b",
    re.IGNORECASE,
)
_FORBIDS = re.compile(
    r"\b(?:you (?:should|must|have to|need to)|not|never|without|except|avoid\w*|only|leave|keep|unless|if)\b|n't\b",
    re.IGNORECASE,
)
_NAMED = r"\b(?:the|an?|this|that|these|those|my|your|our|his|her|their|its|every|each|some|any|no|of|with|in|into|on)\s+{}\b"
_NOTHING_MORE = re.compile(
    r"\b(?:no|nothing) (?:more|else)\b(?: than (?:it|this|that|i|we) (?:says?|said)\b)?", re.IGNORECASE
)
_GENERAL = frozenset("AUX GIVE WANT TAKE IN ON TO FOR OF AS AND WITH FROM BY THAT IT THEY THERE ALL ONE TABLE ON_TABLE COMMA SEP THEN "
                     "BEFORE BELOW NUMBER ONE_OF EVERYTHING SHARE".split())  # fmt: skip
"""Kinds of words that name and order nothing by themselves."""


def without_frames(text: str) -> tuple[str, bool]:
    """A text without the sentences that ask for nothing, and whether they say that nothing else is to be done."""
    sentences = re.split(r"(?<=[.!?:;])\s+", text.strip())
    frames = [sentence for sentence in sentences if _is_frame(sentence)]
    if len(frames) == len(sentences):
        return text, False
    kept = [sentence for sentence in sentences if sentence not in frames]
    return " ".join(kept), any(_NOTHING_MORE.search(frame) for frame in frames)


_TALK = frozenset(
    """i you we me us my your it that this there here would could can will may might shall should must do does doing did be is are was were am been
    being have has had having like love want wants wanted need needs wish hope hoping think thinking guess reckon suppose believe wonder wondering
    figure mind please kindly if whether when whenever once as soon possible time chance moment minute second sec favour favor help helping sure able
    ask asking asked request task job goal aim thing something thanks thank great nice good lovely wonderful perfect brilliant happy glad grateful
    appreciate appreciated kind dear so very much really just maybe perhaps okay ok hey hi hello robot buddy mate now well right alright let lets go
    going ahead try trying make see get got to a the of for and or but about how what which why all any too trouble bother problem done finished
    ready through sorry found whatever happens however many matter chap lot bunch million oh um er uh say tell know mean look by with on at out up first next then ever awfully terribly quick quickly today free""".split()
)
"""Words of talk between people: alone they name nothing and move nothing."""
_TO_SOMEONE = frozenset(
    "i you we me us your mind kind please thanks thank task job goal aim time chance possible sorry trouble bother matter happens however good hi hey hello".split()
)
"""One of these makes it talk."""
_ASKED_POLITELY = re.compile(
    r"\b(?:why )?(?:do|does|could|can|would|will|is) not (?=you|we|it|mind)|\bwhy not\b|\bnot (?=too much\b|a (?:problem|bother)\b)",
    re.IGNORECASE,
)
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
        plain = _from_its_verb(piece)
        for found in _TAILS.finditer(plain):
            if _is_talk(plain[found.start() :]):
                plain = plain[: found.start()]
                break
        out += "" if _is_talk(plain) else plain + mark
    return out


def _is_talk(text: str) -> bool:
    words = {*_WORD.findall(text.lower())}
    return bool(_TO_SOMEONE & words) and words <= _TALK


def _from_its_verb(piece: str) -> str:
    """A piece from its first verb on where nothing but talk stands before; what links it to others stays."""
    leads = _LEADS.match(piece)
    start = leads.end() if leads is not None else 0
    before = ""
    for found in _WORD.finditer(piece.lower(), start):
        word, after = found.group(), _WORD.search(piece.lower(), found.end())
        if WORDS.get(word, ("",))[0] in VERBS and not (after is not None and after.group() in ("you", "if", "to")):
            named = before.split()[-1:] in (["a"], ["an"], ["the"]) or word in ("see", "look", "find")
            return piece[:start] + piece[found.start() :] if _is_talk(before) and not named else piece
        if word not in _TALK:
            return piece
        before = piece[start : found.end()].lower()
    return piece


def _is_frame(sentence: str) -> bool:
    if not _SPEAKS.match(sentence) or not _THE_TASK.search(sentence) or _FORBIDS.search(sentence):
        return False
    sentence = _NOTHING_MORE.sub(" ", sentence)
    tokens, unknown = cut(sentence)
    if any(re.search(_NAMED.format(re.escape(word)), sentence, re.IGNORECASE) for word in unknown):
        return False
    ordered = any(
        one.kind in (*VERBS, "GIVE") and other.kind in ("IT", "THEY")
        for one, other in zip(tokens, tokens[1:], strict=False)
    )
    # "object" names nothing in particular.
    return not ordered and all(token.kind in _GENERAL or token.value == ("object", "", False) for token in tokens)
