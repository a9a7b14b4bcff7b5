"""A plan that has something of everything that a plan can hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.runtime.runtime_fake_run import world_with_pictures
from tests.runtime.runtime_fakes import make_plan
from wonderful_team.core.actions import Beside, FollowStep, MoveStep, MoveTo, OriginOf, PushStep, Trajectory
from wonderful_team.core.geometry import Box, Pose
from wonderful_team.core.values import Critique, FunctionBox, HelperFunction, KeepOut, Plan, PlannedAction


def rich_plan() -> Plan:
    world = world_with_pictures()
    plan = make_plan(world.observe(), [((60.0, 60.0), (200.1 / 3, 30.0))], instruction=world.instruction)
    pose = Pose(np.array([0.5, 0.1, 0.2]), np.array([0.3, 0.1, -0.7, 0.2]))
    more = (
        PlannedAction(MoveStep("G1", Beside("T1", "left"), "above"), MoveTo(pose)),
        PlannedAction(FollowStep("G1", "G1"), Trajectory(np.random.default_rng(1).random((4, 3)))),
        PlannedAction(PushStep("G1", OriginOf("T1"), Beside("T2", "above")), None),
    )
    return replace(
        plan,
        actions=plan.actions + more,
        steps=plan.steps + tuple(item.step for item in more),
        keep_out=(KeepOut("cup", Box(1, 2, 3.5, 4), "px"),),
        questions=(Critique("G1", "collision", "Is it free?", "Yes.", False, "offline"),),
        parent="0123456789ab",
        choices=("red", "blue"),
        functions=(
            HelperFunction(
                "path_1",
                "a path round T1",
                "def path(boxes):\n    return [(1, 2), (3, 4)]",
                (FunctionBox("T1", "the cup", Box(1, 2, 3.5, 4)),),
                ((1.0, 2.0, 0.0), (3.0, 4.0, 0.05)),
            ),
        ),
    )
