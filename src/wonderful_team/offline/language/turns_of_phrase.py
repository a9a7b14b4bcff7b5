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
    (r"\b((?:the|this) [a-z]+(?: [a-z]+)?)['\u2019]s (?=(?:too|in|on|all|not|the wrong) )", r"\1 is "),
    (r"['\u2019]em\b", " them"),
    (r"\b(is|are|do|does|would|should|must)n['\u2019]?t\b", r"\1 not"),
    (r"\bgotta\b", "have to"),
    (r"\ba single (?=[a-z{])", "one "),
    (r"\b(wan|gon)na\b", r"\1t to"),
)
_OFF_PLACE = (
    r"(?:(?:way|much|still|a bit|a little|just) )*(?:too (?:far|close)(?: (?:away|off|apart))?|(?:in|on|at) the wrong (?:place|spot|side|way)|"
    r"the wrong way (?:round|around)|all over the (?:place|table)|out of place|a (?:complete |total )?mess)"
)
"""What is wrong with how things stand, and says nothing that a picture could deny."""
_SPOKEN = (
    *_SHORT,
    (r"\b(?:i|we) (?:think|guess|reckon|suppose|believe|figure)\b(?: that\b)?", " "),
    (r"\b(?:i|we) (?:want|need|would (?:like|ask)) you to\b(?! have\b)|\b(?:(?:your|the) )?(?:task|job|goal|aim) is to\b|\bwhat (?:i|we|you) (?:want|need|should do|have to do) is(?: to)?\b", " "),
    (r"\b(?:it |that |i )?would be (?:nice|great|good|happy|glad) if you(?: (?:could|would|can))?\b|\b(?:is it|would it be) possible to\b|\bhelp me(?: to)?\b|\b(?:do me a favou?r|be a dear|be so kind) and\b", " "),
    (r"\b(?:(?:i|we|it) )?(?:do(?:es)? not (?:care|mind|matter)|no matter) which(?: (?:ones?|two|three|four))?\b|\bany(?: one)? will do\b", " "),
    (r"\b(?:(?:i|we) )?would not mind (?:having|seeing|getting)\b", "i want"),
    (r"\b(?:would|do) you mind\b|\bwhy (?:do(?:es)? not you|do not we|not)\b|\bwhy do not you\b", " "),
    (r"\bwhy (?:is|are) not (?P<what>[^?.;{}]+)\?", r"\g<what>."),
    (rf"^\s*(?:it|this|that|they|everything|things|(?:right now )?(?:the|this) (?:table|desk)) (?:is|are) {_OFF_PLACE}\s*[,.;:!]", " "),
    (rf"^\s*(?P<what>(?:the|that|this|those|these) [^,.;:!?{{}}]+?) (?:is|are) {_OFF_PLACE}\s*[,.;:!](?P<rest>[^.;!?]*?)\b(?:it|them)\b", r"\g<rest>\g<what>"),
    (r"^\s*if (?:it|something|a thing|an object) (?P<what>(?:is|has|looks) [^,.;]+), (?P<rest>[^.;]*?)\b(?:it|that)\b", r"\g<rest>everything that \g<what>"),
    (r"^\s*(?:(?:you|do you) )?(?:can )?see (?P<where>(?:the |this )?\{[^{}]+\})\s*[?.:;,](?P<rest>[^.;]*?)\bfrom (?:there|it)\b", r"\g<rest>from \g<where>"),
    (r"\ba (?:bit|little|tad)\b(?=[ ,]+(?:say |about |by )*\d+ ?(?:deg|°))|\b(?:say|roughly|about|approximately)\b,?(?= \d+ ?(?:deg|°))", " "),
    (r"\ban? (?P<what>[a-z ]+?)\b(?P<rest>[^.;]*?), any (?P=what)\b", r"any \g<what>\g<rest>"),
    (r"\b(?P<it>it|them) (?:a)?round\b", r"\g<it>"),
    (r"\b(?P<turned>(?:turn|spin|rotate|twist|swivel)\b[^.,;]*?) (?:a)?round(?= (?:by|through) )", r"\g<turned>"),
    (r"[.;,]?\s*(?:(?:but|and|just|please) )*\bleave (?P<what>the [a-z ]+?) out\b(?: of (?:it|this|that))?", r" except \g<what>"),
    (r",? \b(?:bar|minus) (?=the\b)", " except "),
)  # fmt: skip
"""How things are said in passing, put as they are written."""
_TURNS = (
    (r"\b(left|right)[ -]hand\b(?= side)", r"\1"),
    (r"\blooks? the same as\b", "looks like"),
    (r"\bup in (?=the )", "in "),
    (r"\b(?:slide|scoot) (?P<what>[^.,;]+?) over\b", r"move \g<what>"),
    (r"\bover\b(?=\s*(?:[,.;!?]|$|(?:to|on|onto|and|so|by|near|next|beside|towards) ))", ""),
    (r"(?:\b(?:on|at|to|towards|in) )(?P<what>(?:the |\{)[^,.;:'\u2019]+?)['\u2019]s (?P<side>left|right)(?: (?:hand )?side)?\b", r"to the \g<side> of \g<what>"),
    (rf"^\s*(?:out of|from|of|among|amongst) (?:all )?(?:of )?(?P<what>(?:the |these |those )?[a-z ]+?)\s*,\s*(?P<rest>.*?)\bthe (?:one (?:that is )?)?{_WHICH}(?: ones?)?\b", r"\g<rest>the \g<which> of the \g<what>"),
    (rf"^\s*(?:counting|counted|starting) from the (?P<side>left|right|top|bottom)\s*,\s*(?P<rest>.*?\bthe) {_WHICH} (?P<what>[a-z]+)", r"\g<rest> \g<which> \g<what> from the \g<side>"),
    (r"^\s*(?:with the exception of|except for|apart from|aside from|other than|excluding|except) (?P<spared>[^,]+),\s*(?P<rest>[^.!?;]+)", r"\g<rest> except \g<spared>"),
    (r"\bput (?P<a>[^,.;]+?) where (?P<b>[^,.;]+?) (?:is|stands|lies|was)(?: now| right now| currently)?\s*,? and (?:vice[ -]versa|(?:put )?(?P=b) where (?P=a) (?:is|stands|lies|was)(?: now)?)\b", r"swap \g<a> and \g<b>"),
    (rf"^[^,.;:{{}}]*? (?:the|all|all the) (?P<what>[a-z ]+?) by {_PUTTING} (?:each|every|all)(?: one)?(?: of (?:them|these))?\b", r"put all \g<what>"),
    (r"\bthe (?P<what>[a-z]+), the (?P<look>[a-z]+(?: [a-z]+)?) one,(?! and\b| the\b)", r"the \g<look> \g<what>"),
    (r"(?:^|(?<=[.;!?]))\s*which(?:ever)? (?:of the two )?(?P<what>[^?]+?) (?P<is>is|are) (?P<where>[^?.]+?)[?,.](?P<rest>[^.;!?]*?)\b(?:it|that one|this one|them|those)\b", r"\g<rest> the \g<what> that \g<is> \g<where>"),
    (r"\b(?:whichever|whatever) (?P<what>\{[^{}]+\}|[a-z]+(?: [a-z]+)?) is (?P<best>(?:the )?[a-z]+(?:est|most))\b", r"the \g<what> that is \g<best>"),
    (rf"\b(?:after|once|when|as soon as) (?!(?:there|it|they|you|such|an?|one|this|that)\b)(?P<a>[^,;.]+?) (?:is|are|lies|sits|was|(?:has|have) (?:been|landed))(?: put| placed| set| moved)? (?P<w>{_PLACE}) (?P<b>[^,;.]+?)\s*,", r"put \g<a> \g<w> \g<b>, then "),
    (r",?\s*\bbefore (?:it )?(?:going|returning|being (?:put|brought|taken)|(?:goes|is (?:put|brought|taken))) (?=back|to (?:its|the) (?:own|original|old))", ", then goes "),
    (r"\b(?P<go>(?:go|belong)(?:es|s)?|should|must|need|are) both\b|\bboth (?=(?:go|belong|should|must|need|are|have)\b)", r"\g<go> "),
    (r"\buse (?P<a>(?:the )?\{[^{}]+\}) as (?:the|a) (?:container|place|target)\b", r"take \g<a>"),
    (r"\buse (?:the|your|its) (?:gripper|arm|hand|tool|suction cup|robot) to\b", " "),
    (r"\bit would be (?:great|good|nice|lovely|helpful) if (?P<what>[^,.;]+?) (?:was|were|is|could be)\b", r"\g<what> should be"),
    (r"\b(?:i|we) (?:would )?(?:like|want|love) to (?:have|see)\b", "i want"),
    (r"\b(?P<put>put|set|place|lay) (?P<it>it|them) (?:down )?on(?:to)? the (?:table|desk|surface)\b", r"\g<put> \g<it> onto a free area"),
)  # fmt: skip


def turned(text: str) -> str:
    """The same instruction without these turns of phrase."""
    return _opened(written(text), _TURNS)


def written(text: str) -> str:
    """The same instruction as it would be written: no contractions, nothing said in passing."""
    return _opened(text, _SPOKEN)


def _opened(text: str, table: tuple[tuple[str, str], ...]) -> str:
    for pattern, plain in table:
        text = re.sub(pattern, plain, text, flags=re.IGNORECASE)
    return text
