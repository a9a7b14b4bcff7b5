"""Every task is a gymnasium environment, where gymnasium is installed."""

from __future__ import annotations

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed")

from gymnasium.utils.env_checker import check_env  # noqa: E402

from wonderful_team.errors import ConfigError, UnknownNameError  # noqa: E402
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


@pytest.mark.parametrize("task", ["rotate", "sweep_without_touching"])
def test_gymnasiums_own_checker_has_nothing_to_say(task: str) -> None:
    gymnasium_env.register()
    env = gymnasium.make(f"wonderful_team/{task}-v0", size_px=(256, 128), render_mode="rgb_array")
    check_env(env.unwrapped)
    env.close()


def test_levels_tiers_and_sizes_are_options_of_make() -> None:
    gymnasium_env.register()
    options = {"partition": "L3", "clutter": 2, "texture": 1, "size_px": (256, 128)}
    env = gymnasium.make("wonderful_team/visual_manipulation-v0", **options)
    observation, _ = env.reset(seed=4)
    assert observation["front"].shape == (128, 256, 3)
    world = env.unwrapped.world
    assert (world.partition, world.tiers.clutter, world.tiers.texture) == ("L3", 2, 1)
    assert len(world.privileged.truth()["things"]) == 7
    env.close()
    with pytest.raises(UnknownNameError, match=r"partition of rotate 'L4'"):
        gymnasium.make("wonderful_team/rotate-v0", partition="L4")
    with pytest.raises(ConfigError, match="clutter: expected a tier"):
        gymnasium.make("wonderful_team/rotate-v0", clutter=9)


def test_the_example_in_the_modules_words_runs() -> None:
    lines = (gymnasium_env.__doc__ or "").split("    import gymnasium")[1]
    code = "\n".join(line.removeprefix("    ") for line in ("    import gymnasium" + lines).splitlines())
    said: dict[str, object] = {}
    exec(compile(code, "example", "exec"), said)  # noqa: S102
    assert said["ended"] is True
    assert said["info"]["success"] is False, "these turns of chance do not solve it; about one in a hundred does"


def test_a_vector_of_environments_steps_together() -> None:
    gymnasium_env.register()
    envs = gymnasium.make_vec(
        "wonderful_team/rotate-v0", num_envs=2, vectorization_mode="sync", size_px=(256, 128), clutter=1
    )
    observation, _ = envs.reset(seed=1)
    assert observation["top"].shape == (2, 128, 256, 3)
    assert not np.array_equal(observation["top"][0], observation["top"][1])
    _, rewards, *_ = envs.step(envs.action_space.sample())
    assert rewards.shape == (2,)
    envs.close()
