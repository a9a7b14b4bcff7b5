"""Instructions that presume what a scene does not show, and whether `offline` plans any: none may be.

    python -m benchmarks.premises benchmarks/premises_fifth.txt

A file has a heading "## tabletop TASK SEED: what the picture shows" before the instructions for a scene, one a line. Each is
tried twice, nothing moves: on the picture alone, and in the world with its depth, workspace and actions. A plan of either is
a failure, and so is an empty one ("nothing to do"). Lines that begin with a plus are true of the scene: both must be plans.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import wonderful_team as wt
from wonderful_team.evals import Rate
from wonderful_team.sims.tabletop import make_world

ENDED_WELL = ("not_understood", "needs_clarification", "not_found")
"""What a plan on a false premise may end as."""


def read_premises(text: str) -> Iterator[tuple[str, int, list[str]]]:
    """Task, seed and instructions of every scene of a file."""
    for part in text.split("## tabletop ")[1:]:
        heading, *lines = part.strip().splitlines()
        task, seed = heading.split(":")[0].split()
        yield task, int(seed), [line for line in lines if line.strip()]


def tried(task: str, seed: int, lines: list[str], out: Path) -> Iterator[tuple[str, list[tuple[str, str]]]]:
    """Every instruction, with how planning ended on the picture and in the world, and what was said."""
    world = make_world(task, seed=seed)
    try:
        seen = world.observe()
        picture = np.array(seen.main.rgb)
        for line in lines:
            team = wt.Team(model="offline", max_calls=100, out=out)
            of_world = team.plan(
                seen, line.lstrip("+ "), vocabulary=world.vocabulary, limits=world.limits, facts=world.facts
            )
            ends = [team.plan(picture, line.lstrip("+ ")), of_world]
            yield line, [(end.status, end.message.replace("\n", " ")) for end in ends]
    finally:
        world.close()


def main() -> None:
    """Try every instruction of a file and print those that were planned."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--quiet", action="store_true", help="planned ones only")
    options = parser.parse_args()
    count = planned = true = missed = 0
    with tempfile.TemporaryDirectory() as out:
        for task, seed, lines in read_premises(options.file.read_text(encoding="utf-8")):
            print(f"{task} {seed}", flush=True)
            for line, ends in tried(task, seed, lines, Path(out)):
                some, every = (way(status not in ENDED_WELL for status, _ in ends) for way in (any, all))
                if line.startswith("+"):
                    bad, true, missed = not every, true + 1, missed + (not every)
                else:
                    bad, count, planned = some, count + 1, planned + some
                if bad or not options.quiet:
                    print(f"  {'PLANNED' if every else 'planned once' if some else 'refused'}  {line}")
                    for status, said in ends:
                        print(f"      {status}: {said[:200]}", flush=True)
    print(
        f"planned: {Rate(planned, count)}; of the true ones not planned: {Rate(missed, true) if true else 'none there'}"
    )


if __name__ == "__main__":
    main()
