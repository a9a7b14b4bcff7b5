"""One environment: made, looked at, stepped. What an agent may know goes out here; truth only where it is asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .goals import Goals
from .loading import Missing, load, specs, use_cpu_clock, versions
from .scene import Scene

CAMERAS = ("top", "front")
STEPS_PER_S = 240.0
BONUS_STEPS = 2
"""The benchmark's own evaluation lets an agent act this much longer than its oracle needs at most."""
END_EFFECTORS = ("suction", "spatula")
MOVED_M = 0.004
"""How far a thing must have moved to count as moved [m]."""

Reply = tuple[dict[str, Any], dict[str, Any]]

__all__ = ["Bench", "BenchError", "Missing"]


class BenchError(Exception):
    """What was asked for cannot be done; `kind` tells the other side what to make of it."""

    def __init__(self, kind: str, text: str) -> None:
        super().__init__(text)
        self.kind = kind


class Bench:
    """Holds at most one environment: its utilities work on the first physics client of a process only."""

    def __init__(self) -> None:
        self._env: Any = None
        self._looks: list[Mapping[str, Mapping[str, Any]]] = []
        self._history: list[dict[str, Any]] = []
        self._late = False
        self._held: bool | None = None

    def ask(self, what: str, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        """Answer one question.

        Raises:
            BenchError: No such question, or none before "open".
        """
        known: dict[str, Callable[[Mapping[str, Any], Mapping[str, Any]], Reply]] = {
            "hello": self._hello,
            "open": self._open,
            "step": self._step,
            "score": self._score,
            "truth": self._truth,
            "things": self._things,
            "masks": self._masks,
            "slot_masks": self._slot_masks,
            "oracle": self._oracle,
            "close": self._close,
        }
        if what not in known or (self._env is None and what not in ("hello", "open", "close")):
            raise BenchError("usage", f"cannot answer {what!r} now")
        return known[what](said, arrays)

    # -- what an agent may know ------------------------------------------------------------------------------------

    def _hello(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        load(str(said["path"]))
        return {"versions": versions()}, {}

    def _open(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        module = load(str(said["path"]))
        task, level = str(said["task"]), str(said["level"])
        try:
            more = specs(module, level, task) if level else None
        except (KeyError, IndexError, ValueError) as error:
            raise BenchError("config", f"{task} does not exist at level {level}") from error
        env = module.make(task, seed=int(said["seed"]), task_kwargs=more, modalities=["rgb", "segm"])
        # It changes at the first reset in one task; the benchmark's own evaluation reads it before.
        horizon = int(env.task.oracle_max_steps) + BONUS_STEPS
        cpu_clock = use_cpu_clock(env)
        self._watch_the_arm(env)
        try:
            observed = env.reset()
        except ValueError as error:
            text = (
                f"VIMA-Bench could not set up this scene ({error}); it gives up after some tries at random. The seed is "
                "kept as asked for: choose another one"
            )
            raise BenchError("unavailable", text) from error
        self._env = env
        self._watch_the_cup(env)
        self._looks = [observed]
        self._scene = Scene(env, observed["segm"])
        self._goals = Goals(env, self._scene, horizon)
        reply = {
            "instruction": str(env.prompt),
            "slots": [[str(name), str(asset["placeholder_type"])] for name, asset in env.prompt_assets.items()],
            "tool": END_EFFECTORS[int(observed["ee"])],
            "horizon": horizon,
            "time_s": self._time_s(),
            "cpu_clock": cpu_clock,
            "versions": versions(),
        }
        pictures = {f"view:{name}": _upright(observed["rgb"][name]) for name in CAMERAS}
        for index, asset in enumerate(env.prompt_assets.values()):
            for name in CAMERAS:
                pictures[f"slot:{index}:{name}"] = _upright(asset["rgb"][name])
        return reply, pictures

    def _step(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        if self._late:
            raise BenchError("late", "the arm did not arrive in an earlier action")
        names = ("pose0_position", "pose0_rotation", "pose1_position", "pose1_rotation")
        action = {name: np.array(arrays[name], dtype=np.float32) for name in names}
        if not self._env.action_space.contains(action):
            raise BenchError("bounds", f"the environment's action space does not hold {action!r}")
        self._held = None
        before, picked = self._scene.poses(), self._scene.under(self._looks[-1]["segm"]["top"], action)
        info: Mapping[str, Any] = {}
        try:
            observed, _, _, info = self._env.step(action)
            self._looks.append(observed)
        except Exception:
            # After an episode has ended the simulator still moves, but its judging may not bear it.
            if not self._goals.ended:
                raise
            self._looks.append(self._env._get_obs())  # noqa: SLF001  there is no other way to look
        after = self._scene.poses()
        moved = [name for name in after if float(np.linalg.norm(after[name][0] - before[name][0])) > MOVED_M]
        self._history.append(dict(picked, moved=moved))
        if not self._late:
            self._goals.stepped(bool(info.get("success", False)), bool(info.get("failure", False)))
        reply = {"late": self._late, "held": self._held, "time_s": self._time_s()}
        return reply, {f"view:{name}": _upright(self._looks[-1]["rgb"][name]) for name in CAMERAS}

    # -- truth, for scorers and simulated models -------------------------------------------------------------------

    def _score(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        return dict(self._goals.judged(), late=self._late, history=self._history), {}

    def _truth(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        return dict(self._goals.told(), **self._scene.shown_things()), {}

    def _things(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        now = self._scene.things(self._looks[-1]["segm"]["top"])
        return {"things": self._scene.start if said["when"] == "start" else now}, {}

    def _masks(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        look = int(said["look"])
        if not 0 <= look < len(self._looks):
            raise BenchError("usage", f"look {look} of {len(self._looks)}")
        ids = {str(body): name for body, name in self._scene.names.items()}
        return {"names": ids}, {"bodies": np.asarray(self._looks[look]["segm"][str(said["camera"])], dtype=np.uint8)}

    def _slot_masks(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        slot = str(said["slot"])
        bodies = np.asarray(self._env.prompt_assets[slot]["segm"][str(said["camera"])], dtype=np.uint8)
        return {"names": {str(body): name for body, name in self._scene.shown[slot].items()}}, {"bodies": bodies}

    def _oracle(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        if self._late or self._goals.ended:
            return {"actions": []}, {}
        observed: Any = self._looks[-1]
        if int(observed["ee"]) == 0:
            return {"actions": self._goals.picks(observed["segm"]["top"])}, {}
        action = self._env.task.oracle(self._env).act(observed) if self._goals.left() else None
        return {"actions": [] if action is None else [{name: _plain(value) for name, value in action.items()}]}, {}

    def _close(self, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Reply:
        if self._env is not None:
            self._env.close()
            self._env = None
        return {}, {}

    # -- the arm ---------------------------------------------------------------------------------------------------

    def _watch_the_arm(self, env: Any) -> None:
        """Notice that the arm did not arrive in its time; what follows in the same action is then not waited for."""
        move = env.movej

        def watched(*args: Any, **more: Any) -> bool:
            self._late = self._late or bool(move(*args, **more))
            return self._late

        env.movej = watched

    def _watch_the_cup(self, env: Any) -> None:
        """A suction cup's pressure tells the robot whether it holds something."""
        look = getattr(env.ee, "check_grasp", None)
        if look is None:
            return

        def watched() -> bool:
            self._held = bool(look())
            return self._held

        env.ee.check_grasp = watched

    def _time_s(self) -> float:
        return float(getattr(self._env or object(), "step_counter", 0)) / STEPS_PER_S


def _upright(picture: Any) -> Any:
    """Colours first, as the simulator has it, to rows, columns, colours."""
    return np.ascontiguousarray(np.transpose(np.asarray(picture, dtype=np.uint8), (1, 2, 0)))


def _plain(value: Any) -> list[float]:
    return [float(number) for number in np.asarray(value).reshape(-1)]
