"""The instruction of a task read with its pictures: the language reads the words, the eyes say what the pictures show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from wonderful_team.contracts import ShownSlot
from wonderful_team.contracts.shown import ShownTask
from wonderful_team.offline.language import Understood
from wonderful_team.offline.language.instruction import read_instruction
from wonderful_team.offline.vision.defining import compared, turn_shown_deg


@dataclass(frozen=True, eq=False)
class _Pictures:
    """The pictures of an instruction, looked at only when the words need it."""

    slots: dict[str, ShownSlot]

    def names(self, *kinds: str) -> tuple[str, ...]:
        found = [slot for slot in self.slots.values() if slot.kind in kinds]
        return tuple(slot.name for slot in sorted(found, key=lambda slot: (slot.index is None, slot.index or 0)))

    def compared(self, pairs: Sequence[tuple[str, str]], word: str) -> str:
        return compared([(self.slots[more], self.slots[less]) for more, less in pairs], word)

    def turned_deg(self, pairs: Sequence[tuple[str, str]]) -> float:
        return turn_shown_deg([(self.slots[before], self.slots[after]) for before, after in pairs])


def read_task(task: ShownTask) -> Understood:
    """What a task's instruction asks for, its pictures taken into account.

    Raises:
        NotUnderstoodError: A word is unknown, a new word is not shown clearly, or the words do not make an instruction.
    """
    understood = read_instruction(task.instruction, _Pictures({slot.name: slot for slot in task.slots}))
    return replace(understood, said=task.said)
