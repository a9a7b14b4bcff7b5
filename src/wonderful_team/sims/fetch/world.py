"""A Fetch at a table as planners meet it: look, act, stop. Its simulator is a process of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from wonderful_team.core.actions import Action, Gripper, Home, MoveTo, Vocabulary
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Fingers, Instruction, Limits, Observation, RobotState, StepReport, View
from wonderful_team.errors import ConfigError, WorldUnavailableError
from wonderful_team.sims.arms import reports
from wonderful_team.sims.arms.cameras import sensed
from wonderful_team.sims.arms.tasks import MOVES
from wonderful_team.sims.fetch.cameras import CAMERA_NAMES, SIZE_PX, lenses
from wonderful_team.sims.fetch.driver import FULLY_OPEN_M, Driver, Felt, Moved
from wonderful_team.sims.fetch.finding import OPEN_TIMEOUT_S, find_python, start
from wonderful_team.sims.fetch.privileged import Episode, FetchTruth
from wonderful_team.sims.fetch.remote.bench import ASSETS
from wonderful_team.sims.fetch.scene import ORIGIN_M, body_name, model_xml, set_table
from wonderful_team.sims.fetch.tasks import TASKS, asked
from wonderful_team.sims.tabletop.seeds import generator

VOCABULARY = Vocabulary(("move_to", "gripper", "home"))
LOW_M, HIGH_M = (0.03, -0.33, 0.0), (0.38, 0.33, 0.45)
"""What the tool reaches pointing straight down [m]."""
FINGERS = Fingers(opening_m=0.1, thickness_m=0.015, breadth_m=0.027, turns=False)
STEP_TIMEOUT_S = 60.0
"""A step takes about a millisecond."""
ATTEMPTS = 3
"""So many times what one attempt takes may run."""
SETTLE_STEPS = 25
FACTS = """\
Robot: a Fetch, a mobile robot with one arm, at the upper edge of the top view.
Tool: a gripper with two parallel fingers that points straight down and does not turn. The fingers come down to the left and to the \
right of a thing, as the top view shows it, open 10 cm and hold one thing at a time; what is wider from left to right cannot be held. \
They need free space there.
What is lifted by a handle comes along with it. Nothing passes through a lid or a wall.
End every task with home: the arm then stands beside the table, out of the top view, and everything can be seen.
Every way across the table is made clear of everything; the tool goes down only over where it is to be.
Reach: the table but for about 12 cm at its lower edge, and nothing beyond.
Views: the top camera looks straight down; the front camera looks from the side that is the lower edge of the top view.
North is the upper edge of the top view, south the lower, west the left, east the right."""


class FetchWorld:
    """Implements the World protocol with gymnasium-robotics' Fetch in a scene of ours.

    Attributes:
        task, seed: Which scene this is; a task's name may say how bad its depth sensor is, as in "lid@depth=2".
        horizon: How many actions may run.
        versions: Of what the simulator runs on.
        privileged: The truth, for scorers and simulated models only; fetched when it is asked for.

    Raises:
        ConfigError: The simulator is not there (says how to get it), or the seed is negative.
        UnknownNameError: No such task.
        WorldUnavailableError: The simulator failed.
    """

    vocabulary = VOCABULARY
    facts = FACTS

    def __init__(self, task: str, seed: int = 0, *, depth: int = 0) -> None:
        self.task, self._depth = asked(task.removeprefix("fetch/"), depth)
        self.seed = seed
        if seed < 0:
            raise ConfigError(f"seed {seed}: must be 0 or more")
        count = TASKS[self.task]
        self.horizon = ATTEMPTS * (count + 1) * MOVES
        self.limits = Limits(LOW_M, HIGH_M, clearance_m=0.22, fingers=FINGERS)
        scene = set_table(seed, count)
        self.instruction = Instruction(scene.words)
        self._lenses = lenses()
        self._simulator = start(find_python())
        try:
            said, _ = self._simulator.ask(
                "open",
                timeout_s=OPEN_TIMEOUT_S,
                xml=model_xml(scene, self._lenses, ASSETS),
                bodies=[body_name(scene, name) for name in scene.things],
                size_px=list(SIZE_PX),
            )
            self._episode = Episode(self.task, seed, scene)
            self._began_s = float(said["time_s"])
            self.versions = {str(name): str(version) for name, version in said["versions"].items()}
            self._driver = Driver(self._step, _felt(said))
            self._driver.home()
            self._driver.grip(False)
            self._driver.rest(SETTLE_STEPS)
            self._began_s = self._driver.felt.time_s
            self._stopped = False
            self._held = False
            self._moved = True
            self.observe()
        except BaseException:
            self._simulator.close()
            raise
        self.privileged = FetchTruth(self._simulator, self._episode)

    @property
    def time_s(self) -> float:
        """Simulated time [s]."""
        return self._driver.felt.time_s - self._began_s

    def observe(self) -> Observation:
        """Both views as they are now, drawn anew only when something was done."""
        self._check_open()
        if not self._moved:
            return self._episode.looks[-1][0]
        said, pictures = self._simulator.ask("look", cameras=list(CAMERA_NAMES))
        views = {}
        for name in CAMERA_NAMES:
            depth = np.asarray(pictures[f"depth:{name}"])
            if self._depth:
                depth = sensed(depth, self._depth, generator(self.seed, f"depth {name}", len(self._episode.looks)))
            rgb = np.asarray(pictures[f"rgb:{name}"])
            views[name] = View(name, name, self.time_s, rgb, depth, self._lenses[name].camera)
        felt = self._driver.felt
        share = float(np.clip(felt.opening_m / FULLY_OPEN_M, 0.0, 1.0))
        observation = Observation(views, RobotState(felt.tool_m.copy(), share, self._driver.holding))
        self._episode.looks.append((observation, int(said["look"])))
        self._moved = False
        return observation

    def execute(self, action: Action) -> StepReport:
        """Run one action: as many of the simulator's own 4-D steps as it needs, and no more than its length allows.

        Raises:
            ConfigError: The action is of a kind that this world does not run, or the world is closed.
            WorldUnavailableError: The simulator failed.
        """
        self._check_open()
        if action.kind not in self.vocabulary.kinds:
            raise ConfigError(f"this world runs {', '.join(self.vocabulary.kinds)}; got {action.kind}")
        if self._stopped:
            return StepReport(action, False, self._measured(None), reports.REASONS["stop"])
        driver = self._driver
        fault, moved = "", None
        self._moved = True
        match action:
            case MoveTo(pose=pose):
                fault = _not_possible(action)
                if not fault and driver.parked:
                    moved = driver.from_home(pose.position_m)
                if not fault and (moved is None or not moved.stopped_by):
                    moved = driver.move(pose.position_m)
            case Gripper(state=state):
                moved = driver.grip(state != "open", state == "tight")
                if state == "open":
                    driver.rest(SETTLE_STEPS)
                else:
                    self._episode.closings += 1
            case _:
                assert isinstance(action, Home)
                moved = driver.home()
        held, self._held = self._held, driver.holding
        return reports.report(action, fault, moved, self._measured(moved), held=held, holding=driver.holding)

    def stop(self) -> None:
        """The arm stays where it is from the next step on, and what it holds stays held, until a new world is made."""
        self._stopped = True
        self._driver.halt()

    def film(self, each: Callable[[Mapping[str, Array]], None] | None, every_s: float = 0.1) -> None:
        """Hand pictures of both cameras to `each` while an action runs; for people: no planner is shown them."""
        due = self.time_s

        def watch() -> None:
            nonlocal due
            if each is not None and self.time_s >= due:
                due = self.time_s + every_s
                each(dict(self._simulator.ask("film", cameras=list(CAMERA_NAMES))[1]))

        self._driver.watch = None if each is None else watch

    def close(self) -> None:
        """End the simulator's process; safe to call twice."""
        self._simulator.close()

    def _step(self, action: Array) -> Felt:
        return _felt(self._simulator.ask("step", {"action": action}, timeout_s=STEP_TIMEOUT_S)[0])

    def _measured(self, moved: Moved | None) -> dict[str, Any]:
        return reports.measured(self._driver.felt.tool_m, self._driver.felt.opening_m, self._driver.holding, moved)

    def _check_open(self) -> None:
        if not self._simulator.alive:
            raise ConfigError("this world is closed; make a new one")


def _felt(said: Mapping[str, Any]) -> Felt:
    try:
        return Felt.of(said, np.asarray(ORIGIN_M))
    except ValueError as error:
        raise WorldUnavailableError(str(error)) from error


def _not_possible(action: MoveTo) -> str:
    """Why the arm cannot go to a pose; "" when it can."""
    far = reports.out_of_reach(action.pose.position_m[None], LOW_M, HIGH_M)
    if far:
        return far
    turn = action.pose.rotation
    if turn[2, 2] < np.cos(reports.LEANS_RAD):
        return "the pose leans over; this arm points straight down"
    if abs(turn[0, 0]) < np.cos(reports.LEANS_RAD):
        return f"the pose is turned by {np.degrees(action.pose.yaw_rad):.0f} degrees; this gripper does not turn"
    return ""
