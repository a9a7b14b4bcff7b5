"""Turns of phrase about named things, put as the grammar knows them: fronted choices, appositions, "by placing each".

What they name is kept word for word; whether it is known is for the grammar to say.
"""

from __future__ import annotations

import re

_PUTTING = r"(?:putting|placing|moving|dropping|setting|laying|bringing)"
_WHICH = r"(?P<which>[a-z]+(?:st|est|most)|last|first|second|third|fourth|fifth|(?:furthest|farthest) (?:to the )?(?:left|right))"
_PLACE = r"(?:in|on|into|onto|inside|next to|beside|near|left of|right of|above|below)"
_SHORT = (
    (r"\bi['\u2019]d\b", "i would"),
    (r"\bi['\u2019]ll\b", "i will"),
    (r"\b(that|there|it|what|who|which|here|where)['\u2019]s\b", r"\1 is"),
)
_TURNS = (
    *_SHORT,
    (r"\b(left|right)[ -]hand\b(?= side)", r"\1"),
    (r"\bover (?=(?:to|on|onto) the (?:left|right|other)\b|and\b)", ""),
    (r"(?:\b(?:on|at|to|towards|in) )(?P<what>(?:the |\{)[^,.;:'\u2019]+?)['\u2019]s (?P<side>left|right)(?: (?:hand )?side)?\b", r"to the \g<side> of \g<what>"),
    (rf"^\s*(?:out of|from|of|among|amongst) (?:all )?(?:of )?(?P<what>(?:the |these |those )?[a-z ]+?)\s*,\s*(?P<rest>.*?)\bthe (?:one (?:that is )?)?{_WHICH}(?: ones?)?\b", r"\g<rest>the \g<which> of the \g<what>"),
    (rf"^\s*(?:counting|counted|starting) from the (?P<side>left|right|top|bottom)\s*,\s*(?P<rest>.*?\bthe) {_WHICH} (?P<what>[a-z]+)", r"\g<rest> \g<which> \g<what> from the \g<side>"),
    (r"^\s*(?:with the exception of|except for|apart from|aside from|other than|excluding|except) (?P<spared>[^,]+),\s*(?P<rest>[^.!?;]+)", r"\g<rest> except \g<spared>"),
    (r"\bput (?P<a>[^,.;]+?) where (?P<b>[^,.;]+?) (?:is|stands|lies|was)(?: now| right now| currently)?\s*,? and vice[ -]versa\b", r"swap \g<a> and \g<b>"),
    (rf"^[^,.;:{{}}]*? (?:the|all|all the) (?P<what>[a-z ]+?) by {_PUTTING} (?:each|every|all)(?: one)?(?: of (?:them|these))?\b", r"put all \g<what>"),
    (r"\bthe (?P<what>[a-z]+), the (?P<look>[a-z]+(?: [a-z]+)?) one,(?! and\b| the\b)", r"the \g<look> \g<what>"),
    (r"(?:^|(?<=[.;!?]))\s*which (?P<what>[^?{}]+?) (?P<is>is|are) (?P<where>[^?]+)\?(?P<rest>[^.;!?]*?)\b(?:it|that one|this one|them|those)\b", r"\g<rest> the \g<what> that \g<is> \g<where>"),
    (rf"\b(?:after|once|when|as soon as) (?!(?:there|it|they|you|such|an?|one|this|that)\b)(?P<a>[^,;.]+?) (?:is|are|lies|sits|was|(?:has|have) (?:been|landed))(?: put| placed| set| moved)? (?P<w>{_PLACE}) (?P<b>[^,;.]+?)\s*,", r"put \g<a> \g<w> \g<b>, then "),
    (r",?\s*\bbefore (?:it )?(?:going|returning|being (?:put|brought|taken)|(?:goes|is (?:put|brought|taken))) (?=back|to (?:its|the) (?:own|original|old))", ", then goes "),
    (r"\b(?P<go>(?:go|belong)(?:es|s)?|should|must|need|are) both\b|\bboth (?=(?:go|belong|should|must|need|are|have)\b)", r"\g<go> "),
    (r"\buse (?P<a>(?:the )?\{[^{}]+\}) as (?:the|a) (?:container|place|target)\b", r"take \g<a>"),
    (r"\buse (?:the|your|its) (?:gripper|arm|hand|tool|suction cup|robot) to\b", " "),
    (r"\bit would be (?:great|good|nice|lovely|helpful) if (?P<what>[^,.;]+?) (?:was|were|is|could be)\b", r"\g<what> should be"),
    (r"\b(?:i|we) (?:would )?(?:like|want|love) to have\b", "i want"),
    (r"\b(?P<put>put|set|place|lay) (?P<it>it|them) (?:down )?on(?:to)? the (?:table|desk|surface)\b", r"\g<put> \g<it> onto a free area"),
)  # fmt: skip


def turned(text: str) -> str:
    """The same instruction without these turns of phrase."""
    for pattern, plain in _TURNS:
        text = re.sub(pattern, plain, text, flags=re.IGNORECASE)
    return text


def in_full(text: str) -> str:
    """The same instruction without contractions."""
    for pattern, plain in _SHORT:
        text = re.sub(pattern, plain, text, flags=re.IGNORECASE)
    return text
