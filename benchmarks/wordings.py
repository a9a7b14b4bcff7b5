"""Other words for the tabletop's 17 VIMA tasks and for plain instructions, and whether `offline` reads them as it reads the task's own words.

    python -m benchmarks.wordings benchmarks/wordings_first.txt          # what the words are read as
    python -m benchmarks.wordings benchmarks/wordings_first.txt --solve  # and whether that solves the task

A file of wordings has a "## task" line before the wordings of a task, one a line; plain words in place of a task are an
instruction without pictures. Words in capitals are the scene's own (ANGLE, NUMBER, ...); "[number=two]" at the front names
what a wording presumes. The first figure compares readings with the reading of the task's own words in the same scene, or of
the plain words; the second is judged by the task's scorer.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from tests.offline.language.wordings import FIRST_SEED, MOST_SEEDS, Wording, filled, gist, read_wordings
from wonderful_team.evals import Rate


@dataclass(frozen=True, eq=False)
class Scene:
    """What a reader needs of a scene: the task's own words, its words by name, and the pictures."""

    seed: int
    instruction: str
    words: Mapping[str, str]
    task: Any

    def read(self, text: str) -> Any:
        """A text read with the scene's pictures."""
        from wonderful_team.offline.goals.instruction import read_task

        names = set(re.findall(r"\{([^{}]+)\}", text))
        slots = tuple(slot for slot in self.task.slots if slot.name in names)
        return read_task(replace(self.task, instruction=text, slots=slots))


@lru_cache(maxsize=80)
def scene_of(task: str, seed: int) -> Scene:
    """The scene of a task and seed, as a question shows it."""
    from wonderful_team.agents.scene import SceneShown
    from wonderful_team.sims.tabletop import make_world

    world = make_world(task, seed=seed)
    try:
        words = dict(world.privileged.truth()["words"])
        shown = SceneShown(world.observe(), world.instruction, world.vocabulary, world.limits)
        return Scene(seed, world.instruction.text, words, shown.task)
    finally:
        world.close()


def scene_for(wording: Wording, first: int = FIRST_SEED) -> Scene:
    """The first scene whose words are those that a wording presumes."""
    for seed in range(first, first + MOST_SEEDS):
        scene = scene_of(wording.task, seed)
        if wording.suits(scene.words):
            return scene
    raise ValueError(f"no seed from {first} to {first + MOST_SEEDS - 1} has {dict(wording.presumes)}")


def judge(wording: Wording) -> str:
    """Nothing when a wording is read as the task's own words are; else what is amiss."""
    from wonderful_team.errors import NotUnderstoodError
    from wonderful_team.offline.language import understand

    try:
        if wording.is_plain:
            own, read = gist(understand(wording.task)), gist(understand(wording.text))
        else:
            scene = scene_for(wording)
            own = gist(scene.read(scene.instruction))
            read = gist(scene.read(filled(wording.text, scene.words)))
    except NotUnderstoodError as error:
        return f"refused: {str(error)[:400]}"
    return "" if read == own else f"read otherwise:\n        {read}\n        own {own}"


def main() -> None:
    """Judge every wording of a file and print the rate per task."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--tasks", nargs="*")
    parser.add_argument("--solve", action="store_true", help="also run each wording, judged by the task's scorer")
    parser.add_argument("--quiet", action="store_true", help="rates only")
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args()
    wordings = [
        w
        for w in read_wordings(options.file.read_text(encoding="utf-8"))
        if not options.tasks or w.task in options.tasks
    ]
    verdicts: list[tuple[Wording, str]] = []
    for task in dict.fromkeys(wording.task for wording in wordings):
        mine = [(wording, judge(wording)) for wording in wordings if wording.task == task]
        verdicts += mine
        print(f"{task:28s} read as the task's own words: {sum(not why for _, why in mine)}/{len(mine)}", flush=True)
        for wording, why in mine if not options.quiet else ():
            if why:
                print(f"    {wording.text}\n      {why}")
    refused = sum(why.startswith("refused") for _, why in verdicts)
    print(f"all: {Rate(sum(not why for _, why in verdicts), len(verdicts))}; refused {refused}")
    if options.solve:
        solve(wordings, options.workers)


def solve(wordings: list[Wording], workers: int) -> None:
    """Run every wording in its scene and print how many are solved."""
    from benchmarks.offline_success import Job, run_all

    jobs = []
    for wording in (wording for wording in wordings if not wording.is_plain):
        scene = scene_for(wording)
        jobs.append(Job(wording.task, scene.seed, instruction=filled(wording.text, scene.words)))
    results = run_all(jobs, workers)
    for result in results:
        if result.outcome != "success":
            print(
                f"    {result.job.task} seed {result.job.seed}: {result.outcome} at {result.stage}: {result.reason[:120]}"
            )
            print(f"        {result.job.instruction}")
    print(f"solved: {Rate(sum(result.outcome == 'success' for result in results), len(results))}")


if __name__ == "__main__":
    main()
