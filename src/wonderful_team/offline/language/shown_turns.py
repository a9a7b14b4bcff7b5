"""A turn that pictures before and after define: its angle is put into the words that ask for it."""

from __future__ import annotations

import re
from collections.abc import Callable

from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.description import Description
from wonderful_team.offline.language.shows import Shows

_TELLING = frozenset(
    """a an the this that these those is are was as to from into by of in on with and or for like it its be been becomes become goes go going changes change changed
    turns turn turned turning rotates rotate rotated rotating rotation spin spun means mean meaning defined define stands stand called call here how what when
    you get one same fixed specific certain some given particular angle amount way word term verb show shows shown example examples instance pair pairs picture
    pictures before after following follows three two several object objects thing things something watch look see learn now then please do does did done
    apply give make under need needs have has must should all every each between results result gives yields twice twist twisted twisting twists such so let
    transforms transform rotations another exactly just likewise kindly there whose difference movement action motion happens happened first""".split()
) - {"twice"}
"""Words of a sentence that shows or names the turn, and asks for nothing else."""
_MANY = re.compile(
    r"\b(?P<what>(?:all|every|each|everything|any)\b(?: of)?(?: the)?(?:\s+[a-z]+(?:\s+and\s+[a-z]+(?=\s+[a-z]))?)*?\s*(?:objects?|things?|items?|ones?|pieces?)\b"
    r"(?:\s+(?:that|which) (?:is|are|have|has)(?: the| a)?(?:\s+[a-z]+){1,6}?(?=\s*(?:$|[.,;:!?]|\b(?:must|should|have to|has to|needs?|is|are|as|by|like|in the same|from|what)\b)))?|"
    r"(?:the\s+)(?:[a-z]+\s+)+?(?:objects?|things?|items?|ones?|pieces?)\b|"
    r"(?:the\s+)?(?:objects?|things?|items?|ones?)\s+(?:that|which)\s+(?:is|are)(?:\s+[a-z]+){1,6}?(?=\s*(?:$|[.,;:!?]|\b(?:must|should|have to|has to|needs?|as|by|like)\b))|"
    r"everything(?:\s+(?:that|which) is)?(?:\s+[a-z]+){1,6}?(?=\s*(?:$|[.,;:!?]|\b(?:must|should|has to|needs?|is|as|by|like)\b)))",
    re.IGNORECASE,
)
"""Phrases that may say what is to be turned."""


def define_turns(text: str, shows: Shows, describe: Callable[[str], Description | None]) -> str:
    """The text without the pictures of a turn, and "rotate … by N degrees" where it asks for that turn.

    Raises:
        NotUnderstoodError: The pictures show no turn, or nothing says what is to be turned.
    """
    befores, afters = shows.names("before"), shows.names("after")
    pairs = [(b, a) for b, a in zip(befores, afters, strict=False) if f"{{{b}}}" in text and f"{{{a}}}" in text]
    if not pairs:
        return text
    names = {name for pair in pairs for name in pair}
    turn = shows.turned_deg(pairs)
    asked = f"by {abs(turn):g} degrees {'clockwise' if turn >= 0 else 'counterclockwise'}"
    verb = _new_verb(text)
    kept, found = [], False
    text = re.sub(
        r",?\s+(?:and\s+)?(then|after that|afterwards|finally)\s+(?=[a-z])", r". \1 ", text, flags=re.IGNORECASE
    )
    for sentence in re.split(r"(?<=[.!?;])\s+", text):
        plain = re.sub(r"->|=>|\u2192", " ", sentence)
        mentions = any(f"{{{name}}}" in sentence for name in names)
        for name in names:
            plain = plain.replace(f"{{{name}}}", " ")
        what, rest = _what_is_turned(plain, describe)
        told = _words(rest) - {verb, f"{verb}s", f"{verb}ed", f"{verb}ing", f"{verb}{verb[-1:]}ed"} <= _TELLING
        if told and "{" not in rest and what and (mentions or _asks(plain, verb)):
            found = True
            kept.append(f"Rotate {what} {asked}.")
        elif told and "{" not in rest and not what:
            continue
        elif mentions:
            unknown = ", ".join(sorted(_words(rest) - _TELLING - {verb})) or "what is to be turned"
            why = "the pictures show a turn, but not everything beside them is understood"
            raise NotUnderstoodError(f"{why}. I do not know: {unknown}.")
        else:
            asked_again = _by_its_new_name(sentence, verb)
            found |= asked_again != sentence
            kept.append(sentence if asked_again == sentence else f"{asked_again} {asked}.")
    if not found:
        named = repr(" ".join(kept)) if kept else "anything to be turned"
        raise NotUnderstoodError(
            f"the pictures show a turn, but it is not said what is to be turned. I do not know: {named}. "
            "I know: rotate, turn, spin or twist all things of a colour, pattern, material or shape."
        )
    return " ".join(kept)


def _by_its_new_name(sentence: str, verb: str) -> str:
    """A sentence that asks for the turn by its new name, with "rotate" for it; any other as it is."""
    bare = sentence.rstrip(" .!;?")
    named = re.sub(rf"\b(?:{verb}|twist)(?:s|ed|ing)?\b", "rotate", bare, flags=re.IGNORECASE) if verb else bare
    return sentence if named == bare or "degrees" in named else named


def _new_verb(text: str) -> str:
    """The verb that is defined, or "" when none is named."""
    found = re.search(
        r"['\"\u201c](?P<quoted>[a-z]+?)(?:ing)?['\"\u201d]|\bto (?P<to>[a-z]+) (?:is|means)\b|\b(?:a|the word) (?P<noun>[a-z]+) (?:turns|goes|changes|is|means|stands)\b|"
        r"\b(?:called|named|calling it)\s+(?:to\s+|a\s+)?(?P<called>[a-z]+?)(?:ing)?\b|^\s*(?P<ing>[a-z]+)ing (?:is|means)\b",
        text,
        re.IGNORECASE,
    )
    if found is None:
        return ""
    return next(word for word in found.groups() if word).lower()


def _what_is_turned(sentence: str, describe: Callable[[str], Description | None]) -> tuple[str, str]:
    """What a sentence says is turned, told apart by its looks, and the sentence without it; "" when it names nothing so."""
    for start in range(len(sentence)):
        found = _MANY.match(sentence, start)
        if found is None or (start and sentence[start - 1].isalpha()):
            continue
        what = describe(found.group("what"))
        if what is not None and (
            what.colours or what.pattern or what.material or what.shape or what.noun not in ("object", "thing")
        ):
            rest = sentence[:start] + " " + sentence[found.end() :]
            words = found.group("what")
            many = words if what.quantity != "one" else f"all {re.sub(r'^the ', '', words, flags=re.IGNORECASE)}"
            return many, rest
    return "", sentence


def _asks(sentence: str, verb: str) -> bool:
    """Whether a sentence asks for a turn without an angle of its own."""
    turning = rf"\b(?:rotat|turn|spin|spun|twist{'|' + verb if verb else ''})"
    return re.search(turning, sentence, re.IGNORECASE) is not None and re.search(r"\bdegrees?\b|\d", sentence) is None


def _words(text: str) -> set[str]:
    return set(re.findall(r"[a-z]+", text.lower()))
