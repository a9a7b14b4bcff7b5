"""From texts to commands and descriptions: tokens, the simplest tree, its meaning.

`understand` reads an instruction, `describe` a noun phrase. Both refuse by name what they do not know.
"""

from __future__ import annotations

import re
from dataclasses import replace
from functools import lru_cache

from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.description import Description
from wonderful_team.offline.language.accounting import passed_over
from wonderful_team.offline.language.asides import set_aside, without_reasons
from wonderful_team.offline.language.bounds import Bounds, set_bounds
from wonderful_team.offline.language.changes import related_of, thing_of
from wonderful_team.offline.language.clause_parts import PLACES, VERBS, Unclear
from wonderful_team.offline.language.commands import Command, Understood
from wonderful_team.offline.language.conditions import open_conditions
from wonderful_team.offline.language.grammar import parse
from wonderful_team.offline.language.handling import handled
from wonderful_team.offline.language.meaning import Meaning
from wonderful_team.offline.language.ranking import read_ranking
from wonderful_team.offline.language.references import with_noun, with_nouns
from wonderful_team.offline.language.rewrites import in_order, put_plainly, turned
from wonderful_team.offline.language.slots import matching_template, read_clauses
from wonderful_team.offline.language.templates import gathering_template
from wonderful_team.offline.language.tokens import OTHERS_MAY, Token, refusal, tokenise
from wonderful_team.offline.language.vocabulary import nearest_words


@lru_cache(maxsize=512)
def understand(text: str) -> Understood:
    """What an instruction asks for.

    Raises:
        NotUnderstoodError: A word is unknown, or the words do not make an instruction; says which.
    """
    ranking = read_ranking(text, try_describe)
    if ranking is not None:
        return Understood(text, (ranking,), tuple(re.findall(r"\w+", text)))
    later = _LATER.search(text)
    if later is not None:
        raise NotUnderstoodError(refusal([], [later.group(0)]))
    bounds = set_bounds(put_plainly(turned(without_reasons(text))), try_describe)
    asides = set_aside(in_order(bounds.text), try_describe)
    plain, conditional = open_conditions(asides.text)
    tokens = handled(_turns(_joined(tokenise(plain))))
    commands = with_nouns(_commands(tokens, asides.text, text))
    if conditional or asides.others_without:
        commands = tuple(replace(command, conditional=True) for command in commands)
    if bounds.off is not None or bounds.limit is not None:
        commands = tuple(_kept_off(command, bounds) for command in commands)
        if all(command.off is None and command.limit is None for command in commands):
            raise NotUnderstoodError(
                _no_sentence(text, tokens, "what must be kept off is said of nothing that is pushed")
            )
    lost = passed_over(tokens, commands)
    if lost:
        raise NotUnderstoodError(_no_sentence(text, tokens, f"it is not clear what is meant by {', '.join(lost)}"))
    used = tuple(token.text for token in tokens)
    return Understood(text, commands, used, asides.nothing_else, asides.spared)


def _kept_off(command: Command, bounds: Bounds) -> Command:
    """A push with what it must keep off; what is said of a push in other words ("get two into the frame") is one."""
    moved = command.kind == "put" and command.to is not None and command.to.how in ("in", "on")
    if command.kind != "push" and not (moved and bounds.pushes):
        return command
    return replace(command, kind="push", off=bounds.off, limit=bounds.limit)


_LATER = re.compile(r"\b(?:that|which|who) will (?:be|stand|lie|sit)\b", re.IGNORECASE)
"""Speaks of how things will stand, which no picture shows."""


def _commands(tokens: list[Token], words: str, text: str) -> tuple[Command, ...]:
    """Commands clause by clause; by the gist where all says "matching"."""
    gathered = gathering_template(tokens)
    if gathered is not None:
        return (gathered,)
    try:
        every = _joined(
            tokenise(re.sub(r"\b(?:if|when|whenever|wherever|provided)\b", " ", words, flags=re.IGNORECASE))
        )
        gist = matching_template(every)
        if gist is not None:
            return (gist,)
    except NotUnderstoodError:
        pass
    try:
        commands = read_clauses(tokens, Meaning())
    except (Unclear, NotUnderstoodError) as error:
        matching = matching_template(tokens)
        if matching is not None:
            return (matching,)
        raise NotUnderstoodError(_no_sentence(text, tokens, str(error))) from error
    if not commands:
        raise NotUnderstoodError(_no_sentence(text, tokens, "nothing in it says what to do"))
    return commands


@lru_cache(maxsize=2048)
def describe(words: str, where: str = "") -> Description:
    """What a noun phrase says of a thing; `where` holds relations in words of their own ("left of the blue bowl").

    Raises:
        NotUnderstoodError: A word is unknown, or the words do not make a noun phrase; says which.
    """
    tokens = [token for token in tokenise(_noun_words(words)) if token.kind != "SEP"]
    tree = parse(tokens, "np")
    if tree is None:
        raise NotUnderstoodError(_no_noun_phrase(words, tokens))
    description = thing_of(tree)
    if where.strip():
        description = _with_where(description, where)
    return with_noun(description, None)


def try_understand(text: str) -> Understood | None:
    """Like understand; None where it would refuse."""
    try:
        return understand(text)
    except NotUnderstoodError:
        return None


def try_describe(words: str, where: str = "") -> Description | None:
    """Like describe; None where it would refuse."""
    try:
        return describe(words, where)
    except NotUnderstoodError:
        return None


def _with_where(description: Description, where: str) -> Description:
    parts = [part for part in where.split(";") if part.strip()]
    if len(parts) > 1:
        for part in parts:
            description = _with_where(description, part)
        return description
    tokens = [token for token in tokenise(where) if token.kind not in ("SEP", "COMMA")]
    if not tokens or all(token.kind in ("ON_TABLE", "TABLE", "ON") for token in tokens):
        return description
    tree = parse(tokens, "post")
    if tree is not None:
        return replace(description, related=(*description.related, related_of(tree)))
    tree = parse([Token("NOUN", ("thing", "", False), "thing"), *tokens], "np")
    if tree is None:
        raise NotUnderstoodError(_no_noun_phrase(where, tokens))
    extra = thing_of(tree)
    return replace(
        description,
        related=(*description.related, *extra.related),
        superlative=extra.superlative or description.superlative,
        ordinal=max(extra.ordinal, description.ordinal),
    )


def _noun_words(words: str) -> str:
    """Explanations in brackets and after a dash are left out."""
    return re.sub(r"\([^)]*\)|\s[-\u2013\u2014]\s.*$", " ", words)


def _joined(tokens: list[Token]) -> list[Token]:
    """Runs of commas, stops, "and" and "then" become one; none at either end."""
    tokens = _without_and(tokens)
    tokens = _listed(tokens)
    rank = {"COMMA": 0, "AND": 1, "SEP": 2, "THEN": 3}
    joined: list[Token] = []
    for token in tokens:
        if token.kind in rank and joined and joined[-1].kind in rank:
            if rank[token.kind] > rank[joined[-1].kind]:
                joined[-1] = token
        else:
            joined.append(token)
    while joined and joined[0].kind in rank:
        joined.pop(0)
    while joined and joined[-1].kind in rank:
        joined.pop()
    return joined


_WAYS = {"to left": -1.0, "leftwards": -1.0, "to right": 1.0, "rightwards": 1.0}


def _turns(tokens: list[Token]) -> list[Token]:
    """The words "turn the star to the left by 90 degrees" say which way, not which star."""
    out: list[Token] = []
    for at, token in enumerate(tokens):
        after = next((item.kind for item in tokens[at + 1 :] if item.kind in ("ANGLE", *VERBS, "SEP", "THEN")), "")
        before = next((item.kind for item in reversed(tokens[:at]) if item.kind in VERBS), "")
        turned = token.kind == "SIDE_POST" and before == "ROTATE" and after == "ANGLE" and token.text in _WAYS
        out.append(Token("TURN", _WAYS[token.text], token.text) if turned else token)
    return out


def _listed(tokens: list[Token]) -> list[Token]:
    """The words "the red block and then the green block go into the bowl" list things; "then" starts no clause."""
    out: list[Token] = []
    started = False
    for at, token in enumerate(tokens):
        if token.kind == "SEP":
            started = False
        elif token.kind == "THEN" and not started and out and not _verb_follows(tokens, at + 1):
            token = Token("AND", "and", token.text)
        elif token.kind in (*VERBS, *PLACES, "AUX", "WANT", "GIVE", "ANGLE", "ORIGIN", "CONTAIN", "FILL"):
            started = True
        out.append(token)
    return out


def _verb_follows(tokens: list[Token], at: int) -> bool:
    return at < len(tokens) and tokens[at].kind in (*VERBS, "WANT", "GIVE")


def _without_and(tokens: list[Token]) -> list[Token]:
    """The words "all fruits but the lime": "but" leaves out; a stop after "build a tower" says nothing."""
    out: list[Token] = []
    for at, token in enumerate(tokens):
        if token.kind == "SEP" and out and out[-1].kind == "STACK":
            continue
        after = tokens[at + 1].kind if at + 1 < len(tokens) else ""
        if token.kind == "SUPER" and after == "STACK":
            continue  # "a small tower" is as large as what it is made of
        many = any(item.kind in ("EACH", "ALL", "EVERYTHING") for item in out[-4:])
        if (
            token.text == "but"
            and many
            and after not in VERBS
            and out[-1].kind in ("NOUN", "SHAPE", "EVERYTHING", "ONE")
        ):
            out.append(Token("EXCEPT", "except", token.text))
        else:
            out.append(token)
    return out


def _no_sentence(text: str, tokens: list[Token], missing: str) -> str:
    if not tokens:
        return refusal(tokens, [text.strip()])
    return (
        f"I used: {', '.join(token.text for token in tokens)}. I do not know: what {text.strip()!r} asks for ({missing}). "
        "The words are known, but they do not make an instruction for me. I understand: put X into/onto/left of/beside Y, "
        "rotate X by N degrees, stack X on Y, push X to Y, swap X and Y, sort or put each X into the Y of the same colour. "
        f"{OTHERS_MAY}"
    )


def _no_noun_phrase(words: str, tokens: list[Token]) -> str:
    return (
        f"I know every word of {words.strip()!r}, but they do not name a thing for me. "
        f"I used: {', '.join(token.text for token in tokens) or 'nothing'}. {nearest_words(())} {OTHERS_MAY}"
    )
