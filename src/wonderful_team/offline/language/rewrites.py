"""Turns of phrase put plainly before words are read: the same meaning in words that the grammar knows.

What they name is kept word for word; whether it is known is for the grammar to say.
"""

from __future__ import annotations

import re

from wonderful_team.offline.language.framing import without_talk

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
    (r"\b(you|we|they)['\u2019]re\b", r"\1 are"),
    (r"\b([a-z]+)['\u2019]s (?=where\b)", r"\1 is "),
    (r"\b(i|you|we|they)['\u2019]ve\b", r"\1 have"),
    (r"\bthem (?:both|all)\b", "them"),
    (r"\ba single (?=[a-z{])", "one "),
    (r"\b(wan|gon)na\b", r"\1t to"),
)
_OFF_PLACE = (
    r"(?:(?:way|much|still|a bit|a little|just) )*(?:too (?:far|close)(?: (?:away|off|apart))?|(?:in|on|at) the wrong (?:place|spot|side|way)|"
    r"the wrong way (?:round|around)|all over the (?:place|table)|out of place|a (?:complete |total )?mess)"
)
"""What is wrong with how things stand, and says nothing that a picture could deny."""
_SPOKEN = (
    (r"\b(?P<what>(?:that|this|those|these) [^,.;!?]+?) (?:over )?(?:here|there)(?= and\b| goes?\b|\s*[,;:])", r"\g<what>"),
    (r"\b(?:i|we) (?:think|guess|reckon|suppose|believe|figure)\b(?: that\b)?", " "),
    (r"\b(?:i|we) (?:would )?(?:like|want|love) to (?:have|see)\b|\b(?:(?:the|your) )?(?:task|job|goal|aim|idea) is to (?:have|see)\b|\bwhat (?:i|we|you) (?:want|need|would like) is\b", "i want"),
    (r"\b(?:(?:i|we|it) )?(?:do(?:es)? not (?:care|mind|matter)|no matter) which(?: (?:ones?|two|three|four))?\b|,?\s*\b(?:any|either)(?: (?:one|two|three|four))? (?:will|would) do\b|,\s*(?:any|either) (?:one|two|three|four|five)\b(?=\s*[,.;!]|\s*$)", " "),
    (r"\b(?:(?:i|we) )?would not mind (?:having|seeing|getting)\b", "i want"),
    (r"\bwhy (?:is|are) not (?P<what>[^?.;{}]+)\?", r"\g<what>."),
    (rf"^\s*(?:it|this|that|they|everything|things|(?:right now )?(?:the|this) (?:table|desk)) (?:is|are) {_OFF_PLACE}\s*[,.;:!]", " "),
    (rf"^\s*(?P<what>(?:the|that|this|those|these) [^,.;:!?{{}}]+?) (?:is|are) {_OFF_PLACE}\s*[,.;:!](?P<rest>[^.;!?]*?)\b(?:it|them)\b", r"\g<rest>\g<what>"),
    (r"^\s*if (?:it|something|a thing|an object) (?P<what>(?:is|has|looks) [^,.;]+), (?P<rest>[^.;]*?)\b(?:it|that)\b", r"\g<rest>everything that \g<what>"),
    (r"^\s*(?:(?:you|do you) )?(?:can )?see (?P<where>(?:the |this )?\{[^{}]+\})\s*[?.:;,](?P<rest>[^.;]*?)\bfrom (?:there|it)\b", r"\g<rest>from \g<where>"),
    (r"\ba (?:bit|little|tad)\b(?=[ ,]+(?:say |about |by )*\d+ ?(?:deg|°))|\b(?:say|roughly|about|approximately)\b,?(?= \d+ ?(?:deg|°))", " "),
    (r"\ban? (?P<what>[a-z ]+?)\b(?P<rest>[^.;]*?), any (?P=what)\b", r"any \g<what>\g<rest>"),
    (r"\ban? (?:(?:good|nice|quick|brief|firm|gentle|thorough|vigorous|hard|proper),? (?:and )?)+(?P<done>shak(?:e|ing)|wip(?:e|ing))\b", r"a \g<done>"),
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
    (rf"(?:^|(?<=[.!?]))\s*(?:out of|from|of|among|amongst|there (?:are|is)) (?:all )?(?:of )?(?:the )?(?:(?:two|both|several)\b )?(?:of )?(?P<what>(?:the |these |those )?(?:[a-z ]+?|\{{[^{{}}]+\}}))\s*[,.;:]\s*(?P<rest>.*?)\bthe\s+(?:one that is\s+|one\s+)?(?:the\s+)?{_WHICH}(?:\s+ones?)?\b", r"\g<rest>the \g<which> of the \g<what>"),
    (rf"^\s*(?:counting|counted|starting) from the (?P<side>left|right|top|bottom)\s*,\s*(?P<rest>.*?\bthe) {_WHICH} (?P<what>[a-z]+)", r"\g<rest> \g<which> \g<what> from the \g<side>"),
    (r"^\s*(?:with the exception of|except for|apart from|aside from|other than|excluding|except) (?P<spared>[^,]+),\s*(?P<rest>[^.!?;]+)", r"\g<rest> except \g<spared>"),
    (r"\bput (?P<a>[^,.;]+?) where (?P<b>[^,.;]+?) (?:is|stands|lies|was)(?: now| right now| currently)?\s*,? and vice[ -]versa\b", r"swap \g<a> and \g<b>"),
    (rf"^[^,.;:{{}}]*? (?P<what>(?:the|all|every|each) [a-z ]+?) by {_PUTTING} (?:it|them|each|every|all)(?: one)?(?: of (?:them|these))?\b", r"put \g<what>"),
    (rf"^[^,.;:{{}}]*?\bup by (?={_PUTTING})", ""),
    (r"\b(?P<more>[a-z]+er) than (?:(?:all|any) (?:of )?)?(?:the )?(?:others?|rest)(?: ones?)?\b", r"\g<more>"),
    (r"\b(?:gets|receives|should (?:get|receive)) (?=the\b|both\b|all\b|every\b|each\b|two\b|\{)", "should hold "),
    (rf"^(?P<second>[^.;]+?),? (?:but )?(?:only )?(?:after|once) (?P<a>(?:the |\{{)[^,;.]+?) (?:is|are|lies|sits|(?:has|have) (?:been|landed))(?: put| placed)? (?P<w>{_PLACE}) (?P<b>[^,;.]+?)\s*[.!]?$", r"put \g<a> \g<w> \g<b>, then \g<second>"),
    (r"\bthe (?P<what>[a-z]+), the (?P<look>[a-z]+(?: [a-z]+)?) one,(?! and\b| the\b)", r"the \g<look> \g<what>"),
    (r"(?:^|(?<=[.;!?]))\s*which(?:ever)? (?:of the two )?(?P<what>[^?]+?) (?P<is>is|are) (?P<where>[^?.]+?)[?,.](?P<rest>[^.;!?]*?)\b(?:it|that one|this one|them|those)\b", r"\g<rest> the \g<what> that \g<is> \g<where>"),
    (r"\b(?:whichever|whatever) (?P<what>\{[^{}]+\}|[a-z]+(?: [a-z]+)?) is (?P<best>(?:the )?[a-z]+(?:est|most))\b", r"the \g<what> that is \g<best>"),
    (rf"\b(?:after|once|when|as soon as) (?!(?:there|it|they|you|such|an?|one|this|that)\b)(?P<a>[^,;.]+?) (?:is|are|lies|sits|was|(?:has|have) (?:been|landed))(?: put| placed| set| moved)? (?P<w>{_PLACE}) (?P<b>[^,;.]+?)\s*,", r"put \g<a> \g<w> \g<b>, then "),
    (r",?\s*\bbefore (?:it )?(?:going|returning|being (?:put|brought|taken)|(?:goes|is (?:put|brought|taken))) (?=back|to (?:its|the) (?:own|original|old))", ", then goes "),
    (r"\b(?P<go>(?:go|belong)(?:es|s)?|should|must|need|are) both\b|\bboth (?=(?:go|belong|should|must|need|are|have)\b)", r"\g<go> "),
    (r"\buse (?P<a>(?:the )?\{[^{}]+\}) as (?:the|a) (?:container|place|target)\b", r"take \g<a>"),
    (r"\buse (?:the|your|its) (?:gripper|arm|hand|tool|suction cup|robot) to\b", " "),
    (r"\bit would be (?:great|good|nice|lovely|helpful) if (?P<what>[^,.;]+?) (?:was|were|is|could be)\b", r"\g<what> should be"),
    (r"\b(?P<put>put|set|place|lay) (?P<it>it|them) (?:down )?on(?:to)? the (?:table|desk|surface)\b", r"\g<put> \g<it> onto a free area"),
)  # fmt: skip

_HAVING = r"(?:(?:you(?: have| ve|'ve)?|having|we have|it is|the robot has)\s+)?"
_AFTER = r"(?:after|once|when|as soon as)"
_VERBISH = r"(?:put|plac|mov|rotat|turn|stack|push|sort|swap|drop|spin|set|bring|brought|rearrang|arrang|follow|sweep|swept|transfer|slid|pick|lift|done|finish)[a-z]*"
_OPENED = (
    (r"\bthe same\s+(?=\{)", "the "),
    (
        r"\bwhat(?:ever)?\s+(?:is(?: shown)?|you (?:can )?see|can be seen|shows)\s+in\s+(?:the (?:picture|image) )?(?=\{)",
        "the object shown in ",
    ),
    (r"\ba (?:little|bit)\b(?= (?:to|further|more|left|right|up|down|towards|closer|away|bit))", "slightly"),
    (r"(^|[.;,]\s*)(?:and )?(?:second|third|fourth|fifth|sixth)(?:ly)?\s*,", r"\1 then "),
    (r"(^|[.;]\s*)(?:step )?\(?\d\s*[.):]\s+(?=[a-z])", r"\1 "),
    (r"(?<![\w.])[-\u2212](?=\d)", "minus "),
)
_THEN_A = (
    rf"^\s*(?:please,?\s+)?before\s+{_HAVING}(?P<second>[^,;.]+),\s*(?P<first>[^;.]+)\.?\s*$",
    rf"^\s*(?P<second>[^;.]+?),?\s+(?:but )?(?:only )?{_AFTER}\s+{_HAVING}(?P<first>{_VERBISH}\b[^;.]+?)\.?\s*$",
    rf"^\s*(?:please,?\s+)?{_AFTER}\s+{_HAVING}(?P<first>{_VERBISH}\b[^,;.]+),\s*(?P<second>[^;]+)$",
    rf"^\s*(?P<first>[^;.]+?),?\s+before\s+{_HAVING}(?P<second>{_VERBISH}\b[^;.]+?)\.?\s*$",
)

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
    (r"\bput in (?=the object beside_)", "put there "),
    (r"\b(?:into|to|in) back to where", "back to where"),
    (r"beside_(above|over|top)\b", "beside_north"),
    (r"beside_(below|under|bottom)\b", "beside_south"),
)  # fmt: skip
_ONE = r"(?:the )?\{[^{}]+\}"
_PAIR = rf"(?P<a>{_ONE})\s*(?:,|and|,\s*and)\s*(?P<b>{_ONE})"
_LIST = rf"(?P<a>{_ONE})\s*,\s*(?P<b>{_ONE})\s*,?\s*and\s+(?:into\s+)?(?P<c>[^.,;]+?)(?=\s*[.,;]|\s+in\s+th|\s*$)"
_ASIDES = (
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
    (r"\b(?:whatever|anything|everything)(?: that)? (?:(?:is|are|has|have) (?:of )?)?(?:with )?(?=the same (?:shape|texture|colou?r|pattern|form|surface)\b)", "everything with "),
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


def written(text: str) -> str:
    """The same instruction as it would be written: no contractions, nothing said in passing or to the listener alone."""
    return _opened(without_talk(_opened(text, _SHORT)), _SPOKEN)


def turned(text: str) -> str:
    """The same instruction without turns of phrase."""
    return _opened(written(text), _TURNS)


def in_order(text: str) -> str:
    """The same instruction with what comes first said first, and "then" between."""
    text = _opened(text, _OPENED)
    for pattern in _THEN_A:
        found = re.match(pattern, text, re.IGNORECASE)
        if found is not None:
            return f"{found.group('first').strip(' .,')}, then {found.group('second').strip()}"
    return text


def put_plainly(text: str) -> str:
    """The same instruction in plainer words."""
    text = _opened(text, (*_ASIDES, *_NEIGHBOUR, *_HOME))
    text = _WHAT_IS.sub(lambda found: f"the {found.group('look')} object", text)
    article = re.compile(r"^\s*(?:a|an|one)\s+", re.IGNORECASE)
    return _MENTION.sub(lambda found: f" {found.group('rest')} {article.sub('the ', found.group('what'))}", text)


def _opened(text: str, table: tuple[tuple[str, str], ...]) -> str:
    for pattern, plain in table:
        text = re.sub(pattern, plain, text, flags=re.IGNORECASE)
    return text
