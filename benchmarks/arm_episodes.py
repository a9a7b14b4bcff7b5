"""Processor time of an episode on the arm, by task: the oracle's actions, nothing drawn, planned or checked; the aim is 5 s.

    python -m benchmarks.arm_episodes               # ten tasks, 3 seeds each
    python -m benchmarks.arm_episodes --seeds 10 --first 5000 --task arms/star arms/cap

Counted is the processor time of the process, the making of the world included; loading and compiling is not.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from collections.abc import Iterable
from typing import Any

from wonderful_team import registry
from wonderful_team.evals.controls import run_together

TASKS = (
    *("arms/block_in_bowl", "arms/star", "arms/wipe", "arms/shake", "arms/cap", "arms/lid_box/one", "arms/lid_box/two"),
    *("arms/fruit_placement/all_match", "arms/fruit_price_ranking/four", "arms/superhero_companions/exact"),
)
AIM_S = 5.0
ROUNDS = 10
"""So often the oracle is asked for actions at most, in one episode."""


def episode(task: str, seed: int) -> tuple[float, bool]:
    """Processor time of one episode [s], and whether it succeeded."""
    start = time.process_time()
    world: Any = registry.make_world(task, seed)
    try:
        for _ in range(ROUNDS):
            actions = world.privileged.oracle()
            if not actions:
                break
            for action in run_together(actions):
                if not world.execute(action).executed:
                    break
        solved = bool(world.privileged.score().success)
    finally:
        world.close()
    return time.process_time() - start, solved


def means_s(tasks: Iterable[str], seeds: range) -> tuple[dict[str, float], int, int]:
    """Mean time of each task [s], how many episodes succeeded, and of how many."""
    episode("arms/block_in_bowl", seeds[0])  # loads and compiles
    found = {task: [episode(task, seed) for seed in seeds] for task in tasks}
    solved = [ok for episodes in found.values() for _, ok in episodes]
    means = {task: statistics.mean(seconds for seconds, _ in episodes) for task, episodes in found.items()}
    return means, sum(solved), len(solved)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--task", nargs="*", default=TASKS)
    parser.add_argument("--first", type=int, default=5000)
    parser.add_argument("--seeds", type=int, default=3, help="scenes per task")
    options = parser.parse_args()
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores; aim {AIM_S:g} s")
    means, solved, count = means_s(options.task, range(options.first, options.first + options.seeds))
    for task, seconds in means.items():
        print(f"{task:<36}{seconds:6.1f} s")
    print(f"{'mean':<36}{statistics.mean(means.values()):6.1f} s; {solved}/{count} succeeded")


if __name__ == "__main__":
    main()
