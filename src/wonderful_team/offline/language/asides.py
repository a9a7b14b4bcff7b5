"""What a text says beside the instruction itself: reasons, and what must be left alone.

A reason ("because it is in the way") asks for nothing, so its words need not be known. What must be left alone is part of
what is asked: it is kept and checked against the plan.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from wonderful_team.offline.description import Description

_REASONS = (
    r"(?:[,;:(\u2013\u2014-]|\s)\s*\b(?:because|in order (?:to|that)|for the reason that|given how|as (?:i|we|you) "
    r"(?:need|want|have|will|can|must|would)|so (?:that )?(?:i|we|you|they|people|nobody|everyone|someone|the (?:table|room"
    r"|desk|others?|rest))\b)[^.;!?{}]*",
    r"^\s*(?:since|because|as)\b[^.,;{}]*,",
    r"(?:[,;(]|\s)\s*\bsince\b[^.;!?{}]*",
)
"""Clauses that only say why."""
_SETTINGS = (
    r"^\s*(?:this is|here is|here's) (?:a|an|the|what) [a-z ]*?(?:task|job|wish|request|idea)[^.:;{}]*[.:;]",
    r"\b(?:using|with) (?:the|your|a|its) (?:own )?(?:suction(?: cup| gripper)?|gripper|arm|hand|robot(?: arm)?|tool)\b",
)
_TOUCH = r"(?:touch|move|disturb|displace|change|handle|shift|rotate|use|bother with|bother|affect)(?:ing)?"
_OTHERS = (
    r"(?:any|every|some)thing else|the (?:others|rest|other (?:things|objects|items|blocks|fruits|pieces|ones))|"
    r"other (?:things|objects|items|blocks|fruits|pieces|ones)|any other (?:thing|object|item|block|fruit|piece)s?|others|"
    r"all (?:the )?others?(?: (?:things|objects|items|blocks|fruits|pieces|ones))?|all else|the remaining [a-z]+|any of the others|"
    r"(?:those|fruits?|ones|the ones|the others|things|objects|blocks|anything|any fruit|any) (?:without|that (?:have|has|lack|lacks)"
    r"|which (?:have|has|lack|lacks)|that do(?:es)? not have|with no)[a-z ]*?(?=\s*[.,;!]|\s*$|\s+(?:alone|untouched|unmoved|where|as they|as it|in place|and|but|stays?|remains?|must|should|are|is)\b)"
)
_STAYS = (
    r"(?:stays?|remains?|(?:is|are) left|(?:must|should|is to|are to|has to|have to|can|may|shall)(?: all)? (?:stay|remain|be left|not be "
    r"(?:moved|touched)))(?: (?:put|alone|untouched|unchanged|(?:exactly |just )?(?:as|where) (?:it|they) (?:is|are|lies?|stands?)|in place|in "
    r"(?:its|their) places?|there))*"
)
_JOIN = r"(?:[.,;]|\band\b|\bbut\b|\bwhile\b|\balso\b|\botherwise\b|^)(?:\s*(?:and|but|while|please|otherwise|also|else|just|simply|however),?)*\s*"
_ALONE = (
    r"(?: (?:alone|untouched|as (?:it|they) (?:is|are)|unmoved|in peace|be|unchanged|in place|in (?:its|their) places?|out(?: of it)?|"
    r"(?:exactly |just )?where (?:it|they) (?:is|are|lies?|stands?)))*"
)
_NOTHING_ELSE = (
    rf"{_JOIN}(?:do|change|move|touch|take)? ?nothing (?:else|more)\b(?: (?:is to be|should be|must be|may be|has to be|needs to be|is) "
    r"(?:moved|done|touched|changed))?",
    rf"{_JOIN}(?:do not|don't|never|please don't|you must not|no need to) {_TOUCH} (?:{_OTHERS})\b",
    rf"\s*,?\s*without {_TOUCH} (?:{_OTHERS})\b",
    rf"{_JOIN}(?:leave|ignore|skip|keep|spare|forget|disregard) (?:{_OTHERS}){_ALONE}",
    rf"{_JOIN}(?:{_OTHERS}|everything else) {_STAYS}",
    rf"{_JOIN}everything else (?:stays|remains|is left)[a-z ]*",
    rf"{_JOIN}that is all\b(?: (?:i want|you have to do|there is to do))?",
)
"""Nothing but what is named may be moved."""
_THESE = (
    rf"(?P<join>{_JOIN})(?:do not|don't|never) {_TOUCH} (?P<what>[^.,;{{}}]+)",
    rf"\s*,?\s*without {_TOUCH} (?P<what>(?:the|any|a|both) [^.,;{{}}]+|(?:the )?\{{[^{{}}]+\}})",
    rf"(?P<join>{_JOIN})(?:leave|keep) (?P<what>(?:the|both|all) [^.,;{{}}]+?)(?: (?:alone|untouched|as (?:it|they) (?:is|are)|unmoved|where (?:it|they) "
    r"(?:is|are|lies?|stands?)|in (?:its|their) places?))(?=\s*[.,;!]|\s*$)",
    rf"(?P<join>{_JOIN})(?P<what>the [^.,;{{}}]+?) {_STAYS}(?=\s*[.,;!]|\s*$)",
)
"""One thing that may not be moved."""
_ONLY = r"\b(?:only|solely|nothing but|no more than)\b(?! (?:if|where|when|one of))"


@dataclass(frozen=True)
class Asides:
    """What was said beside the instruction.

    Attributes:
        text: The instruction without it.
        nothing_else: Nothing but what the instruction names may be moved.
        spared: Things that may not be moved.
        others_without: The words speak of things that have no place; those stay.
    """

    text: str
    nothing_else: bool = False
    spared: tuple[Description, ...] = ()
    others_without: bool = False


def without_reasons(text: str) -> str:
    """The text without clauses that only say why or with what."""
    for pattern in (*_REASONS, *_SETTINGS):
        text = re.sub(pattern, " ", text, flags=re.IGNORECASE)
    return text


def set_aside(text: str, describe: Callable[[str], Description | None]) -> Asides:
    """Part an instruction from what it says beside it; `describe` reads noun phrases."""
    alone, without = False, False

    def told(found: re.Match[str]) -> str:
        nonlocal alone, without
        alone = True
        without |= bool(re.search(r"without (?:a|an|one|any|it|match)|lack|no (?:area|match)|not have", found.group(0)))
        return " . " if found.group(0).strip()[:1] in ".;" else " "

    for pattern in _NOTHING_ELSE:
        text = re.sub(pattern, told, text, flags=re.IGNORECASE)
    spared: list[Description] = []

    def spare(found: re.Match[str]) -> str:
        what = describe(found.group("what"))
        if what is None or what.name == "it":
            return found.group(0)
        spared.append(what)
        return " "

    for pattern in _THESE:
        text = re.sub(pattern, spare, text, flags=re.IGNORECASE)
    rest = re.sub(_ONLY, " ", text, flags=re.IGNORECASE)
    alone |= rest != text
    return Asides(rest, alone, tuple(spared), without)
