"""What the words of an instruction need to know of its pictures: the kind of each, and what pairs of them show.

The language reads words only; whoever looks at the pictures answers these questions.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol


class Shows(Protocol):
    """The pictures of an instruction, by name."""

    def names(self, *kinds: str) -> tuple[str, ...]:
        """Names of the pictures of these kinds (object, scene, frame, before, after), in their own order."""

    def compared(self, pairs: Sequence[tuple[str, str]], word: str) -> str:
        """The superlative (tallest, lightest, largest, …) that tells the first of each pair from the second.

        Raises:
            NotUnderstoodError: The pictures do not show one.
        """

    def turned_deg(self, pairs: Sequence[tuple[str, str]]) -> float:
        """The clockwise turn [degrees, above -180 to 180] that all pairs (before, after) show.

        Raises:
            NotUnderstoodError: The pictures do not show one.
        """
