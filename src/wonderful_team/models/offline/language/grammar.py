"""The grammar of instructions and noun phrases, over tokens of the vocabulary (lark, Earley)."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

from lark import Lark, Token, Tree
from lark.exceptions import LarkError
from lark.lexer import Lexer

from wonderful_team.models.offline.language import tokens as words

KINDS = (
    "PUT TAKE ROTATE STACK PUSH SORT GIVE WANT LEAVE IN INTO ON ONTO TO NEAR BY ABOVE BELOW BETWEEN OF WITH FROM AS AND THEN THAT "
    "WHOSE FOR CONTAIN FILL THERE IT ITS THEY MATCH SAME SHARE AUX EACH ALL ONE EVERYTHING REST WHERE COLOUR PATTERN SHAPE NOUN ASPECT "
    "SUPER SIDE ORDINAL NUMBER DARK ORANGE TABLE TURN FREE ORIGIN LEFT_OF RIGHT_OF FAR SIDE_POST ANGLE SHAPED LIKE "
    "ON_TABLE CORNER MATERIAL LOOK SLOT LETTER COMMA SEP EXCEPT ONE_OF OF_TWO FORMER LATTER SWAP PLACE_OF BESIDE_IT"
)

GRAMMAR = rf"""
%declare {KINDS}

sentence: SHARE? (clause | ellipsis) (join (clause | ellipsis))*
join: THEN | SEP | AND | COMMA
?clause: put | contain | rotate | stack | push | sort | swap
ellipsis: things goal

put: _put_words
_put_words: WANT? PUT things goal
    | PUT goal things
    | goal COMMA? PUT things
    | (TAKE | PUT) things ON? (AND | COMMA | THEN | SEP)? PUT IT? goal
    | ON_TABLE things (AND | COMMA | THEN | SEP)? PUT IT goal
    | (TAKE | PUT) things goal (AND | COMMA | THEN) PUT IT (IN | INTO | ON | THERE)?
    | (PUT | GIVE | TAKE | SORT | WANT) things THAT? (IT | THEY) AUX* goal
    | (GIVE | TAKE) things AUX+ goal
    | TAKE things goal
    | things AUX+ PUT? goal
    | (WANT | SHARE) things AUX* PUT? goal
    | WANT PUT things goal
    | FOR things COMMA? PUT things goal
    | WANT things IN? AUX PUT goal
    | (LEAVE | GIVE) things goal

contain: np AUX* CONTAIN things
    | FILL np WITH things

rotate: ROTATE things angle
    | LEAVE things (AND | COMMA | THEN | SEP)? ROTATE IT angle
    | ROTATE angle things
    | angle COMMA? ROTATE things
    | (ROTATE | GIVE | TAKE) things (THAT | AND | COMMA | THEN)? IT? AUX* ROTATE IT? angle
    | (WANT | SHARE) things AUX* ROTATE angle
    | WANT angle ROTATE? OF things
    | things AUX+ ROTATE? angle
    | GIVE things angle ROTATE?
    | GIVE things ROTATE (OF | BY) angle
    | GIVE angle ROTATE? (OF | TO | ON | WITH | FOR) things
    | GIVE ROTATE (OF | BY) angle (TO | ON | OF | WITH | FOR) things
    | GIVE ROTATE (OF | TO | ON) things angle
    | ROTATE OF things angle
angle: (BY | TO | OF)? ANGLE (TURN | SIDE_POST | IN? TURN)?
    | TURN (BY | OF | COMMA)? ANGLE
    | (BY | OF)? TURN ANGLE

stack: STACK things (COMMA? (ON | ONTO | IN | INTO) np)+
push: PUSH things goal | WANT things AUX* PUSH goal | things AUX+ PUSH goal
    | PUSH things SIDE | PUSH goal things | goal COMMA? PUSH things | TAKE things (AND | COMMA | THEN)? PUSH IT? goal
swap: SWAP np (AND | WITH | FOR) np
sort: MATCH things (WITH | TO | AND) goal
    | SORT things THAT (EACH (ONE | NOUN)? | ALL | IT | THEY) AUX* PUT? goal
    | SORT things (BY | ON | IN | INTO | TO) ASPECT
    | SORT things goal
    | SORT things (BY | ON) (ITS | SAME)? ASPECT goal

goal: goal_at | goal_where | goal_between | goal_origin | goal_match | goal_side | goal_there
goal_at: ORIGIN? where np
goal_between: (IN | INTO | TO)? BETWEEN np (AND np)?
goal_origin: ORIGIN
goal_where: (TO | IN | ON)? WHERE np AUX
goal_side: SIDE_POST ON_TABLE? | (TO | IN | ON)? CORNER ON_TABLE?
goal_there: THERE | (IN | INTO | ON | ONTO | TO) THAT NOUN
goal_match: where? matched
where: IN | INTO | ON | ONTO | TO | LEFT_OF | RIGHT_OF | ABOVE | BELOW | near | TO IN | NEAR TO
near: NEAR | BY

matched: (THAT | ITS)? (SAME | MATCH | ITS)+ ASPECT* (NOUN | SHAPE | ONE)
    | (adj | ASPECT)* (NOUN | SHAPE | ONE) match_post ON_TABLE?
match_post: (THAT | OF | WITH | IN | AUX | SHARE)* ITS? (SAME | MATCH)+ ASPECT (AS back)?
    | (THAT | OF | WITH | IN | AUX | SHARE | ITS)* ITS SAME? ASPECT
    | THAT? AUX? MATCH
    | THAT? MATCH (ITS | SAME)? ASPECT (OF back)?
    | THAT? MATCH (IT | NOUN) ((IN | BY)? ASPECT)?
    | THAT? MATCH (IN | BY) ASPECT
    | WHOSE ASPECT (AUX SAME | MATCH | SHARE SAME | AUX? LIKE) AS? back?
    | (THAT SHARE | WITH | OF | IN) ASPECT (THAT AUX?)? MATCH back?
    | (THAT AUX | OF | WITH | IN)? ASPECT LIKE back
    | WHOSE ASPECT IT SHARE
    | WITH THAT IT SHARE ITS? SAME? ASPECT
    | THAT IT (MATCH | SHARE) (IN | BY)? ASPECT
    | THAT SHARE ITS? ASPECT
    | IN? THAT (AUX | SHARE) SAME (AS back)?
back: IT | NOUN | ITS ASPECT | THAT (OF (IT | NOUN))? | NOUN ASPECT | ASPECT OF (IT | NOUN) | SHAPE | ITS | ONE

things: np (joiner np)* had_match?
joiner: AND | COMMA
had_match: THAT? (SHARE | WITH) matched
    | WITH matched

np: THAT? quantity? adj* head plain_post*
    | THAT? quantity? adj* head plain_post* post+
    | PLACE_OF np in_slot?
quantity: EACH | ALL | NUMBER | ALL NUMBER | REST | ONE_OF NUMBER? | EACH ONE_OF
adj: colour | PATTERN PATTERN? | (MATERIAL | LOOK) PATTERN? ASPECT? | SHAPE | SHAPE SHAPED | SUPER | SIDE | ORDINAL | ORDINAL SUPER | SUPER OF_TWO | SUPER ONE OF_TWO | FREE
    | (SUPER | SIDE | ORDINAL | colour | PATTERN) (OF | ONE_OF) | SIDE_POST (OF | ONE_OF)? | ORDINAL FROM SIDE | SLOT ASPECT? | NOUN | SLOT SHAPED | COMMA adj | LETTER
colour: DARK? (COLOUR | ORANGE) ASPECT? ((AND | COMMA) DARK? (COLOUR | ORANGE) ASPECT?)* | DARK ASPECT?
head: NOUN | SHAPE | LETTER | ORANGE | SLOT | ONE | EVERYTHING | IT | TABLE | NOUN LETTER | THEY | FORMER | LATTER
plain_post: SIDE_POST | ON_TABLE | CORNER | (IN | ON)? CORNER | FROM SIDE_POST | FROM SIDE
    | in_slot | LIKE SLOT | THAT LIKE SLOT | THAT? MATCH SLOT | colour | PATTERN | OF SLOT | AS SLOT | THAT AUX? LIKE np
    | COMMA? THAT AUX NOUN COMMA? | THAT AUX colour | THAT AUX PATTERN | (OF | WITH | IN) colour? (MATERIAL | LOOK) ASPECT? | THAT AUX (MATERIAL | LOOK) | THAT AUX SHAPE | THAT AUX SUPER | SUPER
    | THAT? AUX SIDE_POST | THAT AUX FREE | THAT AUX ORDINAL (FROM SIDE)?
    | (WITH | IN | OF | SHARE | THAT SHARE) colour? PATTERN (ASPECT)?
    | (WITH | IN | OF | THAT SHARE) ASPECT? colour
    | (WITH | OF | THAT SHARE) ASPECT (OF | IN | AS | LIKE | FROM)? SLOT
    | (WITH | OF | THAT SHARE) SLOT ASPECT
    | IN ASPECT
    | (WITH | OF | IN | THAT SHARE | THAT AUX)+ SAME ASPECT (AS | OF) np
    | SUPER TO np | THAT AUX SUPER TO np | COMMA? EXCEPT (FOR | IN)? np (spared np)*
    | SHAPED SLOT | SHAPED SHAPE | SHAPED LETTER
spared: AND | COMMA
in_slot: (IN | FROM | ON) SLOT
post: THAT? AUX* PUT? relation np
    | THAT? AUX* BETWEEN np AND np
    | THAT? AUX* BESIDE_IT (OF np)?
relation: LEFT_OF | RIGHT_OF | ABOVE | BELOW | near | FAR | ON | IN
"""
"""`goal` against `post`: "the block left of the bowl" may end a noun phrase or start a goal; the reader picks the tree
whose moved thing is simplest (see `reading.py`)."""


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
        start=["sentence", "np", "things", "goal", "post"],
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
    cost = {"post": 1.0, "joiner": 0.2, "matched": -0.5, "in_slot": 1.2, "goal_there": -0.8}.get(str(tree.data), 0.0)
    if tree.data == "relation" and tree.children and getattr(tree.children[0], "type", "") in ("IN", "ON"):
        cost += 0.6
    if tree.data == "np" and tree.children and getattr(tree.children[0], "type", "") == "THAT":
        cost += 0.4
    children: list[Any] = []
    for child in tree.children:
        if isinstance(child, Tree):
            best, child_cost = simplest(child)
            cost += child_cost
            if best.data == "things" and tree.data != "things":
                cost += 0.5 * sum(1 for _ in best.find_data("post"))
            if (
                best.data == "plain_post"
                and len(best.children) == 1
                and (
                    getattr(best.children[0], "data", "") == "colour"
                    or getattr(best.children[0], "type", "") == "PATTERN"
                )
            ):
                cost += 0.6  # a colour after its noun ("everything red")
            if best.data == "plain_post" and any(
                isinstance(item, Token) and item.type == "EXCEPT" for item in best.children
            ):
                cost -= 0.3 * len(best.children)
            if best.data == "adj" and any(
                isinstance(item, Token) and item.type in ("NOUN", "LETTER") for item in best.children
            ):
                cost += 0.3
            children.append(best)
        else:
            children.append(child)
    return Tree(tree.data, children, tree.meta), cost
