"""What a noun phrase says of a thing: the one language in which `offline`'s grammar and its eyes talk to each other.

Words here are canonical (the grammar maps synonyms to them); none is a texture or task name of any simulator.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

PATTERNS = ("plain", "striped", "dotted", "checkered", "swirled", "mottled", "multicoloured")
"""Canonical surface patterns. mottled: irregular (stone, wood, fur); multicoloured: many hues (rainbow)."""

SHAPES = (
    "square", "rectangle", "circle", "ring", "triangle", "diamond", "pentagon", "hexagon", "star", "heart", "cross",
    "flower", "letter", "l-shape", "oval", "crescent", "frame", "long", "bowl", "pan",
)  # fmt: skip
"""Canonical outline shapes seen from above. ring and frame have a hole: a round and an angular one."""

Relation: TypeAlias = Literal[
    "left_of", "right_of", "above", "below", "near", "nearest", "far_from", "on", "inside", "between", "same_colour", "same_pattern",
    "same_shape",
]  # fmt: skip
Superlative: TypeAlias = Literal[
    "largest", "smallest", "leftmost", "rightmost", "topmost", "bottommost", "middle", "tallest", "shortest", "nearest",
    "darkest", "lightest", "column by column", "row by row",
]  # fmt: skip

LINE_BY_LINE: tuple[Superlative, ...] = ("column by column", "row by row")
"""How many things in a field are counted: from the left, each column from the top; from the top, each row from the left."""
OPPOSITE: dict[str, Superlative] = {
    "tallest": "shortest", "shortest": "tallest", "darkest": "lightest", "lightest": "darkest", "largest": "smallest",
    "smallest": "largest",
}  # fmt: skip


@dataclass(frozen=True)
class Related:
    """A relation to one other thing (two for between)."""

    relation: Relation
    to: tuple[Description, ...]


@dataclass(frozen=True)
class Way:
    """A place on the way of a thing that is pushed.

    Attributes:
        thing: What is pushed.
        into: Where to.
        leg: before: where it rests on its way, outside; inside: where it ends; away: out of the way of others.
        off: What it must not touch.
        limit: A line in there that it must not pass.
    """

    thing: Description
    into: Description
    leg: Literal["before", "inside", "away"]
    off: Description | None = None
    limit: Description | None = None


@dataclass(frozen=True)
class Description:
    """A noun phrase, understood.

    Attributes:
        noun: thing | object | block | container | fruit | area | letter | toy | ball | bottle | cap | lid | tool. A shape word used as a noun ("the star") gives
            "object" with that shape, the name of a fruit ("banana") "fruit" and `name`.
        name: The particular name when it says more than the noun ("banana", "G" for a letter), or "".
        colours: Canonical colours, all of which must show ("red and blue striped" has two).
        dark: True for "dark blue", False for "light blue", None when nothing is said.
        pattern, shape: Canonical, or None.
        material: An everyday surface such as wood, or None; judged by its look in place of a pattern.
        superlative: Picks one among those that fit the rest ("the largest red one").
        ordinal: "second from the left" is ("leftmost", 2) in `superlative` and `ordinal`; 1 otherwise.
        like: Name of the instruction's picture that shows it, or None.
        like_only: Which aspect of that picture counts; all when None ("the {texture} object": colour and pattern).
        related: Relations that must hold.
        quantity: one | each | all (also plurals) | number.
        number: How many when quantity is number; of how many the words speak when it is another.
        plural: Whether the noun stands in the plural without a word for how many.
        placed: For an area: the thing whose place in the instruction's picture `like` is meant.
        since: Name of the picture before it in a sequence: the place is where the thing came to between the two.
        excluded: What is left out of all that fit ("all blocks except the red one").
        way: For an area: the free place where a thing is pushed to.
        text: The words it came from.
    """

    noun: str
    text: str
    name: str = ""
    colours: tuple[str, ...] = ()
    dark: bool | None = None
    pattern: str | None = None
    shape: str | None = None
    superlative: Superlative | None = None
    ordinal: int = 1
    like: str | None = None
    like_only: Literal["texture", "shape"] | None = None
    related: tuple[Related, ...] = ()
    material: str | None = None
    quantity: Literal["one", "each", "all", "number"] = "one"
    number: int = 1
    plural: bool = False
    excluded: tuple[Description, ...] = ()
    placed: Description | None = None
    since: str | None = None
    way: Way | None = None


@dataclass(frozen=True)
class Figure:
    """What a tool, or a thing in the air, is led along.

    Attributes:
        name: A figure that is drawn ("star", "line"), "area" for all of a surface, or "shake".
        count: Tips of a star, or how often something is shaken; 0 where nothing is said and none are counted.
        size: As a share of the usual size.
    """

    name: str
    count: int = 0
    size: float = 1.0


FREE = Description(noun="area", name="free", text="free area")
"""Anywhere on free table."""
ROOMY = Description(noun="area", name="free", superlative="largest", text="largest free area")
"""Free table with room for the largest thing, and so for the fingers beside what is put there."""
