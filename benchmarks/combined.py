"""Two tasks in one instruction: tables with their own goals, so that the truth judges, not the reading.

    python -m benchmarks.combined                      # offline, seeds from 500
    python -m benchmarks.combined --oracle --seeds 20  # whether the tables can be solved at all

Each table has a first wording (its instruction) and others for the same goals. The model is `offline` (classical vision
and a grammar); the figures say nothing about any vision-language model.
"""

from __future__ import annotations

import argparse
from itertools import cycle

from benchmarks.offline_success import Job, Result, report
from benchmarks.offline_success import run as run_job
from tests.offline.language.combined import OTHER_WORDS
from wonderful_team.evals import Rate


def run(job: Job) -> Result:
    """Run one trial; importing this file in the worker registers the tables."""
    return run_job(job)


def worded(name: str, seed: int, text: str) -> Job:
    """A trial with other words, the scene's own angle, noun or side filled in."""
    from tests.offline.language.wordings import filled
    from wonderful_team.sims.tabletop import make_world

    world = make_world(name, seed=seed)
    words = dict(world.privileged.truth()["words"])
    world.close()
    return Job(name, seed, instruction=filled(text, words))


def solved_by_oracle(name: str, seed: int) -> bool:
    """Whether actions from the truth solve the table."""
    from wonderful_team.sims.tabletop import make_world

    world = make_world(name, seed=seed)
    try:
        for _ in range(12):
            actions = world.privileged.oracle()
            if not actions:
                break
            world.execute(actions[0])
        return world.privileged.score().success is True
    finally:
        world.close()


def main() -> None:
    """Run and print the rate of each table with its own words and with others."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=500)
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--tables", nargs="*", default=list(OTHER_WORDS))
    parser.add_argument("--oracle", action="store_true", help="the oracle instead of offline")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
    if options.oracle:
        for name in options.tables:
            print(f"{name:32s} oracle {Rate(sum(solved_by_oracle(name, seed) for seed in seeds), len(seeds))}")
        return
    print(f"model: offline   single attempt, open loop; simulated tabletop; seeds {seeds.start}-{seeds.stop - 1}")
    own = [run(Job(name, seed)) for name in options.tables for seed in seeds]
    print("own words")
    report(own)
    other = [
        run(worded(n, seed, text))
        for n in options.tables
        for seed, text in zip(seeds, cycle(OTHER_WORDS[n]), strict=False)
    ]
    print("other words")
    report(other)
    for title, results in (("own words", own), ("other words", other)):
        print(f"{title}: {Rate(sum(result.outcome == 'success' for result in results), len(results))}")


if __name__ == "__main__":
    main()
