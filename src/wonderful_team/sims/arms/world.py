"""An arm at a table as planners meet it: look, act, stop."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from wonderful_team.core.actions import ARM, Action, Gripper, Home, MoveTo, RotateGripper, Trajectory, Vocabulary
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Fingers, Limits, RobotState, StepReport
from wonderful_team.errors import ConfigError
from wonderful_team.sims.arms import reports
from wonderful_team.sims.arms.cameras import REACH_HIGH_M, REACH_LOW_M
from wonderful_team.sims.arms.held import HeldTool
from wonderful_team.sims.arms.model import upright
from wonderful_team.sims.arms.options import asked as read_options
from wonderful_team.sims.arms.privileged import ArmTruth
from wonderful_team.sims.arms.reports import Moved
from wonderful_team.sims.arms.rows import ArmRow, check_ready, find_arm
from wonderful_team.sims.arms.table import ArmTable
from wonderful_team.sims.arms.tasks import find_arm_task
from wonderful_team.sims.tabletop.simulated_world import SimulatedWorld

LOW_M = 0.14
"""A path whose points lie lower than this runs along a surface; in the air it lies at the clearance or higher [m]."""
SEEK_M = 0.006
"""How far below its first low point a path's surface is looked for by touch [m]."""
TRACED = 60
"""Most points of a measured path that a report holds."""


class ArmWorld(SimulatedWorld[ArmTable, ArmTruth]):
    """Implements the World protocol with an arm that really grips; time is simulated, and everything follows from the seed.

    Attributes:
        task, seed, arm: Which scene this is; a task's name may say more of it, see `options.py`: "block_in_bowl@depth=2".
        horizon: How many actions may run.
        privileged: The truth, for scorers and simulated models only.
    """

    def __init__(
        self,
        task: str,
        seed: int = 0,
        *,
        arm: str | None = None,
        depth: int = 0,
        calibration: int = 0,
        camera: int = 0,
    ) -> None:
        check_ready()
        if seed < 0:
            raise ConfigError(f"seed {seed}: must be 0 or more")
        wanted = read_options(task.removeprefix("arms/"), arm, depth, calibration, camera)
        found, row = find_arm_task(wanted.task), find_arm(wanted.arm)
        self.task, self.seed, self.arm, self.horizon = found.name, seed, wanted.arm, found.horizon
        self.vocabulary: Vocabulary = ARM
        fingers = Fingers(row.opening_m, row.thickness_m, row.breadth_m)
        self.limits = Limits(REACH_LOW_M, REACH_HIGH_M, fingers=fingers)
        self._table = ArmTable(found, seed, wanted)
        self.facts = _facts(row, self._table)
        self._stopped, self._held = False, self._table.robot.holding
        self.privileged = ArmTruth(self._table)

    def _robot(self) -> RobotState:
        robot = self._table.robot
        share = min(1.0, robot.opening_m / self._table.built.row.opening_m)
        return RobotState(robot.tool_m.copy(), share, robot.holding)

    def execute(self, action: Action) -> StepReport:
        """Run one action to its end under physics.

        Raises:
            ConfigError: The world is closed, or does not run such actions.
        """
        if self._table.closed:
            raise ConfigError("this world is closed; make a new one")
        if action.kind not in self.vocabulary.kinds:
            raise ConfigError(f"this world runs {', '.join(self.vocabulary.kinds)}; got {action.kind}")
        if self._stopped:
            return StepReport(action, False, self._measured(None), reports.REASONS["stop"])
        robot = self._table.robot
        match action:
            case MoveTo(pose=pose):
                fault = reports.out_of_reach(pose.position_m[None], REACH_LOW_M, REACH_HIGH_M)
                if upright(pose.quaternion_wxyz) > reports.LEANS_RAD:
                    fault = "the pose leans over; this arm points straight down"
                moved = None if fault else robot.move(pose.position_m, pose.yaw_rad)
            case Gripper(state=state):
                fault, moved = "", self._table.grip(state != "open", state == "tight")
            case RotateGripper(yaw_rad=yaw):
                fault, moved = "", robot.rotate(yaw)
            case Trajectory(waypoints_m=points):
                fault = reports.out_of_reach(points, REACH_LOW_M, REACH_HIGH_M)
                moved = None if fault else self._follow(points)
            case _:
                assert isinstance(action, Home)
                fault, moved = "", robot.park()
        found = self._measured(moved)
        robot.trace = None
        held, self._held = self._held, robot.holding
        return reports.report(action, fault, moved, found, held=held, holding=robot.holding)

    def _follow(self, points_m: Array) -> Moved:
        """Along a path: where it is low, down until the tool touches the surface, and then along it."""
        robot, off_m, before_low = self._table.robot, 0.0, False
        moved, force = Moved(0.0, 0.0, 0.0), 0.0
        # How it stands at its parking place says nothing: from there it comes straight.
        yaw = 0.0 if robot.parked else robot.yaw_rad
        for point in points_m:
            low = float(point[2]) < LOW_M
            goal = np.asarray(point) + np.array([0.0, 0.0, off_m if low else 0.0])
            moved = robot.move(goal, yaw, touching=low and before_low)
            if low and not before_low:
                if not moved.stopped_by:
                    moved = robot.move(goal - np.array([0.0, 0.0, SEEK_M]), yaw)
                if moved.stopped_by in ("", "contact"):
                    # What the fingers hold may have crept up: a tool that touches nothing yet is pressed down all the same.
                    off_m = float(robot.tool_m[2]) - float(point[2])
                    moved = Moved(0.0, moved.error_rad, moved.force_n)
                    robot.press()
            before_low = low
            if robot.trace is None:
                # The way to the first point is the arm's own; from there on the path is followed, and measured.
                robot.trace = [robot.tool_m]
            force = max(force, moved.force_n)
            if moved.stopped_by:
                break
        return Moved(moved.error_m, moved.error_rad, force, moved.stopped_by)

    def _measured(self, moved: Moved | None) -> dict[str, Any]:
        robot = self._table.robot
        found = reports.measured(robot.tool_m, robot.opening_m, robot.holding, moved)
        found["yaw_rad"] = round(robot.yaw_rad, 4)
        if robot.trace:
            found["path_m"] = [tuple(round(float(v), 4) for v in point) for point in evenly(robot.trace, TRACED)]
        return found

    def stop(self) -> None:
        """The arm stays where it is from the next command on, and what it holds stays held, until a new world is made."""
        self._stopped = True
        self._table.robot.halt()


def evenly(points: Sequence[Array], most: int) -> list[Array]:
    """At most so many of the points, the first and the last among them."""
    kept = np.unique(np.linspace(0, len(points) - 1, min(most, len(points))).round().astype(int))
    return [points[k] for k in kept]


def _facts(row: ArmRow, table: ArmTable) -> str:
    """What planners are told, one fact a line."""
    width, work = 1000 * row.opening_m, table.work
    tool = [
        f"Tool: a gripper with two parallel fingers, pointing straight down. It opens {width:.0f} mm and holds one thing at a time; "
        "what is wider across its narrowest side cannot be held. The fingers need free space on both sides of the thing. How "
        "the gripper is turned to grip is computed from depth.",
        "The gripper turns at most once round, less where its wrist reaches its end: such a turn is refused.",
    ]
    if work is not None and work.facts:
        tool = [work.facts] if isinstance(work, HeldTool) else [*tool, work.facts]
    return "\n".join(
        (
            f"Robot: {row.words}, bolted down at the upper edge of the top view.",
            *tool,
            "End every task with home: the arm then stands out of the top view, and everything can be seen.",
            "Every way across the table is made clear of everything; the tool goes down only over where it is to be.",
            f"Reach: {100 * (REACH_HIGH_M[1] - REACH_LOW_M[1]):.0f} cm from left to right and {100 * (REACH_HIGH_M[0] - REACH_LOW_M[0]):.0f} cm from "
            "top to bottom of the top view, in the middle of the table; nothing beyond.",
            f"Views: the top camera looks {'down a little aslant' if table.asked.camera else 'straight down'}; the front camera looks from the side that is the lower edge of the top view.",
            "North is the upper edge of the top view, east its right edge.",
            "A turn without a direction is clockwise, seen from above.",
        )
    )
