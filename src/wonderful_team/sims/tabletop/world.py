"""A table as a robot meets it: look, act, stop."""

from __future__ import annotations

import math

from wonderful_team.core.actions import Action, PickPlace, Push, Vocabulary
from wonderful_team.core.values import Limits, RobotState, StepReport
from wonderful_team.errors import ConfigError
from wonderful_team.sims.facts import blade_facts, suction_facts
from wonderful_team.sims.tabletop.cameras import TABLE_HIGH_M, TABLE_LOW_M
from wonderful_team.sims.tabletop.model import BLADE_HALF_M
from wonderful_team.sims.tabletop.options import Tiers, asked
from wonderful_team.sims.tabletop.privileged import TabletopTruth
from wonderful_team.sims.tabletop.registering import find_task
from wonderful_team.sims.tabletop.simulated_world import SimulatedWorld
from wonderful_team.sims.tabletop.spatula import SHORTEST_M
from wonderful_team.sims.tabletop.suction import CUP_RADIUS_M, LIFT_M
from wonderful_team.sims.tabletop.table import Table

MOST_TURN_RAD = 2 * math.pi + 1e-6


class TabletopWorld(SimulatedWorld[Table, TabletopTruth]):
    """Implements the World protocol; time is simulated, and everything follows from the seed.

    Attributes:
        task, seed, partition, tiers: Which scene this is; a task's name may say more of it, see `options.py`:
            "rotate@L3", "rotate@small" for pictures of 256 x 128 px, "rotate@clutter=2".
        horizon: How many actions are judged.
        privileged: The truth, for scorers and simulated models only.
    """

    def __init__(
        self,
        task: str,
        seed: int = 0,
        *,
        size_px: tuple[int, int] | None = None,
        recolour: int | None = None,
        renderer: str | None = None,
        partition: str | None = None,
        clutter: int = 0,
        lighting: int = 0,
        camera: int = 0,
        texture: int = 0,
    ) -> None:
        wanted = asked(task, partition, size_px, Tiers(clutter, lighting, camera, texture))
        found, partition = find_task(wanted.task), wanted.partition
        if seed < 0 or (recolour is not None and recolour < 0):
            raise ConfigError(f"seed and recolour must be 0 or more, got {seed} and {recolour}")
        if renderer not in (None, "rays"):
            raise ConfigError(f"renderer: expected None (the best that works here) or 'rays', got {renderer!r}")
        self.task, self.seed, self.horizon = found.name, seed, found.horizon
        self.partition, self.tiers = partition, wanted.tiers
        self.vocabulary: Vocabulary = found.vocabulary
        blade_m = 2 * BLADE_HALF_M[1] if "push" in self.vocabulary.kinds else None
        self.limits = Limits(TABLE_LOW_M, TABLE_HIGH_M, clearance_m=LIFT_M, blade_m=blade_m, lift_m=LIFT_M)
        self.facts = suction_facts(2 * CUP_RADIUS_M) if blade_m is None else blade_facts(blade_m)
        self._table = Table(
            found, seed, wanted.size_px, recolour=recolour, renderer=renderer, partition=partition, tiers=wanted.tiers
        )
        self._stopped = False
        self.privileged = TabletopTruth(self._table)

    def _robot(self) -> RobotState:
        tool = self._table.tool
        return RobotState(tool.tool_m.copy(), None, tool.holding)

    def execute(self, action: Action) -> StepReport:
        """Run one action.

        Raises:
            ConfigError: The action is of a kind that this world does not run, or the world is closed.
        """
        if self._table.closed:
            raise ConfigError("this world is closed; make a new one")
        if action.kind not in self.vocabulary.kinds or not isinstance(action, (PickPlace, Push)):
            raise ConfigError(f"this world runs {', '.join(self.vocabulary.kinds)}; got {action.kind}")
        fault = "the world was stopped" if self._stopped else _out_of_reach(action)
        if fault:
            return StepReport(action, False, {}, fault)
        return StepReport(action, True, self._table.run(action))

    def stop(self) -> None:
        """Nothing moves any more until a new world is made."""
        self._stopped = True


def _out_of_reach(action: PickPlace | Push) -> str:
    if isinstance(action, PickPlace):
        points = (("pick", action.pick_m), ("place", action.place_m))
    else:
        points = (("start", action.start_m), ("end", action.end_m))
    for role, point in points:
        for axis in (0, 1):
            low, high, value = TABLE_LOW_M[axis], TABLE_HIGH_M[axis], float(point[axis])
            if not low <= value <= high:
                return f"{role} {'xy'[axis]} = {value:.3f} m is out of reach [{low}, {high}] m"
    if isinstance(action, PickPlace) and abs(action.yaw_rad) > MOST_TURN_RAD:
        return f"a turn of {action.yaw_rad:.3g} rad is more than once round (limit {MOST_TURN_RAD:.3f} rad)"
    if isinstance(action, Push):
        length = math.dist(action.start_m[:2], action.end_m[:2])
        if length < SHORTEST_M:
            return f"a push of {length:.4f} m has no direction; the shortest is {SHORTEST_M} m"
    return ""
