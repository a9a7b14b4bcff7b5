"""New words that pictures define: nouns by a picture each, adjectives by pairs of things, verbs by pairs before and after.

The words are replaced by what they mean before the instruction is read.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from wonderful_team.contracts import ShownSlot
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.models.offline.answers.turning import common_turn_deg
from wonderful_team.models.offline.language.vocabulary import WORDS
from wonderful_team.models.offline.vision import Example, NotSeen, see, study_example

_WORD = r"['\"\u201c\u201d]?(?P<word>[a-z]+)['\"\u201c\u201d]?"
_SLOT = r"(?:the |a |an )?(?:(?:thing|object|one) (?:shown )?in )?\{(?P<slot>[^{}]+)\}"
_NOUNS = (
    rf"\b(?:this|that|here|it)(?: is|'s| we call| you see)(?: called)? (?:a |an |the )?{_WORD}\s*[:,]?\s*{_SLOT}",
    rf"{_SLOT}\s+(?:is|shows|depicts)(?: what (?:is|we call|you call))?(?: called| named| known as)?\s+(?:a|an)\s+{_WORD}(?! than)",
    rf"{_SLOT}\s+(?:is|gets)\s+(?:called|named|known as|referred to as)\s+(?:a |an |the )?{_WORD}",
    rf"\b(?:we )?call {_SLOT} (?:a|an)\s+{_WORD}",
    rf"\b(?:a|an|the word)\s+{_WORD}\s+(?:is|means|stands for|refers to|denotes|looks like)\s+(?:this|that)?\s*[:,]?\s*{_SLOT}",
    rf"\b(?:by|with) (?:a|an) {_WORD} (?:we|i) mean {_SLOT}",
)
_MORE = re.compile(
    rf"\{{(?P<more>[^{{}}]+)\}}\s+(?:is|looks|appears|counts as)\s+(?P<less_word>less\s+|more\s+)?{_WORD}\s+(?:than|compared (?:to|with))\s+\{{(?P<less>[^{{}}]+)\}}",
    re.IGNORECASE,
)
_OPPOSITE = {"tallest": "shortest", "shortest": "tallest", "darkest": "lightest", "lightest": "darkest", "largest": "smallest",
             "smallest": "largest"}  # fmt: skip
_FEW = 0.06
"""Least mean difference of a measure, as a share of it, that defines an adjective."""


def define_words(text: str, slots: Mapping[str, ShownSlot]) -> str:
    """The instruction with its definitions taken out and the new words replaced by known ones.

    Raises:
        NotUnderstoodError: The pictures do not show what a new word means.
    """
    text = _verbs(text, slots)
    text = _adjectives(text, slots)
    return _nouns(text, slots)


def _nouns(text: str, slots: Mapping[str, ShownSlot]) -> str:
    meant: dict[str, str] = {}
    for pattern in _NOUNS:
        for found in list(re.finditer(pattern, text, re.IGNORECASE)):
            word, name = found.group("word").lower(), found.group("slot")
            if name in slots and slots[name].kind == "object" and word not in WORDS:
                meant[word] = name
        text = re.sub(
            pattern,
            lambda found: " " if found.group("word").lower() in meant else found.group(0),
            text,
            flags=re.IGNORECASE,
        )
    for word, name in meant.items():
        text = re.sub(rf"\b(?:an|a|the)?\s*\b{word}(?:s|es)?\b", f" the {{{name}}}", text, flags=re.IGNORECASE)
    return (
        re.sub(r"(?:\s*[.;,](?:\s*and\b)?)+(?=\s*[.;,])|^\s*(?:and\b|[.;,\s])+", " ", text).strip() if meant else text
    )


def _adjectives(text: str, slots: Mapping[str, ShownSlot]) -> str:
    pairs: dict[str, list[tuple[str, str]]] = {}
    for found in _MORE.finditer(text):
        more, less = found.group("more"), found.group("less")
        if (found.group("less_word") or "").strip().lower() == "less":
            more, less = less, more
        if more in slots and less in slots:
            pairs.setdefault(found.group("word").lower(), []).append((more, less))
    if not pairs:
        return text
    text = _MORE.sub(
        lambda found: " " if found.group("more") in slots and found.group("less") in slots else found.group(0), text
    )
    text = re.sub(r"(?:^|(?<=[.;!?]))(?:\s|[.,;]|\band\b)*[.,;](?=\s)", " ", text)
    for word, shown in pairs.items():
        meaning = _compared([(slots[more], slots[less]) for more, less in shown], word)
        opposite = _OPPOSITE[meaning]
        text = re.sub(rf"\b(?:less|least|not so|un)\s+{word}\b", f"{opposite} ", text, flags=re.IGNORECASE)
        text = re.sub(rf"\b(?:more\s+|most\s+)?{word}\b", f"{meaning} ", text, flags=re.IGNORECASE)
    return text.strip(" .;,")


def _compared(pairs: list[tuple[ShownSlot, ShownSlot]], word: str) -> str:
    """The superlative that tells the first of each pair from the second: by height, lightness or size."""
    gaps: dict[str, list[float]] = {"tallest": [], "lightest": [], "largest": []}
    for more, less in pairs:
        one, other = _measures(more), _measures(less)
        for name in gaps:
            gaps[name].append(float(np.log(one[name] / other[name])))
    means = {name: float(np.mean(values)) for name, values in gaps.items()}
    name = max(means, key=lambda key: abs(means[key]))
    if name == "tallest" and abs(means["largest"]) > 0.7 * abs(means["tallest"]):
        name = "largest"
    agree = all(np.sign(value) == np.sign(means[name]) for value in gaps[name])
    if abs(means[name]) < _FEW or not agree:
        told = ", ".join(f"{key} {value:+.2f}" for key, value in means.items())
        raise NotUnderstoodError(f"I do not know: {word}. The pictures do not show what it means (log ratios: {told}).")
    return name if means[name] > 0 else _OPPOSITE[name]


def _measures(slot: ShownSlot) -> dict[str, float]:
    """How tall, light and large the thing of a picture shows itself; the height from the other camera when there is one."""
    try:
        example = study_example(slot.pictures[0])
        side = study_example(slot.pictures[-1])
    except NotSeen as error:
        raise NotUnderstoodError(
            f"the picture {{{slot.name}}} shows nothing that could define a word: {error}"
        ) from error
    return {
        "tallest": side.box.height if len(slot.pictures) > 1 else 1.0,
        "lightest": _lightness(example) + 1.0,
        "largest": float(np.sqrt(example.area_view_px)),
    }


def _lightness(example: Example) -> float:
    shares = sum(colour.share for colour in example.look.colours)
    return sum(colour.lab[0] * colour.share for colour in example.look.colours) / max(shares, 1e-6)


def _verbs(text: str, slots: Mapping[str, ShownSlot]) -> str:
    """Pairs before and after define a turn: its angle is put into words."""
    befores = _ordered(slots, "before")
    afters = _ordered(slots, "after")
    pairs = [
        (b, a) for b, a in zip(befores, afters, strict=False) if f"{{{b.name}}}" in text and f"{{{a.name}}}" in text
    ]
    if not pairs:
        return text
    turn = _turn_shown(pairs)
    names = {slot.name for pair in pairs for slot in pair}
    sentences = [part.strip() for part in re.split(r"(?<=[.!?;])\s+|:\s+", text) if part.strip(" .;:!?")]
    kept, verb = [], ""
    for sentence in sentences:
        defined = re.search(
            r"['\"\u201c]?\b(?P<verb>[a-z]+)\b['\"\u201d]?\s+(?:something |an object |a thing )?(?:is|means|denotes|stands for|refers to)\b.*\b(?:rotat|turn|spin|angle|defined|mean)",
            sentence,
            re.IGNORECASE,
        ) or re.search(
            r"\bto ['\"\u201c]?(?P<verb>[a-z]+)['\"\u201d]?\b[^{}]*\b(?:is|means)\b", sentence, re.IGNORECASE
        )
        if defined is not None and not _names_in(sentence, names):
            verb = defined.group("verb").lower()
        elif not _names_in(sentence, names) and not re.fullmatch(
            r"(?:for )?(?:examples?|instance|here are (?:some )?examples?|see)\W*(?:are)?\W*", sentence.lower()
        ):
            kept.append(sentence)
        elif _names_in(sentence, names) and (
            found := re.search(
                r"\b(?:this|that|which)\s+is\s+(?:called|named)\s+(?:to\s+)?['\"]?(?P<verb>[a-z]+)", sentence
            )
        ):
            verb = found.group("verb").lower()
    if not kept:
        raise NotUnderstoodError("the pictures show a turn, but it is not said what is to be turned")
    last = kept[-1].rstrip(" .!;")
    if verb and verb not in ("this", "it", "that"):
        last = re.sub(rf"\b{verb}(?:s|ed|ing)?\b", "rotate", last, flags=re.IGNORECASE)
    way = "clockwise" if turn >= 0 else "counterclockwise"
    last = re.sub(
        r"\b(?:by|to) (?:that|the same|this) (?:angle|amount|turn|way)\b|\b(?:in the same way|likewise|the same way|the same)\b",
        " ",
        last,
    )
    return " ".join([*kept[:-1], f"{last} by {abs(turn):g} degrees {way}."])


def _ordered(slots: Mapping[str, ShownSlot], kind: str) -> list[ShownSlot]:
    return sorted(
        (slot for slot in slots.values() if slot.kind == kind), key=lambda slot: (slot.index is None, slot.index or 0)
    )


def _names_in(sentence: str, names: set[str]) -> bool:
    return any(f"{{{name}}}" in sentence for name in names)


def _turn_shown(pairs: list[tuple[ShownSlot, ShownSlot]]) -> float:
    """The clockwise turn [degrees] that all pairs show."""
    seen = []
    for before, after in pairs:
        first, second = see(before.pictures[0]), see(after.pictures[0])
        if first.objects and second.objects:
            was = max(first.things, key=lambda thing: thing.area_px)
            now = max(second.things, key=lambda thing: thing.area_px)
            seen.append((before.pictures[0], was, after.pictures[0], now))
    turn = common_turn_deg(seen) if seen else None
    if turn is None:
        raise NotUnderstoodError("the pictures before and after do not show by how much something is turned")
    return turn if turn <= 180.0 else turn - 360.0
