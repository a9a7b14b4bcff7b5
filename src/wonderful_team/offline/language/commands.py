"""What an instruction asks for, understood: commands over descriptions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from wonderful_team.offline.description import Description, Figure

CommandKind: TypeAlias = Literal["put", "rotate", "push", "arrange", "follow", "restore", "trace", "shake", "open"]
Where: TypeAlias = Literal[
    "in", "on", "left", "right", "above", "below", "near", "between", "origin", "matching", "side", "ranked"
]
Aspect: TypeAlias = Literal["colour", "texture", "shape"]


@dataclass(frozen=True)
class Destination:
    """Where something goes.

    Attributes:
        how: in or on a thing; on a named side of it; near it; between two; origin (where it stood); matching (the one that
            shares `aspect` with the thing moved); side (towards a side of the picture, `side`); ranked (the one of its kind that
            states the thing's rank by price, `side`: descending or ascending).
        what: The reference, None for side and for its own origin; for origin the thing whose place it takes; the kind of thing that must match for matching.
        other: The second reference of between.
        aspect: What must be shared for matching.
        side: leftmost | rightmost | topmost | bottommost, for side; descending | ascending, for ranked.
    """

    how: Where
    what: Description | None = None
    other: Description | None = None
    aspect: Aspect | None = None
    side: str = ""


@dataclass(frozen=True)
class Command:
    """One thing to be done.

    Attributes:
        rotate_deg: Clockwise seen from above; for rotate, and for open where it is said how far.
        conditional: Only where the destination exists ("if such an area exists").
        after_last: The words say that the command before it comes first ("then").
        pictures: Names of the instruction's pictures that show what to do: the goal for arrange, the frames for follow.
        off: What a pushed thing must not touch on its way nor at its end.
        limit: A line inside the destination that a pushed thing must not pass.
        figure: What is led along, for trace and shake.
        tool: What is named as leading along it.
    """

    kind: CommandKind
    thing: Description
    to: Destination | None = None
    rotate_deg: float = 0.0
    conditional: bool = False
    after_last: bool = False
    pictures: tuple[str, ...] = ()
    off: Description | None = None
    limit: Description | None = None
    figure: Figure | None = None
    tool: Description | None = None


@dataclass(frozen=True)
class Understood:
    """A text, understood.

    Attributes:
        commands: In order of execution.
        used: The words that carried meaning, in order, as written.
        nothing_else: The words say that nothing but what they name may be moved.
        spared: Things that the words say must stay where they are.
        said: What the user said beside the instruction.
    """

    text: str
    commands: tuple[Command, ...]
    used: tuple[str, ...]
    nothing_else: bool = False
    spared: tuple[Description, ...] = ()
    said: tuple[str, ...] = ()
