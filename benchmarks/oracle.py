"""How often the tabletop's oracle solves its tasks: a check of the simulator, not of any planner.

Run: python benchmarks/oracle.py [--seeds 50] [--first 0] [--task NAME ...]
"""

from __future__ import annotations

import argparse
import math
import time

from wonderful_team.sims.tabletop import make_world, task_names

Z_95 = 1.959964


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """The 95 % Wilson score interval of a proportion. Source: Wilson 1927, J. Am. Stat. Assoc. 22."""
    share = successes / trials
    spread = Z_95 * math.sqrt(share * (1 - share) / trials + Z_95**2 / (4 * trials**2))
    middle, scale = share + Z_95**2 / (2 * trials), 1 + Z_95**2 / trials
    return (middle - spread) / scale, (middle + spread) / scale


def solved(task: str, seed: int) -> tuple[bool, str]:
    """Whether the oracle solves one scene, and why not."""
    world = make_world(task, seed)
    try:
        for action in world.privileged.oracle():
            world.execute(action)
        score = world.privileged.score()
        return bool(score.success), f"{score.stage}: {score.reason}"
    finally:
        world.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=50, help="scenes per task")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--task", action="append", choices=sorted(task_names()), help="only this task; may be repeated")
    options = parser.parse_args()
    for task in options.task or task_names():
        start = time.process_time()
        results = {seed: solved(task, seed) for seed in range(options.first, options.first + options.seeds)}
        good = sum(success for success, _ in results.values())
        low, high = wilson(good, len(results))
        cost_ms = 1e3 * (time.process_time() - start) / len(results)
        print(
            f"{task:28s} {good:3d}/{len(results)}  95 % {100 * low:5.1f} to {100 * high:5.1f} %  {cost_ms:4.0f} ms CPU per scene"
        )
        for seed, (success, why) in results.items():
            if not success:
                print(f"    seed {seed}: {why}")


if __name__ == "__main__":
    main()
