"""Clauses that limit or round off an instruction: "if such an area exists", "leave the others where they are"."""

from __future__ import annotations

import re

_OPENERS = r"(?:only if|if|where|wherever|when|whenever|provided that|provided|as long as|in case|assuming that|assuming|given that|so long as)"
_CONDITION_WORDS = frozenset(
    """such an a any area areas one region regions zone zones there is are exists exist existing available present found
    can be the that matching match matches its same colour color of with in it fruit fruits for them each on table scene
    possible ones has have corresponding where provided picture spot place places block blocks object objects container
    bowl bowls their actually which was were fits and also they patch patches paper papers sheet mat pad section sections location none
    pieces piece those these any do""".split()
)  # fmt: skip
_LEAVE = re.compile(
    r"(?:[.,;!?]|\band\b|\bbut\b|\botherwise\b|\belse\b)\s*(?:and |but |please |otherwise,? |if not,? |else |"
    r"(?:if|when|where) (?:there (?:is|are) (?:none|no [a-z ]+|not)|none (?:exists?|is there)|no such [a-z]+ exists?),? )*"
    r"(?:(?:leave|ignore|skip|keep)\b[^.;{}]*|(?:do not|don't) (?:move|touch) (?:the )?(?:others?|rest|it|them)\b[^.;{}]*"
    r"|(?:the )?(?:others|rest|other fruits?|remaining [a-z]+)\b[^.;{}]*\b(?:stays?|remains?|where)\b[^.;{}]*"
    r"|(?:those|fruits?|ones|any|all)\b[^.;{}]*\b(?:without|stays?|remains?)\b[^.;{}]*)",
    re.IGNORECASE,
)
_LEAVE_WORDS = _CONDITION_WORDS | frozenset(
    """if when where none leave ignore skip keep other others rest remaining where they alone untouched as place put without no not do don't
    move touch stay stays remain remains otherwise else but please if at their position positions those all current
    currently lie lies any who whose does doesn't have then remain so""".split()
)


_SCENE = re.compile(
    r"(?:^|,)?\s*(?:as\s+)?(?:that\s+(?:is|are)\s+|which\s+(?:is|are)\s+)?"
    r"(?:shown|seen|pictured|depicted|displayed|visible|appearing|found|located|looking|look|given|considering)?\s*"
    r"\b(?:in|from|of|at|on|within|inside|given|for|by|with)\s+(?:the\s+)?(?:picture|image|scene|view|photo)?\s*"
    r"\{[^{}]*scene[^{}]*\}",
    re.IGNORECASE,
)
"""Says which picture shows the thing; the thing itself is looked for on the table."""


def open_conditions(text: str) -> tuple[str, bool]:
    """The text without scene pictures, conditions and closing remarks, and whether there was a condition.

    A condition that comes first and names what "it" is ("if there is an area of the same colour, put each fruit into
    it") lends its words to the pronoun. A clause with any other word stays, so that its words are refused by name.
    """
    if not re.search(r"\bplace of\b", text):
        text = _SCENE.sub(" ", text)
    text, leaves = _without(text, _LEAVE, _LEAVE_WORDS)
    text, named = _leading(text)
    if named:
        return text, True
    inside = re.compile(
        rf"[,(]?\s*\b(?:but |and )?(?:only )?(?<!is )(?<!are ){_OPENERS}\b[^.,;(){{}}]*\)?", re.IGNORECASE
    )
    text, conditional = _without(text, inside, _CONDITION_WORDS | {"if", "when", "only", "wherever", "whenever", "as",
                                                                 "long", "case", "assuming", "given", "so", "but"})  # fmt: skip
    if not conditional and leaves:
        conditional = True
    return text, conditional


def _leading(text: str) -> tuple[str, bool]:
    head = re.match(
        rf"\s*(?:please,?\s+)?(?:{_OPENERS}\s+(?:there (?:is|are)|you (?:see|find)|one finds|we have)\s+(?P<there>[^,.;]+?)|"
        rf"(?:{_OPENERS}|should)\s+(?P<what>[^,.;]+?)\s+(?:exists?|is (?:there|present|available)|can be found|"
        r"be (?:there|present|available)))(?:\s+(?:for it|on the table|present|available))?\s*,\s*(?:then\s+)?(?P<rest>.+)$",
        text,
        re.IGNORECASE | re.DOTALL,
    )
    if head is None:
        return text, False
    what, rest = (head.group("there") or head.group("what")).strip(), head.group("rest")
    place = r"\b(?:(in|into|onto|on|to|inside)\s+(?:it|that one|this one|them|(?:that|this|the) (?:area|region))(?=\s*[.!;]|\s*$)|there\b)"
    rest, count = re.subn(place, lambda it: f"{it.group(1) or 'into'} {what}", rest, count=1, flags=re.IGNORECASE)
    return (rest, True) if count else (text, False)


def _without(text: str, pattern: re.Pattern[str], allowed: frozenset[str] | set[str]) -> tuple[str, bool]:
    cut = False

    def drop(found: re.Match[str]) -> str:
        nonlocal cut
        words = re.findall(r"[a-z']+", found.group(0).lower())
        stood = re.search(
            r"where\W+(?:it|they|everything|all)\W+(?:was|were|stood|lay|came|started|had)",
            found.group(0),
            re.IGNORECASE,
        )
        if all(word in allowed for word in words) and not stood:
            cut = True
            return " "
        return found.group(0)

    return pattern.sub(drop, text), cut
