"""ChooseMotion: a subtask's motion by marks in a picture: keypoints of two things, and tiles of a grid."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import Field, FiniteFloat

from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning
from wonderful_team.core.later import later
from wonderful_team.core.pictures import Candidates, Grid, Picture

GRASPED, UNATTACHED = "P", "Q"
"""Letters of the keypoints on the thing that is held, and on the one that it is brought to."""


class MotionMarks(AnswerModel):
    """Marks as they are written in the picture. Nobody checks here whether they exist: that shows when they are used."""

    reasoning: str = Reasoning
    grasp_keypoint: str = Field(description="Where the gripper takes hold, such as P2; empty when nothing is held.")
    function_keypoint: str = Field(
        description="The point of the held thing that is to reach the target keypoint; empty when it is the grasp keypoint."
    )
    target_keypoint: str = Field(description="The point that is reached, such as Q1; empty when there is none.")
    pre_contact_tile: str = Field(description="A tile to go to before, such as b3; empty for none.")
    post_contact_tile: str = Field(description="A tile to go to afterwards; empty for none.")
    pre_contact_height: str = Field(description="same (as the contact) or above; empty without a tile.")
    post_contact_height: str = Field(description="The same, of the tile afterwards.")
    target_angle: FiniteFloat = Field(description="How far the held thing is turned, in degrees clockwise; 0 for not.")


@dataclass(frozen=True, eq=False)
class ChooseMotion(Question):
    """Asked once for each subtask.

    Attributes:
        instruction: The subtask's.
        object_grasped, object_unattached: As the subtask names them; "" for none.
        view: The main view with a Candidates mark for each of the two (P and Q) and a Grid.
        step_kinds: What the robot can do.
        earlier: What is done before this subtask and shows in no picture yet, a line each.
    """

    instruction: str
    object_grasped: str
    object_unattached: str
    motion_direction: str
    view: Picture
    step_kinds: tuple[str, ...]
    earlier: tuple[str, ...] = later(())

    def output(self) -> type[AnswerModel]:
        return MotionMarks

    def keypoints(self, letter: str) -> Candidates:
        """The keypoints of one of the two things; none where it is not there."""
        return next((mark for mark in self.view.mark(Candidates) if mark.prefix == letter), Candidates((), letter))

    @property
    def grid(self) -> Grid:
        """The tiles."""
        return self.view.mark(Grid)[0]
