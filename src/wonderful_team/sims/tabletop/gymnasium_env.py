"""The tabletop for people who do not want our planner: gymnasium environments, `wonderful_team/rotate-v0` and so on.

An observation is a dictionary: `top` and `front` (uint8, height x width x 3) are the cameras' pictures. The instruction,
its words and its pictures, is in the `info` of `reset`. An action is four numbers from -1 to 1: where to pick (or start
a push) and where to place (or end it), as shares of the picture: x to the right, y down; pick and place takes a fifth,
the turn, as a share of half a turn counter-clockwise. The reward is 1 when the task is solved, else 0. An episode is
terminated when the task is solved or failed, and truncated at the horizon; `info["success"]` says which.

    import gymnasium
    from wonderful_team.sims.tabletop import gymnasium_env

    gymnasium_env.register()
    env = gymnasium.make("wonderful_team/visual_manipulation-v0", partition="L3", clutter=1)
    observation, info = env.reset(seed=3)
    env.action_space.seed(3)
    print(info["instruction"].text, list(info["instruction"].slots))
    ended = False
    while not ended:
        observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
        ended = terminated or truncated
    env.close()
"""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

import numpy as np

from wonderful_team.core.actions import PickPlace, Push
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.errors import ConfigError, MissingExtraError
from wonderful_team.sims.tabletop.cameras import CAMERA_NAMES, TABLE_HIGH_M, TABLE_LOW_M
from wonderful_team.sims.tabletop.options import Tiers, asked
from wonderful_team.sims.tabletop.registering import find_task, task_names
from wonderful_team.sims.tabletop.world import TabletopWorld

try:
    import gymnasium
except ModuleNotFoundError as error:
    raise MissingExtraError("gymnasium environments", "gym") from error


class TabletopEnv(gymnasium.Env[Any, Any]):
    """One task as a gymnasium environment; the module's first lines say what actions and observations are.

    Args:
        task: Name of the task, such as "rotate" or "rotate@L3@small".
        partition: Generalisation level, L1 to L4.
        size_px: Width and height of the pictures.
        render_mode: None or "rgb_array".
        clutter, lighting, camera, texture: How much harder than usual the scenes are, 0 to 3; see `options.Tiers`.

    Raises:
        ConfigError: An option is out of its range, or name and options say different things.
        UnknownNameError: No such task, or it does not exist at that level.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 2}

    def __init__(
        self,
        task: str,
        partition: str | None = None,
        size_px: tuple[int, int] | None = None,
        render_mode: str | None = None,
        clutter: int = 0,
        lighting: int = 0,
        camera: int = 0,
        texture: int = 0,
    ) -> None:
        self.asked = asked(task, partition, size_px, Tiers(clutter, lighting, camera, texture))
        self.render_mode, size_px = render_mode, self.asked.size_px
        found = find_task(self.asked.task)
        found.check_partition(self.asked.partition)
        self._pushes = found.vocabulary.kinds == ("push",)
        picture = gymnasium.spaces.Box(0, 255, (size_px[1], size_px[0], 3), np.uint8)
        self.observation_space = gymnasium.spaces.Dict({name: picture for name in CAMERA_NAMES})
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (4 if self._pushes else 5,), np.float32)
        self.world: TabletopWorld | None = None
        self._steps = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Array], dict[str, Any]]:
        """Set a scene; the same seed sets the same one, and without a seed the next random one is set."""
        super().reset(seed=seed)
        scene = int(self.np_random.integers(2**31)) if seed is None else seed
        self.close()
        self.world, self._steps = self._made(scene), 0
        return self._look(self.world), {"instruction": self.world.instruction, "seed": scene}

    def step(self, action: Array) -> tuple[dict[str, Array], float, bool, bool, dict[str, Any]]:
        """Run one action.

        Raises:
            ConfigError: `reset` was not called, or the action is not in the action space.
        """
        world = self._opened()
        if not self.action_space.contains(np.asarray(action, dtype=np.float32)):
            raise ConfigError(f"action: expected {self.action_space.shape} numbers from -1 to 1, got {action}")
        first, second = table_point(action[0:2]), table_point(action[2:4])
        report = world.execute(
            Push(first, second) if self._pushes else PickPlace(first, second, float(action[4]) * math.pi)
        )
        self._steps += 1
        score = world.privileged.score()
        ended = bool(score.success) or world.privileged.failed
        info = {
            "success": bool(score.success),
            "measured": dict(report.measured),
            "fault": report.fault,
            "reason": score.reason,
        }
        return self._look(world), float(bool(score.success)), ended, self._steps >= world.horizon and not ended, info

    def render(self) -> Any:
        """The top view, when `render_mode` is rgb_array."""
        return self._look(self._opened())["top"] if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """Give the world back; safe to call twice."""
        if self.world is not None:
            self.world.close()
            self.world = None

    def _made(self, seed: int) -> TabletopWorld:
        said = self.asked
        return TabletopWorld(said.task, seed, size_px=said.size_px, partition=said.partition, **asdict(said.tiers))

    def _opened(self) -> TabletopWorld:
        if self.world is None:
            raise ConfigError("call reset() first")
        return self.world

    @staticmethod
    def _look(world: TabletopWorld) -> dict[str, Array]:
        return {name: view.rgb.copy() for name, view in world.observe().views.items()}


def table_point(share: Array) -> Array:
    """A point of the table, shape (3,) [m], from shares -1 to 1: x to the right in the top picture, y down."""
    low, high = np.array(TABLE_LOW_M[:2]), np.array(TABLE_HIGH_M[:2])
    down_right = (np.asarray(share, dtype=float)[::-1] + 1) / 2
    return np.append(low + down_right * (high - low), 0.0)


def action_of(action: PickPlace | Push) -> Array:
    """The numbers of an action, as `step` takes them: the other way round, for demonstrations."""
    low, high = np.array(TABLE_LOW_M[:2]), np.array(TABLE_HIGH_M[:2])
    pair = (action.pick_m, action.place_m) if isinstance(action, PickPlace) else (action.start_m, action.end_m)
    numbers = [((2 * (point[:2] - low) / (high - low)) - 1)[::-1] for point in pair]
    turn = [[math.remainder(action.yaw_rad, 2 * math.pi) / math.pi]] if isinstance(action, PickPlace) else []
    return np.concatenate([*numbers, *turn]).clip(-1, 1).astype(np.float32)


def register() -> list[str]:
    """Make every task known to gymnasium, a second time without harm.

    Returns:
        The names for `gymnasium.make`.
    """
    names = []
    for task in task_names():
        name = f"wonderful_team/{task.replace('/', '-')}-v0"
        names.append(name)
        if name not in gymnasium.registry:
            gymnasium.register(name, entry_point=f"{__name__}:TabletopEnv", kwargs={"task": task})
    return names
