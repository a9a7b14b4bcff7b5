"""A table being set within an arm's reach, and what a task has beside things: a pen, a sponge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from wonderful_team.core.protocols import Score
from wonderful_team.sims.arms.model import BuiltArm
from wonderful_team.sims.arms.robot import Robot
from wonderful_team.sims.tabletop.goals import Poses
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.placing import Room, Spot
from wonderful_team.sims.tabletop.scene import Scene

if TYPE_CHECKING:
    from wonderful_team.core.actions import Action

ROOM_M: Room = (0.275, -0.35, 0.69, 0.35)
"""Where things are put: within reach, with room for the fingers beside them [m]."""
APART_M = 0.14
"""How far apart the centres of things are that are placed at random: fingers need room [m]."""


class Work(Protocol):
    """What a task does beside moving things: its tool leaves something behind that the scorer looks at, or its steps matter.

    Attributes:
        facts: What planners are told of its tool; "" for the gripper alone.
    """

    facts: str

    def furnish(self, spec: Any) -> None:
        """Add bodies to the specification of the scene."""
        ...

    def begin(self, built: BuiltArm, state: Any, robot: Robot) -> None:
        """The scene is set: give the robot its tool."""
        ...

    def step(self) -> None:
        """Called after every step of physics."""
        ...

    def decorate(self, scene: Any) -> None:
        """Draw what was left behind."""
        ...

    def score(self, poses: Poses) -> Score:
        """Judge it."""
        ...

    def oracle(self, poses: Poses) -> Sequence[Action]:
        """Actions that do it from here; [] when it is done."""
        ...


class Sorting(Protocol):
    """Work in which things have to go somewhere.

    Attributes:
        wants: Their names, in the order in which the task names them.
    """

    wants: tuple[str, ...]

    def arrived(self, name: str, poses: Poses) -> bool:
        """Whether one of them is where it has to go."""
        ...

    def placed_by_hand(self, name: str) -> None:
        """Somebody else than the robot moves a thing."""
        ...


@dataclass
class ArmScene(Scene):
    """A table being set.

    Attributes:
        work: What the task does beside moving things.
        other_container: Another container than the one that things belong in is wanted, where the task has none.
    """

    apart_m: float = APART_M
    side_m: float = ROOM_M[3]
    work: Work | None = None
    other_container: bool = False

    def free_place(
        self, draft: Thing, *, on: Thing | None = None, within: Room | None = None, away: Sequence[Spot] = ()
    ) -> Spot:
        return super().free_place(draft, on=on, within=within or ROOM_M, away=away)

    @property
    def wants_something(self) -> bool:
        return self.work is not None or super().wants_something
