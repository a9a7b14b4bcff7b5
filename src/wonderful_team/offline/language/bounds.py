"""What a thing must keep off while it is pushed: "without touching the line", "without exceeding the line"."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from wonderful_team.offline.description import Description

_PUSH = (
    r"(?:sweep|swept|sweeping|push|pushed|pushing|slide|sliding|shove|shoving|brush|brushing|nudge|drag|wipe|wiping)"
)
_TOOL = r"(?:with|using|by means of)\s+(?:the|a|your|its)\s+(?:tool|spatula|sweeper|brush|pusher)"
_THEM = r"(?:them|it|they|the (?:blocks|objects|things)|any of (?:them|these)|these)"
_NEG = (
    rf"(?:without(?:\s+(?:ever|any|making|any|letting|having))*|(?:so\s+as\s+)?(?:do\s+not|don't|never|not|{_THEM}\s+(?:must|may|should|can|shall)\s*(?:not|never)|"
    rf"(?:nothing|none(?:\s+of\s+(?:them|these))?|no\s+[a-z]+)\s+(?:may|must|should|can|is\s+(?:allowed\s+)?to)|keep(?:ing)?\s+{_THEM}\s+from|(?:tak(?:e|ing)|with)\s+care\s+not\s+to|"
    rf"mak(?:e|ing)\s+sure\s+(?:that\s+)?(?:not\s+to|{_THEM}\s+(?:do\s+not|don't|never)))(?:\s+(?:ever|let|letting|allow|to))*(?:\s+{_THEM})?(?:\s+to)?)"
)
_LEAD = r"(?:\s*[,;:.]?\s*(?:(?:and|but|while|so\s+that|also)\s+)*(?:please\s+)?)"
_TOUCH = (
    r"(?:touch(?:ing)?|hit(?:ting)?|bump(?:ing)?\s+(?:in)?to|(?:com(?:e|ing)\s+into\s+|mak(?:e|ing)\s+)?contact(?:ing)?(?:\s+with)?|collid(?:e|ing)\s+with|"
    r"brush(?:ing)?\s+against|run(?:ning)?\s+into|mov(?:e|ing)\s+over|disturb(?:ing)?)"
)
_EXCEED = (
    r"(?:exceed(?:ing)?|cross(?:ing)?|overstep(?:ping)?|surpass(?:ing)?|overshoot(?:ing)?|pass(?:ing)?(?:\s+(?:over|beyond))?|"
    r"(?:(?:go(?:ing)?|mov(?:e|ing)|get(?:ting)?|push(?:ing)?|reach(?:ing)?|sweep(?:ing)?)\s+(?:them\s+|it\s+)?)?(?:past|beyond|over|across|further\s+than|farther\s+than))"
)
_NAME = r"(?:(?:the|a|any|this)\s+)?(?:(?:line|bar|border|edge|barrier|object|thing)\s+)?(?:shown\s+in\s+)?"
_WHAT = rf"\s+(?P<what>{_NAME}\{{[^{{}}]+\}}|(?:the\s+|a\s+|any\s+|this\s+)?[a-z -]+?(?=\s*[.,;!?]|\s*$|\s+(?:and|then|while)\b))"
_X = rf"(?P<what>{_NAME}\{{[^{{}}]+\}}|the\s+[a-z -]+?)"
_BE = r"\s+(?:(?:must|may|should|can|shall|is|are)\s+(?:not|never)\s+(?:to\s+)?be|is\s+never\s+to\s+be)\s+"
_MUST_STAY = r"\s+(?:must\s+|should\s+|has\s+to\s+|is\s+to\s+)?(?:stay|stays|remain|remains|be\s+left|left|kept|be\s+kept)\s+(?:untouched|alone|free)"
_KEEP = r"(?:(?:stay|keep|steer|remain)(?:ing)?\s+(?:well\s+)?(?:clear|away|off)(?:\s+(?:of|from))?|(?:watch|look)(?:ing)?\s+out\s+for|beware\s+of|avoid(?:ing)?(?:\s+(?:touching|hitting|contact\s+with))?)"
_SHORT = r"(?:stay|stop|keep|remain)(?:s|p?ing)?\s+(?:short\s+of|before|behind|in\s+front\s+of|(?:on\s+)?this\s+side\s+of|within)"
_FORBIDDEN = (
    r"\s+(?:is|are)\s+(?:(?:not|never)\s+(?:allowed|permitted|ok|okay|acceptable)|forbidden|prohibited|off\s+limits)"
)
_CLEAR_OF = (rf"{_LEAD}{_KEEP}{_WHAT}",)
"""What is said of a way along the table: whatever is asked for with it is a push."""
_OFF = (
    rf"{_LEAD}{_NEG}\s+{_TOUCH}{_WHAT}",
    rf"{_LEAD}{_TOUCH}\s+{_X}{_FORBIDDEN}",
    *_CLEAR_OF,
    rf"{_LEAD}(?:(?:go|mov|steer|pass)(?:e|ing)?\s+|(?:taking|take)\s+(?:a\s+)?(?:way|path|route)\s+)?(?<!the )(?<!a )(?:a)?round{_WHAT}",
    rf"{_LEAD}{_X}{_BE}(?:touched|hit|bumped\s+into|contacted|moved|disturbed)",
    rf"{_LEAD}{_X}{_MUST_STAY}",
    rf"{_LEAD}(?:leave|leaving|keep|keeping)\s+{_X}\s+(?:untouched|alone)",
)
_LIMIT = (
    rf"{_LEAD}{_NEG}\s+{_EXCEED}{_WHAT}",
    rf"{_LEAD}{_X}{_BE}(?:exceeded|crossed|passed|overstepped|surpassed)",
    rf"{_LEAD}{_X}\s+(?:is|marks)\s+(?:the|our|your)\s+(?:limit|border|boundary|end|line)",
    rf"{_LEAD}{_EXCEED}\s+{_X}{_FORBIDDEN}",
    rf"{_LEAD}{_SHORT}{_WHAT}",
)
_AGAIN = rf"{_LEAD}{_NEG}\s+(?:{_TOUCH}|{_EXCEED})\s+(?:it|that|this)\b"


@dataclass(frozen=True)
class Bounds:
    """An instruction without its bounds, and the bounds.

    Attributes:
        off: What a pushed thing must not touch on its way nor at its end.
        limit: A line that it must not pass.
        pushes: Whether what is asked for is a push.
    """

    text: str
    off: Description | None = None
    limit: Description | None = None
    pushes: bool = False


def set_bounds(text: str, describe: Callable[[str], Description | None]) -> Bounds:
    """Part an instruction to push from what must be kept off; any other text comes back as it is."""
    pushes = re.search(rf"\b{_PUSH}\b|\b{_TOOL}", text, re.IGNORECASE) is not None
    plain, limit = _taken(text, _LIMIT, describe)
    text_without, off = _taken(plain, _OFF if pushes or limit is not None else _CLEAR_OF, describe)
    if not pushes and limit is None and off is None:
        return Bounds(text)
    text = text_without
    if limit is not None or off is not None:
        text = re.sub(_AGAIN, " ", text, flags=re.IGNORECASE)
    return Bounds(_plainly(text), off, limit, pushes=True)


def _plainly(text: str) -> str:
    """An instruction to push, in words that the grammar knows."""
    for pattern, plain in _PLAIN:
        text = re.sub(pattern, plain, text, flags=re.IGNORECASE)
    return text


_PLAIN = (
    (rf"\b{_TOOL}\b\s*,?", " "),
    (rf"\bby\s+{_PUSH}(?:\s+(?:it|them))?\b", " "),
    (rf"[;,.]\s*(?:and\s+)?{_PUSH}\s+(?:it|them)\s*(?=[.,;!]|$)", " "),
    (rf"^\s*[,;:.]?\s*(?:while|when|as)\s+(?:you\s+)?(?=(?:are\s+)?{_PUSH})", " "),
    (r"\b(?P<verb>[a-z]+)\s+(?:the\s+)?(?P<what>\{[^{}]+\})(?P<rest>[^.;]*?),\s*all\s+of\s+them\b", r"\g<verb> all \g<what>\g<rest>"),
)  # fmt: skip


def _taken(
    text: str, patterns: tuple[str, ...], describe: Callable[[str], Description | None]
) -> tuple[str, Description | None]:
    for pattern in patterns:
        found = re.search(pattern, text, re.IGNORECASE)
        words = "" if found is None else re.sub(rf"^\s*{_NAME}(?=\{{)", "", found.group("what"), flags=re.IGNORECASE)
        what = describe(words) if found is not None else None
        if found is not None and what is not None and what.name != "it" and not _other(found.group("what")):
            return text[: found.start()] + " " + text[found.end() :].lstrip(" ,:;."), what
    return text, None


def _other(words: str) -> bool:
    """The words "any other block" name no single thing; nothing else may ever be touched anyway."""
    return re.search(r"\b(?:other|others|else|rest)\b", words, re.IGNORECASE) is not None
