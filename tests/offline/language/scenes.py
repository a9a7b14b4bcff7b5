"""Scenes of the tabletop's tasks as the language sees them: words and kinds of pictures, no pixels."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from tests.offline.language.wordings import MOST_SEEDS, Wording
from wonderful_team.core.values import SlotKind
from wonderful_team.offline.language import Understood
from wonderful_team.offline.language.instruction import read_instruction
from wonderful_team.sims.tabletop.registering import filled, find_task

TURN_DEG = 60.0


@dataclass(frozen=True)
class StandIn:
    """Pictures that show what they should: the first of each pair is taller, and a turn is always the same."""

    kinds: tuple[tuple[str, SlotKind, int | None], ...]

    def names(self, *kinds: str) -> tuple[str, ...]:
        found = [item for item in self.kinds if item[1] in kinds]
        return tuple(name for name, _, _ in sorted(found, key=lambda item: (item[2] is None, item[2] or 0)))

    def compared(self, pairs: Sequence[tuple[str, str]], word: str) -> str:
        first = {more.startswith("demo_blicker") for more, _ in pairs}
        assert len(pairs) == 3
        assert len(first) == 1
        return "tallest" if first.pop() else "shortest"

    def turned_deg(self, pairs: Sequence[tuple[str, str]]) -> float:
        assert all(before[-1] == after[-1] for before, after in pairs)
        return TURN_DEG


@dataclass(frozen=True)
class Told:
    """A scene in words."""

    instruction: str
    words: dict[str, str]
    shows: StandIn

    def read(self, text: str) -> Understood:
        """A text read with the pictures that it names."""
        named = set(re.findall(r"\{([^{}]+)\}", text))
        return read_instruction(text, StandIn(tuple(item for item in self.shows.kinds if item[0] in named)))


@cache
def told(task: str, seed: int) -> Told:
    """The scene of a task and seed."""
    found = find_task(task)
    scene = found.scene(seed)
    kinds = tuple((name, shown.kind, shown.index) for name, shown in scene.pictures.items())
    return Told(filled(found.instruction, scene.words), dict(scene.words), StandIn(kinds))


def told_for(wording: Wording) -> Told:
    """The first scene whose words a wording presumes."""
    return next(scene for seed in range(MOST_SEEDS) if wording.suits((scene := told(wording.task, seed)).words))
