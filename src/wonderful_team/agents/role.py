"""What a role is: its standing words, and for every contract it asks, the words of the ask and the rendering.

`system` and the words of each ask are text that users can read and replace as files, in which nothing is filled in: passages are
sent or left out (`passages`). Everything else that changes from request to request is rendered as data by the ask's `render`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from wonderful_team.contracts import LocatePoints, Question
from wonderful_team.core.values import Part


@dataclass(frozen=True, eq=False)
class Ask:
    """How one contract is asked.

    Attributes:
        contract: The kind of question.
        words: What is asked for, shown after the rendered question.
        render: Turns a question of that kind into words and pictures, every field of it.
    """

    contract: type[Question]
    words: str
    render: Callable[[Any], list[Part]]


@dataclass(frozen=True, eq=False)
class Role:
    """One member of the team.

    Attributes:
        system: The standing words: scope, what it sees, what it must not do.
        asks: By the contract's name.
        grounds: It finds targets in pictures; the others plan. Studies can let truth answer for one side of the two.
    """

    name: str
    system: str
    asks: Mapping[str, Ask]
    grounds: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "asks", MappingProxyType(dict(self.asks)))

    @property
    def points(self) -> bool:
        """It gives points and boxes on whole views."""
        return LocatePoints.__name__ in self.asks


def role(name: str, system: str, *asks: Ask, grounds: bool = False) -> Role:
    """A role with its asks, its words trimmed."""
    trimmed = (Ask(ask.contract, ask.words.strip(), ask.render) for ask in asks)
    return Role(name, system.strip(), {ask.contract.__name__: ask for ask in trimmed}, grounds)
