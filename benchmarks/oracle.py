"""How often the tabletop's oracle solves its tasks, and how fast: a check of the simulator, not of any planner.

Run: python benchmarks/oracle.py [--seeds 50] [--first 0] [--task NAME ...] [--workers 2]

An episode: the scene is made, the oracle acts until it is solved or the horizon is reached, the score is read. Nothing
is drawn unless --pictures is given: then the instruction's pictures and both views before and after every action are.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import time

from wonderful_team.sims.tabletop import make_world, task_names

Z_95 = 1.959964


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """The 95 % Wilson score interval of a proportion. Source: Wilson 1927, J. Am. Stat. Assoc. 22."""
    share = successes / trials
    spread = Z_95 * math.sqrt(share * (1 - share) / trials + Z_95**2 / (4 * trials**2))
    middle, scale = share + Z_95**2 / (2 * trials), 1 + Z_95**2 / trials
    return (middle - spread) / scale, (middle + spread) / scale


def solved(task: str, seed: int, pictures: bool = False) -> tuple[bool, str, int]:
    """Whether the oracle solves one scene, why not, and with how many actions."""
    world = make_world(task, seed)
    try:
        if pictures:
            _ = world.instruction, world.observe()
        count = 0
        while count < world.horizon and (actions := world.privileged.oracle()):
            # Pushes end where friction lets them: the oracle looks again after every action.
            world.execute(actions[0])
            count += 1
            if pictures:
                world.observe()
        score = world.privileged.score()
        return bool(score.success), f"{score.stage}: {score.reason}", count
    finally:
        world.close()


def _one(job: tuple[str, int, bool]) -> tuple[bool, str, int, float]:
    start = time.process_time()
    return *solved(*job), time.process_time() - start


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=50, help="scenes per task")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--task", action="append", help="only this task, such as rotate or rotate@L3; may be repeated")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    parser.add_argument("--pictures", action="store_true", help="draw what a planner would see, too")
    options = parser.parse_args()
    tasks = options.task or list(task_names())
    seeds = range(options.first, options.first + options.seeds)
    start, episodes = time.perf_counter(), 0
    with multiprocessing.get_context("spawn").Pool(options.workers) as pool:
        for task in tasks:
            results = pool.map(_one, [(task, seed, options.pictures) for seed in seeds], chunksize=1)
            good = sum(success for success, _, _, _ in results)
            low, high = wilson(good, len(results))
            cost_ms = 1e3 * sum(seconds for *_, seconds in results) / len(results)
            steps = sum(count for _, _, count, _ in results) / len(results)
            print(
                f"{task:28s} {good:3d}/{len(results)}  95 % {100 * low:5.1f} to {100 * high:5.1f} %  "
                f"{steps:4.1f} actions, {cost_ms:4.0f} ms CPU an episode",
                flush=True,
            )
            for seed, (success, why, _, _) in zip(seeds, results, strict=True):
                if not success:
                    print(f"    seed {seed}: {why}")
            episodes += len(results)
    seconds = time.perf_counter() - start
    print(f"{episodes} episodes in {seconds:.1f} s: {episodes / seconds:.2f} a second with {options.workers} processes")


if __name__ == "__main__":
    main()
