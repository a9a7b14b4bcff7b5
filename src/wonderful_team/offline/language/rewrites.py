"""Turns of phrase put plainly before words are read: the same meaning in words that the grammar knows."""

from __future__ import annotations

import re

_SIDE = r"(?P<side>north|south|east|west|left|right|top|bottom|above|below|over|under)"
_PAST = (
    r"(?:(?:that|which|who)\s+)?(?:(?:was|stood|lay|sat|had been|used to be|used to stand|used to lie|had stood|originally lay|originally stood|originally was|was standing|was lying)\s+)"
    r"(?:(?:previously|formerly|originally|initially|before|at first|once|just|directly|right)\s+)*"
)
_BEFORE = (
    r"(?:\s+(?:before|at first|at the start|originally|previously|initially|in the beginning|earlier|beforehand))?"
)
_WHO = r"(?P<who>it|\{[^{}]+\})"
_NEIGHBOUR = (
    (rf"\b(?P<thing>(?:the\s+)?(?:object|thing|item|one)|whatever|what)\s+{_PAST}(?:to\s+|on\s+|at\s+|in\s+)?(?:the\s+)?{_SIDE}(?:\s+side)?\s*(?:of\s+)?{_WHO}{_BEFORE}",
     r"the object beside_\g<side> of \g<who>"),
    (rf"\b(?P<thing>(?:the\s+)?(?:object|thing|item|one)|whatever|what)\s+{_PAST}(?:to|on|at|in)\s+its\s+{_SIDE}(?:\s+(?:hand\s+)?side)?{_BEFORE}",
     r"the object beside_\g<side>"),
    (rf"\b(?P<thing>(?:the\s+)?(?:object|thing|item|one)|whatever|what)\s+(?:formerly|previously|originally)\s+(?:to|on|at|in)\s+its\s+{_SIDE}(?:\s+side)?",
     r"the object beside_\g<side>"),
    (rf"\b(?:(?:its|the)\s+)?(?:(?:old|former|previous|original)\s+)*{_SIDE}(?:ern|ward)?(?:\s+hand)?\s+neighbou?r\b", r"the object beside_\g<side>"),
    (rf"\b(?:its|the)\s+(?:(?:old|former|previous|original)\s+)*neighbou?r\s+(?:to|in|on|at|from|towards)\s+(?:the\s+)?{_SIDE}(?:\s+side)?\b", r"the object beside_\g<side>"),
)  # fmt: skip
"""What stood next to something on a side of it; without a name, next to what was last spoken of."""
_PLACES_BEFORE = r"where (?:it|they|everything|each(?: of them)?) (?:came from|started(?: out)?|was(?: before| at first| originally)?|were(?: before| at first)?|had been|stood|began)"
_HOME = (
    (r"\b(?:to|into|in|back (?:to|into|in))?\s*(?:the|its|that)\s+(?:(?:original|own|first|old|initial)\s+)?(?:container|bowl|box|place|spot|holder)\s+(?:that\s+|which\s+)?"
     r"(?:it|they) (?:came from|started in|was in(?: at first| before| originally)?|was taken from|came out of|stood in|lay in)\b", " back to where it was"),
    (rf"\b(?:to|into|in|back (?:to|into|in))?\s*(?:the|its) (?:container|bowl|box|place|spot) {_PLACES_BEFORE}", " back to where it was"),
    (r"\b(?:back )?(?:to|into|in) its (?:very )?(?:first|own|old|original|former|initial|starting|home) (?:container|bowl|box|place|spot|position|holder)(?: again)?\b", "back to where it was"),
    (r"\b(?:bring|take|move|carry|send|put) (?P<it>it|them) (?:back )?home\b", r"put \g<it> back to where it was"),
    (r"\bback home\b|\bback (?:in)?to its container\b|\bback in its container\b", "back to where it was"),
    (r"\breturns? back to where it was\b", "goes back to where it was"),
)  # fmt: skip
_ONE = r"(?:the )?\{[^{}]+\}"
_PAIR = rf"(?P<a>{_ONE})\s*(?:,|and|,\s*and)\s*(?P<b>{_ONE})"
_LIST = rf"(?P<a>{_ONE})\s*,\s*(?P<b>{_ONE})\s*,?\s*and\s+(?:into\s+)?(?P<c>[^.,;]+?)(?=\s*[.,;]|\s+in\s+th|\s*$)"
_ASIDES = (
    (r"\b(?:when|once|as soon as) you(?:'re| are| have| re)? (?:are )?(?:done|finished|ready|through)\b", " "),
    (r"\bwithout (?:shifting|displacing|relocating|sliding|dragging) (?:it|them)\b", " "),
    (r"\bwithout (?:moving|shifting) (?:it|them) (?:anywhere else|away|elsewhere)\b", " "),
    (rf"\bin (?:this|that) order\s*,?\s*(?P<head>[^.;]*?)\b(?P<w>into|in|to) {_LIST}", r"\g<head> into \g<a>, then into \g<b>, then into \g<c>"),
    (r"(?P<a>\{[^{}]+\}|\bit|\bthere) (?:second|third|last|secondly|lastly)(?=\s*[.,;]|\s*$)", r"\g<a>"),
    (r"\bin (?:this|that|the given) order\b", " "),
    (r"\bchange the (?:heading|orientation|direction|facing) of\b", "rotate"),
    (r"\b(?:is|are) how far (?P<what>[^.,;:]+?) (?:has|have|needs?|is|are) to be (?:turned|rotated|spun)\b", r"is the turn for \g<what>"),
    (r"\b(?P<n>half|a third|a quarter|two thirds|three quarters|a sixth|an eighth) of (?:a|one) (?:full |whole |complete )?(?:circle|revolution)\b", r"\g<n> of a turn"),
    (r"\bthe (?:first|former) (?P<where>into|in|inside|onto|on) the (?:second|latter)\b", r"the former \g<where> the latter"),
    (r"^\s*look at (?P<a>(?:the |this )?\{[^{}]+\}) and (?:at )?(?P<b>(?:the |this )?\{[^{}]+\})\s*[:.;,]", r"you see \g<a> and \g<b>."),
    (r"\b(?P<n>two|three|four|five|six) (?:pieces |items |objects |copies |of )?of (?:the |these |those |this )?(?=\{|[a-z]+ (?:blocks|objects|things))", r"\g<n> "),
    (r"\ba (?:couple|pair) of (?:the |these |those )?(?=\{|[a-z])", "two "),
    (r"^\s*(?:start|begin) by (?=[a-z]+ing\b)", " "),
    (r"^\s*with (?P<a>(?:the )?\{[^{}]+\})\s*[:;,]\s*(?=into\b|in\b)", r"put \g<a> "),
    (r"(?P<n>\bdegrees|°) (?:further|more)\b", r"\g<n>"),
    (r"\bfrom there\s*,?\s+(?P<w>(?:in)?to)\b", r"then \g<w>"),
    (rf"(?P<x>{_ONE}) (?:(?:should|must|shall|has to|is to|needs to|will) )?(?:visits?|(?:go(?:es)?|pass(?:es)?) through) (?P<a>{_ONE})\s*(?:,\s*then|and then|,\s*and|and|,|then)\s*(?P<b>{_ONE})", r"put \g<x> into \g<a>, then into \g<b>"),
    (r"\b(?:is|are) (?:covered|decorated|painted|patterned|textured|surfaced) like\b|\b(?:covered|decorated|patterned|textured) like\b", "with the same texture as"),
    (r"\b(?:whatever|anything) (?=with the same)", "everything "),
    (r"\b(?:whatever|anything) (?=(?:has|have|shares|bears|matches|looks like)\b)", "everything that "),
    (r",\s*(?:and\s+)?(?:then\s+)?on to (?=(?:the )?\{)", ", then into "),
    (r"\b(?:that|which) (?P<a>\{[^{}]+\}) (?:shows|depicts|pictures)\b", r"in \g<a>"),
    (r"\bfrom (?:its|the) (?:own |original |old )?(?:container|place|spot|position) (?=(?:in)?to (?:the )?\{)", " "),
    (r"\b(?:and )?(?:do|repeat) (?:exactly )?the same (?:thing )?(?:with|for|to)\b", "and put there"),
)  # fmt: skip
_MENTION = re.compile(
    r"(?:^|(?<=[.;:!?]))\s*(?:(?:in|on|from|at)\s+(?:the (?:picture|image)\s+)?\{[^{}]*\}\s*,?\s*)?(?:(?:you|we|one|i) (?:can )?(?:see|find|have|notice)s?|there (?:is|are)|here (?:is|are)|\{[^{}]*\} (?:contains|shows|has|holds|depicts|"
    r"pictures))\s+(?P<what>(?:a|an|the|one)\s+(?!(?:[a-z{} ]|,)*\band (?:a|an|the|one)\b)[^.;:,!?]+?)(?:\s+(?:in|on|from) \{[^{}]*\})?\s*[.;:,!]\s*(?:(?:please|now|then|and)\s+)*(?P<rest>[^.;!?]*?)\b(?P<it>it|this one|that one|this object|that object)\b",
    re.IGNORECASE,
)
"""A sentence that only names a thing which the next one calls "it"."""
_WHAT_IS = re.compile(r"\b(?:what|whatever|the one) (?:is|looks) (?P<look>[a-z]+(?: [a-z]+){0,5}?)(?=\s+in\s+\{|\s+(?:into|onto|inside|in|on|and|goes|should|must)\b|\s*[.,;!?]|\s*$)", re.IGNORECASE)  # fmt: skip


def put_plainly(text: str) -> str:
    """The same instruction in plainer words."""
    for pattern, plain in (*_ASIDES, *_NEIGHBOUR, *_HOME):
        text = re.sub(pattern, plain, text, flags=re.IGNORECASE)
    text = re.sub(r"\bput in (?=the object beside_)", "put there ", text, flags=re.IGNORECASE)
    text = re.sub(r"\b(?:into|to|in) back to where", "back to where", text)
    text = re.sub(r"beside_(above|over|top)\b", "beside_north", text)
    text = re.sub(r"beside_(below|under|bottom)\b", "beside_south", text)
    text = _WHAT_IS.sub(lambda found: f"the {found.group('look')} object", text)
    return _MENTION.sub(lambda found: f" {found.group('rest')} {_definite(found.group('what'))}", text)


def _definite(words: str) -> str:
    return re.sub(r"^(?:a|an|one)\s+", "the ", words.strip(), flags=re.IGNORECASE)
