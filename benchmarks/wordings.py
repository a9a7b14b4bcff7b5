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

from wonderful_team.evals import Rate

FIRST_SEED, MOST_SEEDS = 500, 60
WORDS = {
    "ANGLE": "angle",
    "DRAGGED": "dragged_texture",
    "BASE": "base_texture",
    "NUMBER": "number",
    "DIRECTION": "direction",
    "TEXTURE": "texture",
    "ADJ": "adjective",
    "QUALITY": "quality",
    "FIRST": "first_noun",
    "SECOND": "second_noun",
}
"""Words in capitals, and the scene's words that they stand for."""


@dataclass(frozen=True)
class Wording:
    """One way to put a task.

    Attributes:
        task: Name of the task, or the plain words that say the same.
        text: The words, with capitals and picture slots.
        presumes: Words of the scene that the text presumes.
    """

    task: str
    text: str
    presumes: tuple[tuple[str, str], ...] = ()

    @property
    def is_plain(self) -> bool:
        """Whether the heading is an instruction of its own and no task."""
        return " " in self.task

    def suits(self, words: Mapping[str, str]) -> bool:
        """Whether a scene has the words that are presumed."""
        return all(words[name] == filled(value, words) for name, value in self.presumes)


def filled(text: str, words: Mapping[str, str]) -> str:
    """The scene's own words in place of capitals."""
    for capitals, name in WORDS.items():
        if name in words:
            text = re.sub(rf"\b{capitals}\b", words[name], text)
    return text


def read_wordings(text: str) -> list[Wording]:
    """The wordings of a file."""
    out: list[Wording] = []
    task = ""
    for line in text.splitlines():
        if line.startswith("## "):
            task = line[3:].strip()
        elif line.strip() and not line.startswith("#"):
            head = re.match(r"\[([^\]]+)\]\s*", line)
            presumes = tuple(part.split("=", 1) for part in head.group(1).split(",")) if head else ()
            body = line[head.end() :] if head else line
            out.append(Wording(task, body.strip(), tuple((name.strip(), value.strip()) for name, value in presumes)))
    return out


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
    from wonderful_team.planning.scene import SceneShown
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


def gist(understood: Any) -> list[tuple[Any, ...]]:
    """What commands say, without the words that they came from."""
    return [
        (
            command.kind,
            _what(command.thing),
            None
            if command.to is None
            else (
                _how(command.to.how),
                _what(command.to.what),
                _what(command.to.other),
                command.to.aspect,
                command.to.side,
            ),
            round(command.rotate_deg),
            command.pictures,
            _what(command.off),
            _what(command.limit),
        )
        for command in understood.commands
    ]


def _how(how: str) -> str:
    return "in" if how == "on" else how


def _what(description: Any) -> Any:
    if description is None:
        return None
    shown = description.like is not None and description.like_only is None
    noun = "thing" if shown or description.noun in ("thing", "object") else description.noun
    related = tuple((item.relation, tuple(_what(to) for to in item.to)) for item in description.related)
    number = (description.quantity, description.number) if description.quantity == "number" else (description.quantity,)
    return (
        noun, description.name, description.colours, description.dark, description.pattern, description.shape, description.material,
        description.superlative, description.ordinal, description.like, description.like_only, related,
        ("all",) if number == ("each",) else number, tuple(_what(item) for item in description.excluded),
    )  # fmt: skip


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
