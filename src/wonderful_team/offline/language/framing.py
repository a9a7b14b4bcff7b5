"""Sentences round an instruction that ask for nothing: "I would like you to take care of something. ... That is all."

Such a sentence speaks of the task in general. One that names a thing, a place or a picture, asks for an action or forbids
something is never passed over, whether its words are known or not.
"""

from __future__ import annotations

import re

from wonderful_team.offline.language.clause_parts import VERBS
from wonderful_team.offline.language.tokens import Token, cut

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
    return not ordered and all(token.kind in _GENERAL or _is_general(token) for token in tokens)


def _is_general(token: Token) -> bool:
    """Whether a noun names nothing in particular."""
    return token.kind == "NOUN" and token.value == ("object", "", False)
