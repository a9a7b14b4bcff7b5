"""Every task is a gymnasium environment, where gymnasium is installed."""

from __future__ import annotations

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed")

from wonderful_team.errors import ConfigError  # noqa: E402
from wonderful_team.sims.tabletop import gymnasium_env, task_names  # noqa: E402


def test_ten_lines_of_a_user() -> None:
    assert len(gymnasium_env.register()) == len(task_names())
    env = gymnasium.make("wonderful_team/visual_manipulation-v0")
    observation, info = env.reset(seed=3)
    assert env.observation_space.contains(observation)
    assert list(info["instruction"].slots) == ["dragged_obj_1", "base_obj"]
    again, _ = env.reset(seed=3)
    assert np.array_equal(observation["top"], again["top"])
    steps, ended = 0, False
    env.action_space.seed(1)
    while not ended:
        observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
        ended, steps = terminated or truncated, steps + 1
    assert steps <= 5
    assert reward == 0.0
    env.close()


@pytest.mark.parametrize("task", ["rotate", "sweep_without_exceeding"])
def test_the_oracles_actions_solve_it_through_gymnasium(task: str) -> None:
    gymnasium_env.register()
    env = gymnasium.make(f"wonderful_team/{task}-v0", size_px=(256, 128))
    env.reset(seed=2)
    world = env.unwrapped.world
    terminated = False
    while not terminated:
        action = gymnasium_env.action_of(world.privileged.oracle()[0])
        _, reward, terminated, truncated, info = env.step(action)
        assert not truncated
    assert reward == 1.0
    assert info["fault"] is None
    env.close()


def test_wrong_actions_are_named() -> None:
    env = gymnasium_env.TabletopEnv("rotate")
    with pytest.raises(ConfigError, match=r"call reset\(\) first"):
        env.step(np.zeros(5, dtype=np.float32))
    env.reset(seed=1)
    with pytest.raises(ConfigError, match=r"expected \(5,\) numbers from -1 to 1"):
        env.step(np.full(5, 2.0, dtype=np.float32))
    env.close()
