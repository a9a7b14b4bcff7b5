"""An arm that stands still in the picture and reports what it is told to, and a policy that carries a cube past a tower."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tests.motion.block_scenes import LIMITS, Block, affine_top, area, found, scene
from tests.runtime.carrying import carried
from wonderful_team.core.actions import ARM, Action, Gripper, MoveTo
from wonderful_team.core.protocols import Act, Decision, Done, Situation
from wonderful_team.core.values import (
    Fingers,
    Instruction,
    Observation,
    Plan,
    RobotState,
    StepReport,
    Subgoal,
)
from wonderful_team.motion import ground_actions

CAMERA = affine_top()
PX_PER_M = 240.0
CUBE, TOWER = Block(0.40, -0.27, 0.44, -0.23), Block(0.40, -0.02, 0.44, 0.02, 0.12)
FINGERS = Fingers(0.085, 0.02, 0.02)
ARM_LIMITS = replace(LIMITS, fingers=FINGERS)
GOALS = (Subgoal("G1", "the cube stands behind the tower", targets=("T1", "A1")),)


@dataclass
class ArmWorld:
    """Stands still in the picture, and reports what it is told to."""

    fingers: bool = True
    silent: bool = False
    off: dict[int, float] = field(default_factory=dict)
    ran: int = 0
    tool: Any = None

    vocabulary = ARM
    instruction = Instruction("put the cube behind the tower")

    def __post_init__(self) -> None:
        self.limits = ARM_LIMITS if self.fingers else LIMITS
        self.tool = np.array([0.5, 0.3, 0.25])

    def observe(self) -> Observation:
        return Observation({"top": scene(CAMERA, CUBE, TOWER)}, RobotState(self.tool.copy(), 1.0, False))

    def execute(self, action: Action) -> StepReport:
        self.ran += 1
        measured: dict[str, Any] = {}
        if isinstance(action, MoveTo):
            self.tool = action.pose.position_m + (self.off.get(self.ran, 0.001), 0.0, 0.0)
        if not self.silent:
            measured["tool_m"] = tuple(float(value) for value in self.tool)
        if isinstance(action, Gripper) and action.state == "close":
            measured |= {"held_width_m": 0.0391, "holding": True, "yaw_rad": 0.0}
        return StepReport(action, True, measured)

    def stop(self) -> None: ...

    def close(self) -> None: ...


@dataclass
class Carrying:
    """Carries the cube past the tower, once."""

    name: str = "test"

    def decide(self, situation: Situation) -> Decision:
        if situation.attempt:
            return Done("done")
        view = situation.observation.main
        (place,) = CAMERA.project([(0.42, 0.22, 0.0)])
        grounded = {"T1": found(CAMERA, "T1", CUBE), "A1": area("A1", (float(place[0]), float(place[1])))}
        actions = ground_actions(carried("T1", "A1"), grounded, view, situation.limits)
        seen = situation.observation.hash
        plan = Plan(situation.instruction, "planned", GOALS, actions=actions, grounded=grounded, scene_hash=seen)
        return Act(actions, plan)
