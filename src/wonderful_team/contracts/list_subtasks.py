"""ListSubtasks: an instruction as a list of subtasks, each with the thing that is held and the thing that is acted on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import Field

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning, ShownTask, fits


class SubtaskDraft(AnswerModel):
    """One motion with at most one thing in the gripper."""

    instruction: str = Field(description="What is done, in one sentence.", min_length=1)
    object_grasped: str = Field(
        description="The thing that is held, in words by which a detector finds it; empty when nothing is held."
    )
    object_unattached: str = Field(
        description="The thing that it is brought to, or that is pushed, in such words; empty when there is none."
    )
    motion_direction: str = Field(description="Where the motion goes, in words, such as: from left to right.")


class SubtaskList(AnswerModel):
    """What is to be done, in order."""

    reasoning: str = Reasoning
    subtasks: list[SubtaskDraft] = Field(description="Empty only when the instruction is already fulfilled.")


@dataclass(frozen=True, eq=False)
class ListSubtasks(Question):
    """Asked of a planner whose things a detector finds by the names that it gives.

    Attributes:
        step_kinds: What the robot can do.
        advice: What went wrong before.
    """

    task: ShownTask
    step_kinds: tuple[str, ...]
    advice: tuple[str, ...] = ()

    def output(self) -> type[AnswerModel]:
        return SubtaskList

    def validate(self, answer: Any) -> tuple[Any, tuple[str, ...]]:
        fits(subgoals=len(answer.subtasks))
        for number, one in enumerate(answer.subtasks, start=1):
            if not one.object_grasped.strip() and not one.object_unattached.strip():
                raise ValueError(f"subtask {number} names no thing at all")
        return answer, ()
