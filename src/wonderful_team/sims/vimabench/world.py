"""VIMA-Bench as a world: look, act, stop. Its process is one of its own, and its names stay there."""

from __future__ import annotations

import re
from collections.abc import Mapping

from wonderful_team.core.actions import PICK_PLACE, Action, PickPlace, Push, Vocabulary
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Instruction, Limits, Observation, RobotState, Slot, SlotKind, StepReport, View
from wonderful_team.errors import ConfigError, UnknownNameError, WorldUnavailableError
from wonderful_team.sims.facts import blade_facts, suction_facts
from wonderful_team.sims.vimabench.cameras import CAMERA_NAMES, camera
from wonderful_team.sims.vimabench.client import OPEN_TIMEOUT_S, STEP_TIMEOUT_S, start
from wonderful_team.sims.vimabench.converting import BLADE_M, PICK_LIMITS, PUSH_LIMITS, Converted, converted
from wonderful_team.sims.vimabench.finding import find_installation
from wonderful_team.sims.vimabench.privileged import Episode, VimaTruth
from wonderful_team.sims.vimabench.tasks import TASKS, partitions

PUSH = Vocabulary(("push",))
ORDERED_SLOT = re.compile(r"(frame|before|after)(?:_[a-z]+)*_(\d+)")
"""Names of pictures that belong to a sequence or a pair, as in frame_0 and before_twist_1."""


class VimaWorld:
    """Implements the World protocol with one environment of the user's own, unmodified `vima_bench`.

    Attributes:
        task, seed, partition: Which episode this is; a task's name may say its level, as in "rotate@L3".
        horizon: How many actions are judged: what the benchmark's own evaluation allows.
        versions: Of what the simulator runs on.
        privileged: The truth, for scorers and simulated models only; fetched when it is asked for.

    Raises:
        ConfigError: The benchmark is not there (says how to get it), or the seed is negative.
        UnknownNameError: No such task or level.
        WorldUnavailableError: The simulator cannot set up this seed, or failed.
    """

    def __init__(self, task: str, seed: int = 0, *, partition: str | None = None) -> None:
        task, _, level = task.removeprefix("vimabench/").partition("@")
        self.task, self.seed, self.partition = task, seed, partition or level or None
        if task not in TASKS:
            raise UnknownNameError("task", task, TASKS)
        if self.partition is not None and self.partition not in partitions(task):
            raise UnknownNameError(f"partition of {task}", self.partition, partitions(task))
        if seed < 0:
            raise ConfigError(f"seed {seed}: must be 0 or more")
        installation = find_installation()
        self._simulator = start(installation)
        try:
            said, pictures = self._simulator.ask(
                "open",
                timeout_s=OPEN_TIMEOUT_S,
                path=installation.path,
                task=task,
                level=self.partition or "",
                seed=seed,
            )
        except BaseException:
            self._simulator.close()
            raise
        self.vocabulary: Vocabulary = PUSH if said["tool"] == "spatula" else PICK_PLACE
        self.limits: Limits = PUSH_LIMITS if said["tool"] == "spatula" else PICK_LIMITS
        self.facts = blade_facts(BLADE_M) if said["tool"] == "spatula" else suction_facts()
        self.horizon = int(said["horizon"])
        self.versions = {str(name): str(version) for name, version in said["versions"].items()}
        self.instruction = _instruction(str(said["instruction"]), said["slots"], pictures)
        self._cpu_clock = bool(said["cpu_clock"])
        self._looks = [_observation(pictures, float(said["time_s"]), None)]
        episode = Episode(task, seed, self.vocabulary, self.instruction, self._looks)
        self._broken = ""
        self._stopped = False
        self.privileged = VimaTruth(self._simulator, episode)

    @property
    def looks(self) -> tuple[Observation, ...]:
        """What could be seen at the start and after every action so far."""
        return tuple(self._looks)

    @property
    def notes(self) -> tuple[str, ...]:
        """What a user should know of how this world runs."""
        if self._cpu_clock:
            return ()
        return (
            "this copy of VIMA-Bench counts its limits on motion by the wall clock: a busy machine may break trials",
        )

    @property
    def time_s(self) -> float:
        """Simulated time [s]."""
        return self._looks[-1].main.time_s

    def observe(self) -> Observation:
        """Both views as they are now; nothing changes between actions, so looking twice gives the same picture."""
        self._check_open()
        return self._looks[-1]

    def execute(self, action: Action) -> StepReport:
        """Run one action.

        Raises:
            ConfigError: The action is of a kind that this world does not run, or the world is closed.
            WorldUnavailableError: The simulator failed, or its arm did not arrive within its time: nothing that a
                method did wrong, so the trial is an error and not a failure. It is not tried again by itself.
        """
        self._check_open()
        if action.kind not in self.vocabulary.kinds or not isinstance(action, (PickPlace, Push)):
            raise ConfigError(f"this world runs {', '.join(self.vocabulary.kinds)}; got {action.kind}")
        if self._broken:
            raise WorldUnavailableError(self._broken)
        done = "the world was stopped" if self._stopped else converted(action)
        if isinstance(done, str):
            return StepReport(action, False, {}, done)
        said, pictures = self._simulator.ask("step", done.arrays, timeout_s=STEP_TIMEOUT_S)
        self._looks.append(_observation(pictures, float(said["time_s"]), said["held"]))
        if said["late"]:
            self._broken = (
                "the simulator's arm did not arrive within its limit of 5 s a motion: an error of the simulator, "
                "not scored; run the trial again"
            )
            raise WorldUnavailableError(self._broken)
        return StepReport(action, True, _measured(action, done, said["held"]))

    def stop(self) -> None:
        """Nothing moves any more until a new world is made."""
        self._stopped = True

    def close(self) -> None:
        """End the simulator's process; safe to call twice."""
        self._simulator.close()

    def _check_open(self) -> None:
        if not self._simulator.alive:
            raise ConfigError("this world is closed; make a new one")


def _measured(action: PickPlace | Push, done: Converted, held: bool | None) -> dict[str, object]:
    if isinstance(action, PickPlace):
        return {"held": bool(held), "turned_rad": round(float(action.yaw_rad), 4) if held else 0.0}
    assert done.end_m is not None, "a push ends somewhere"
    short = float(((action.end_m[:2] - done.end_m) ** 2).sum() ** 0.5)
    return {
        "start_m": tuple(round(float(value), 4) for value in action.start_m[:2]),
        "end_m": tuple(round(float(value), 4) for value in done.end_m),
        "short_of_end_m": round(short, 4),
    }


def _observation(pictures: Mapping[str, Array], time_s: float, held: bool | None) -> Observation:
    views = {name: View(name, name, time_s, pictures[f"view:{name}"], None, camera(name)) for name in CAMERA_NAMES}
    return Observation(views, RobotState(None, None, False if held is not None else None))


def _instruction(text: str, slots: list[list[str]], pictures: Mapping[str, Array]) -> Instruction:
    found = {}
    for index, (name, type_) in enumerate(slots):
        kind, place = _kind(name, type_)
        views = {one: View(f"slot:{name}:{one}", one, 0.0, pictures[f"slot:{index}:{one}"]) for one in CAMERA_NAMES}
        found[name] = Slot(name, kind, views, place)
    return Instruction(text, {name: found[name] for name in sorted(found, key=lambda name: text.find(f"{{{name}}}"))})


def _kind(name: str, type_: str) -> tuple[SlotKind, int | None]:
    """What a picture is for: the benchmark says object or scene, and its name says the rest."""
    if type_ == "object":
        return "object", None
    match = ORDERED_SLOT.fullmatch(name)
    if match is None:
        return "scene", None
    kinds: dict[str, SlotKind] = {"frame": "frame", "before": "before", "after": "after"}
    return kinds[match[1]], int(match[2])
