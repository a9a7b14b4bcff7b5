"""The grammar of noun phrases, over tokens of the vocabulary (lark, Earley)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

from lark import Lark, Token, Tree
from lark.exceptions import LarkError
from lark.lexer import Lexer

from wonderful_team.offline.language import tokens as words

KINDS = (
    "PUT TAKE ROTATE STACK PUSH SORT GIVE WANT LEAVE IN INTO ON ONTO TO NEAR BY ABOVE BELOW BETWEEN OF WITH FROM AS AND THEN THAT "
    "WHOSE FOR CONTAIN FILL THERE IT ITS THEY MATCH SAME SHARE AUX EACH ALL ONE EVERYTHING REST WHERE COLOUR PATTERN SHAPE NOUN ASPECT "
    "SUPER SIDE ORDINAL NUMBER DARK ORANGE TABLE TURN FREE ORIGIN LEFT_OF RIGHT_OF FAR SIDE_POST ANGLE SHAPED LIKE "
    "ON_TABLE CORNER MATERIAL LOOK SLOT LETTER COMMA SEP EXCEPT ONE_OF OF_TWO FORMER LATTER SWAP PLACE_OF BESIDE_IT"
)

GRAMMAR = rf"""
%declare {KINDS}

np: THAT? quantity? adj* head plain_post*
    | THAT? quantity? adj* head plain_post* post+
    | PLACE_OF np in_slot?
quantity: EACH | ALL | NUMBER | ALL NUMBER | REST NUMBER? | ONE_OF NUMBER? | EACH ONE_OF
adj: colour | PATTERN PATTERN? | (MATERIAL | LOOK) PATTERN? ASPECT? | SHAPE | SHAPE SHAPED | SUPER | SIDE | ORDINAL | ORDINAL SUPER | SUPER ONE OF_TWO | FREE
    | (SUPER | SIDE | ORDINAL | colour | PATTERN) (OF | ONE_OF | OF_TWO) NUMBER? | SIDE_POST (OF | ONE_OF)? | ORDINAL FROM SIDE | SLOT ASPECT? | NOUN | SLOT SHAPED | COMMA adj | LETTER
colour: DARK? (COLOUR | ORANGE) ASPECT? ((AND | COMMA) DARK? (COLOUR | ORANGE) ASPECT?)* | DARK ASPECT?
head: NOUN | SHAPE | LETTER | ORANGE | SLOT | ONE | EVERYTHING | IT | TABLE | NOUN LETTER | THEY | FORMER | LATTER
plain_post: SIDE_POST | ON_TABLE | CORNER | (IN | ON)? CORNER | FROM SIDE_POST | FROM SIDE
    | in_slot | LIKE SLOT | THAT LIKE SLOT | THAT? MATCH SLOT | colour | PATTERN | OF SLOT | AS SLOT | THAT AUX? LIKE np
    | COMMA? THAT AUX adj* NOUN COMMA? | THAT AUX colour | THAT AUX PATTERN | (OF | WITH | IN) colour? (MATERIAL | LOOK) ASPECT? | THAT AUX (MATERIAL | LOOK) | THAT AUX SHAPE | THAT AUX SUPER | SUPER
    | THAT? AUX SIDE_POST | THAT AUX FREE | THAT AUX ORDINAL (FROM SIDE)?
    | (WITH | IN | OF | SHARE | THAT SHARE) colour? PATTERN (ASPECT)?
    | (WITH | IN | OF | THAT SHARE) ASPECT? colour
    | (WITH | OF | THAT SHARE) ASPECT (OF | IN | AS | LIKE | FROM)? SLOT
    | (WITH | OF | THAT SHARE) SLOT ASPECT
    | IN ASPECT
    | (WITH | OF | IN | THAT SHARE | THAT AUX)+ SAME ASPECT (AS | OF) np
    | (WITH | OF | IN) (ITS | SAME | ITS SAME) ASPECT
    | WHOSE ASPECT AUX? LIKE (THAT OF)? np
    | SUPER TO np | THAT AUX SUPER TO np | COMMA? EXCEPT (FOR | IN)? np (spared np)*
    | SHAPED SLOT | SHAPED SHAPE | SHAPED LETTER
spared: AND | COMMA
in_slot: (IN | FROM | ON) SLOT
post: THAT? AUX* PUT? relation np
    | THAT? AUX* BETWEEN np AND np
    | THAT? AUX* BESIDE_IT (OF np)?
relation: LEFT_OF | RIGHT_OF | ABOVE | BELOW | NEAR | BY | FAR | ON | IN
"""


class _TokenLexer(Lexer):  # type: ignore[misc]
    """Hands our tokens to lark as they are."""

    def __init__(self, lexer_conf: Any) -> None:
        pass

    def lex(self, data: list[words.Token]) -> Iterator[Token]:
        for index, token in enumerate(data):
            yield Token(token.kind, token, start_pos=index)


@cache
def _parser() -> Lark:
    return Lark(
        GRAMMAR,
        parser="earley",
        lexer=_TokenLexer,
        ambiguity="explicit",
        start=["np", "post"],
        maybe_placeholders=False,
    )


def parse(tokens: list[words.Token], start: str) -> Tree[Token] | None:
    """The simplest tree of the tokens under a start rule, or None when there is none."""
    if not tokens:
        return None
    try:
        tree = _parser().parse(tokens, start=start)
    except LarkError:
        return None
    return simplest(tree)[0]


def simplest(tree: Tree[Token]) -> tuple[Tree[Token], float]:
    """The cheapest of all readings: every relation costs one, inside the moved thing a little more."""
    if tree.data == "_ambig":
        return min((simplest(child) for child in tree.children if isinstance(child, Tree)), key=lambda pair: pair[1])
    cost = {"post": 1.0, "in_slot": 1.2}.get(str(tree.data), 0.0)
    if tree.data == "relation" and tree.children and getattr(tree.children[0], "type", "") in ("IN", "ON"):
        cost += 0.6
    if tree.data == "np" and tree.children and getattr(tree.children[0], "type", "") == "THAT":
        cost += 0.4
    children: list[Any] = []
    for child in tree.children:
        if isinstance(child, Tree):
            best, child_cost = simplest(child)
            cost += child_cost
            kinds = [getattr(item, "type", "") or getattr(item, "data", "") for item in best.children]
            if best.data == "plain_post" and kinds in (["colour"], ["PATTERN"]):
                cost += 0.6  # a colour after its noun ("everything red")
            if best.data == "plain_post" and "EXCEPT" in kinds:
                cost -= 0.3 * len(kinds)
            if best.data == "adj" and {"NOUN", "LETTER"} & {*kinds}:
                cost += 0.3
            children.append(best)
        else:
            children.append(child)
    return Tree(tree.data, children, tree.meta), cost
