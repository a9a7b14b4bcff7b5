"""New words that pictures define: nouns by a picture each, adjectives by comparisons of two things.

Definitions are found by what they hold (a picture and a word that is not known, and nothing but words that serve to
define), not by their order of words. They are taken out, and the new words replaced by what they mean.
"""

from __future__ import annotations

import re

from wonderful_team.offline.description import OPPOSITE
from wonderful_team.offline.language.phrases import PHRASES
from wonderful_team.offline.language.shows import Shows
from wonderful_team.offline.language.vocabulary import ARTICLES, FILLERS, WORDS

SLOT = re.compile(r"\{([^{}]+)\}")
_DEFINING = frozenset(
    """this that these those here is are be a an the call calls called name names named known as means mean meaning meant show shows shown look
    looks like thing things object objects item items one we i you they it see let s what there in picture pictured word words noun nouns stands stand for
    refers refer to referred defined denotes denote shaped form formed similar such learn following also and if given assume suppose where so of two both new
    term terms depicts depict by gets say will shall us please first second""".split()
)
"""Words of a sentence that defines a noun and does nothing else."""
_KNOWN = frozenset(word for phrase in PHRASES for word in phrase) | set(WORDS) | FILLERS | ARTICLES
_COMMON = _KNOWN | frozenset(
    "than compared comparison relative whichever whatever not most least more less now then task".split()
)
_AROUND = frozenset(
    """we say that note notice learn a word one adjective for example examples likewise and also so if here is how this means the s consider look at see
    given know you i while whereas but moreover similarly again in the same way as well too""".split()
)
"""Words that introduce comparisons and say nothing themselves."""
_ANY = r"(?:\s*\b(?:the|this|that|a|an)\b)?(?:\s*\b(?:thing|object|item|one)\b)?(?:\s*\bhere\b)?(?:\s*\b(?:shown |seen )?in\b)?"
_W = r"['\"\u201c\u201d]?(?P<word>[a-z]+)['\"\u201c\u201d]?"
_A, _B = rf"{_ANY}\s*\{{(?P<one>[^{{}}]+)\}}", rf"{_ANY}\s*\{{(?P<two>[^{{}}]+)\}}"
_IS = r"\s+(?:is|looks|appears|counts as|seems)"
_THAN = r"(?:than|compared (?:to|with)|in comparison (?:to|with)|relative to|next to)"
_COMPARISONS = (
    (rf"{_A}{_IS}\s+(?P<less>less\s+|not (?:as|so)\s+)(?:as\s+)?{_W}\s+(?:{_THAN}|as){_B}", "two"),
    (rf"{_A}{_IS}\s+(?:more\s+)?{_W},?\s+(?:when\s+)?{_THAN}{_B}", "one"),
    (rf"\b(?:when\s+)?{_THAN}{_A}\s*,?{_B}{_IS}\s+(?P<less>less\s+){_W}", "one"),
    (rf"\b(?:when\s+)?{_THAN}{_A}\s*,?{_B}{_IS}\s+(?:more\s+)?{_W}", "two"),
    (rf"\b(?:of|between|among){_A}\s+and{_B}\s*,?\s*(?:it is\s+)?the (?:first|former)(?: one)?(?:\s+that)?{_IS}\s+(?:the\s+)?(?:more\s+)?{_W}(?: one)?", "one"),
    (rf"\b(?:of|between|among){_A}\s+and{_B}\s*,?\s*(?:it is\s+)?the (?:second|latter)(?: one)?(?:\s+that)?{_IS}\s+(?:the\s+)?(?:more\s+)?{_W}(?: one)?", "two"),
    (rf"\bso is{_A}\s+{_THAN}{_B}(?P<word>)", "one"),
    (rf"{_A}\s+{_THAN}{_B}(?P<word>)(?=\s*(?:[.,;!?]|and\b|$))", "one"),
)  # fmt: skip
"""Ways to compare two pictures, and which of the two is the more so; without a word of its own the last word is meant."""
_Pair = tuple[str, str]


def define_words(text: str, shows: Shows) -> str:
    """The text without definitions, and the new words replaced by what their pictures show.

    Raises:
        NotUnderstoodError: The pictures do not show what an adjective means.
    """
    objects = set(shows.names("object"))
    pairs: dict[str, list[_Pair]] = {}
    rest = _taken_out(text, objects, pairs)
    if pairs:
        text = ". ".join(part for part in _sentences(rest) if not _only_introduces(part))
    text = _define_nouns(text, objects)
    for word, shown in pairs.items():
        text = _with_superlative(text, word, shows.compared(shown, word))
    return tidy(text) if pairs else text


def _define_nouns(text: str, objects: set[str]) -> str:
    """The text without definitions of nouns, and the nouns replaced by their pictures."""
    meant: dict[str, str] = {}
    kept: list[str] = []
    pieces = re.split(r"([.;!?,]\s*|\s+(?=and\s+put\b))", text)
    for index in range(0, len(pieces), 2):
        pairs = _noun_pairs(pieces[index], objects)
        later = "".join(pieces[:index] + pieces[index + 1 :])
        if pairs and all(re.search(rf"\b{word}(?:s|es)?\b", later, re.IGNORECASE) for word, _ in pairs):
            meant |= dict(pairs)
            kept.append(" ")
        else:
            kept.append(pieces[index] + (pieces[index + 1] if index + 1 < len(pieces) else ""))
    if not meant:
        return text
    text = "".join(kept)
    for word, name in meant.items():
        text = re.sub(
            rf"(?:\b(?:an|a|the|some|this|that|one|any)\s+)?(?:\b(?P<two>(?:two|of the two|both|each|every|all)(?: of)?(?: the)?)\s+)?['\"\u201c]?\b{word}(?:s|es)?\b['\"\u201d]?",
            lambda found, name=name: f" {found.group('two') or ''} the {{{name}}}",  # type: ignore[misc]
            text,
            flags=re.IGNORECASE,
        )
    return tidy(text)


def _noun_pairs(piece: str, objects: set[str]) -> list[_Pair]:
    """(word, picture) pairs of a piece of text that only defines; [] for any other."""
    tokens = re.findall(r"\{[^{}]+\}|[a-z]+", _lower(piece))
    order: list[tuple[str, str]] = []
    for token in tokens:
        if token.startswith("{"):
            if token[1:-1] not in objects:
                return []
            order.append(("slot", token[1:-1]))
        elif token in _DEFINING:
            continue
        elif token in _KNOWN:
            return []
        else:
            order.append(("word", token))
    kinds = [kind for kind, _ in order]
    if not order or len(order) % 2 or any(set(kinds[k : k + 2]) != {"slot", "word"} for k in range(0, len(kinds), 2)):
        return []
    pairs = [dict(order[k : k + 2]) for k in range(0, len(order), 2)]
    return [(pair["word"], pair["slot"]) for pair in pairs]


def _taken_out(text: str, objects: set[str], pairs: dict[str, list[_Pair]]) -> str:
    last = ""

    def take(found: re.Match[str], more: str) -> str:
        nonlocal last
        word = (found.group("word") or last).lower()
        one, two = found.group("one"), found.group("two")
        if one not in objects or two not in objects or word in _COMMON or not word:
            return found.group(0)
        last = word
        pairs.setdefault(word, []).append((one, two) if more == "one" else (two, one))
        return " "

    for pattern, more in _COMPARISONS:
        text = re.sub(pattern, lambda found, more=more: take(found, more), text, flags=re.IGNORECASE)  # type: ignore[misc]
    return text


def _sentences(text: str) -> list[str]:
    """Pieces between marks; a piece that only introduces may end at a comma or colon too."""
    parts = [part.strip() for part in re.split(r"[.;!?]", text)]
    out: list[str] = []
    for part in parts:
        pieces = re.split(r"([,:])", part)
        while pieces and _only_introduces(pieces[0]):
            del pieces[:2]
        out.append("".join(pieces).strip(" ,"))
    return out


def _only_introduces(part: str) -> bool:
    return all(word in _AROUND for word in re.findall(r"[a-z]+|\{[^{}]+\}", part.lower()))


def _with_superlative(text: str, word: str, meaning: str) -> str:
    """A new adjective in the text replaced by what it means, its opposite where less of it is asked for."""
    other = r"(?:\s+(?:than|as)\s+(?:the\s+)?(?:other|others|rest)(?:\s+(?:one|ones))?)?"
    opposite = rf"\b(?:less|the least|least|not so|not as|not|un)\s*\b{word}\b{other}"
    text = re.sub(opposite, f"{OPPOSITE[meaning]} ", text, flags=re.IGNORECASE)
    return re.sub(rf"\b(?:the most|more\s+|most\s+)?{word}\b{other}", f"{meaning} ", text, flags=re.IGNORECASE)


def _lower(text: str) -> str:
    return "".join(part if part.startswith("{") else part.lower() for part in re.split(r"(\{[^{}]+\})", text))


def tidy(text: str) -> str:
    """The text without marks that separate nothing."""
    text = re.sub(r"\s+", " ", text)
    text = re.sub(r"(?:\s*[.;,:](?:\s*and\b)?)+(?=\s*[.;,])", " ", text)
    return re.sub(r"^\s*(?:and\b|then\b|[.;,:!?\s])+", "", text).strip()
