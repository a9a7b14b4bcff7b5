"""How `offline` does with words and colours that nobody tuned it for.

    python -m benchmarks.held_out                 # seeds from 1000
    python -m benchmarks.held_out --first 0 --seeds 5

Each task runs with its own words, with other words for the same thing, and with its scenes redrawn in other colours;
nonsense and unknown nouns must be refused by name, not guessed. The model is `offline` (classical vision and a
grammar); the figures say nothing about any vision-language model.

Other words for all 17 VIMA tasks are in wordings_first.txt and wordings_last.txt, read by `benchmarks.wordings`; two tasks in
one instruction are in `benchmarks.combined`.
"""

from __future__ import annotations

import argparse
from itertools import cycle

from benchmarks.offline_success import Job, Result, run_all
from wonderful_team.evals import Rate

OTHER_WORDS: dict[str, tuple[str, ...]] = {
    "visual_manipulation": (
        "Please take the {dragged_obj_1} and drop it in the {base_obj}.",
        "Could you move {dragged_obj_1} into {base_obj}?",
        "I would like the {dragged_obj_1} to be placed inside the {base_obj}.",
        "Grab the {dragged_obj_1}, then put it onto the {base_obj}.",
        "The {dragged_obj_1} belongs in the {base_obj}; put it there.",
    ),
    "rotate": (
        "Turn the {dragged_obj} clockwise by ANGLE degrees.",
        "Please spin {dragged_obj} ANGLE° to the right.",
        "Give the {dragged_obj} a clockwise turn of ANGLE degrees.",
        "ANGLE degrees: rotate the {dragged_obj} by that much.",
    ),
    "scene_understanding": (
        "Move the DRAGGED thing in {scene} onto the BASE thing.",
        "Take the DRAGGED object from {scene} and place it in the BASE object.",
        "In {scene} there is a DRAGGED object. Put it into the BASE object.",
    ),
    "fruit_placement/both": (
        "Move every fruit onto the area of the same colour, if there is one.",
        "Sort the fruits: each goes to the region that has its colour, where such a region exists.",
        "Please put all fruits on the paper whose color matches theirs; leave those without one alone.",
        "Each fruit belongs on the area with the same color. Place them accordingly, if such an area exists.",
    ),
}

NONSENSE = (
    "Put the mug to the left of the laptop.",
    "colourless green ideas sleep furiously",
    "Put the flibber into the grommet.",
    "asdf qwer zxcv",
    "Fold the towel and iron the shirt.",
    "What is the capital of France?",
    "Pour the coffee into the teapot.",
    "Put the red into.",
    "Make me happy.",
    "Sing a song about the table.",
)


def words_for(task: str, template: str, seed: int) -> str:
    """Fill the scene's own angle or textures into other words."""
    from wonderful_team.sims.tabletop import make_world

    world = make_world(task, seed=seed)
    words = world.privileged.truth()["words"]
    world.close()
    text = template.replace("ANGLE", str(words.get("angle", "")))
    return text.replace("DRAGGED", str(words.get("dragged_texture", ""))).replace(
        "BASE", str(words.get("base_texture", ""))
    )


def rate(results: list[Result]) -> Rate:
    """Successes among all trials."""
    return Rate(sum(result.outcome == "success" for result in results), len(results))


def show(title: str, results: list[Result]) -> None:
    """Print one line, and why trials failed."""
    print(f"  {title:22s} {rate(results)}")
    for result in results:
        if result.outcome != "success":
            words = result.job.instruction or ""
            print(f"      seed {result.job.seed}: {result.stage}: {result.reason[:150]}   {words}")


def main() -> None:
    """Run and print all comparisons."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=1000)
    parser.add_argument("--seeds", type=int, default=20, help="seeds per task and variant")
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
    print(f"model: offline   single attempt, open loop; simulated tabletop; seeds {seeds.start}-{seeds.stop - 1}")
    for task, templates in OTHER_WORDS.items():
        print(task)
        show("own words", run_all([Job(task, seed) for seed in seeds], options.workers))
        pairs = zip(seeds, cycle(templates), strict=False)
        other = [Job(task, seed, instruction=words_for(task, template, seed)) for seed, template in pairs]
        show("other words", run_all(other, options.workers))
        # Texture names in the words follow the scene, so a recoloured scene keeps words and pictures in step.
        show("other colours", run_all([Job(task, seed, recolour=seed + 7) for seed in seeds], options.workers))
    refused = run_all(
        [Job("fruit_placement/both", options.first, instruction=text) for text in NONSENSE], options.workers
    )
    by_name = [result for result in refused if result.outcome == "failure" and "I do not know" in result.reason]
    print(f"nonsense and unknown nouns: refused by name {Rate(len(by_name), len(refused))}")
    for result in refused:
        if result not in by_name:
            print(f"      {result.job.instruction!r}: {result.outcome} at {result.stage}: {result.reason[:150]}")


if __name__ == "__main__":
    main()
