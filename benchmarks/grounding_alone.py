"""Grounding alone on tasks 1, 6 and 17, by the paper's rule (Appendix G.2): PIVOT, one direct answer, the grounding team.

    python -m benchmarks.grounding_alone                                    # simulated:perfect, seeds 1000-1009
    python -m benchmarks.grounding_alone --model openai:NAME --seeds 10     # with a model of yours; it costs money

Every thing that the task has moved or used as a place is described in words; a scene succeeds when the point of each counts: half of the
label drawn at it lies on the thing, or it is near the thing's middle. The paper states neither the label's size nor the range: assumed
are our own label (radius 4.5 px of a 640 x 320 view, as drawn) and 2 % of the view's longer side. Figures of simulated models are SIMULATED and say
nothing about a vision-language model; the paper's (n = 10) stand beside ours for the eye alone.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import tempfile
from collections.abc import Sequence
from typing import Any

import wonderful_team as wt
from wonderful_team.core.intervals import wilson_interval
from wonderful_team.core.protocols import Situation
from wonderful_team.core.values import Observation
from wonderful_team.lab.label_rule import LabelRule
from wonderful_team.simulated.naming import unique_words

TASKS = {"visual_manipulation": 1, "novel_adj": 6, "pick_in_order_then_restore": 17}
METHODS = ("pivot", "direct:axes", "team")
PAPER = {
    "pivot": {1: 30, 6: 0, 17: 0},
    "direct:axes": {1: 40, 6: 20, 17: 10},
    "team": {1: 90, 6: 80, 17: 90},
    "team:paper": {1: 90, 6: 80, 17: 90},
}
"""Percent, with GPT-4o, n = 10 (`table:pivot_comparison`)."""
LABEL_PX, RANGE_SHARE = 4.5, 0.02


def wanted(world: Any, seen: Observation) -> dict[str, Any]:
    """What has to be found, by its words: the mask that truth has of it."""
    situation = Situation(seen, world.instruction, world.vocabulary, world.limits)
    planner: Any = wt.Method(method="direct", model="simulated:perfect", world=world).policy()
    plan = asyncio.run(planner.decide(situation)).plan
    sight = world.privileged.observation_log(seen.main.id)[0]
    named = {words: name for name, words in unique_words(sight, world.privileged.things()).items()}
    return {target.words: sight.masks[named[target.words]] for target in plan.targets if target.kind == "object"}


def points(method: str, model: str, world: Any, seen: Observation, words: Sequence[str]) -> list[Any]:
    """Where a method finds each of these things [px of the view]; None where it finds nothing."""
    if method.startswith("team"):
        with tempfile.TemporaryDirectory() as out:
            found = wt.Team(method=method, model=model, world=world, out=out).ground(seen, list(words)).plan.grounded
        items = [found.get(f"T{number}") for number in range(1, len(words) + 1)]
    else:
        policy: Any = wt.Method(method=method, model=model, world=world).policy()
        items = asyncio.run(policy.ground(seen, list(words)))
    return [None if item is None else next(iter(item.points.values()), None) for item in items]


def scene(task: str, seed: int, method: str, model: str) -> bool:
    """Whether everything in one scene is found."""
    world: Any = wt.make_world(f"tabletop/{task}", seed=seed)
    try:
        seen = world.observe()
        masks = wanted(world, seen)
        rule = LabelRule(LABEL_PX, RANGE_SHARE * max(seen.main.size_px))
        said = points(method, model, world, seen, list(masks))
        return all(
            point is not None and rule.holds(point, mask) for point, mask in zip(said, masks.values(), strict=True)
        )
    finally:
        world.close()


def main() -> None:
    """Run it and print one line a cell."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", default="simulated:perfect")
    parser.add_argument("--methods", default=",".join(METHODS))
    parser.add_argument("--first", type=int, default=1000)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--json", action="store_true")
    asked = parser.parse_args()
    label = " (SIMULATED)" if asked.model.startswith("simulated:") else ""
    rows = []
    for method in asked.methods.split(","):
        for task, number in TASKS.items():
            hits = sum(scene(task, seed, method, asked.model) for seed in range(asked.first, asked.first + asked.seeds))
            low, high = wilson_interval(hits, asked.seeds)
            row = {"method": method, "task": task, "number": number, "hits": hits, "n": asked.seeds,
                   "interval": [low, high], "paper_percent": PAPER.get(method, {}).get(number)}  # fmt: skip
            rows.append(row)
            if not asked.json:
                paper = "" if row["paper_percent"] is None else f"   paper (GPT-4o, n = 10): {row['paper_percent']} %"
                print(
                    f"{method:<12} {number:>2} {task:<28} {hits}/{asked.seeds} "
                    f"({100 * low:.0f} to {100 * high:.0f} %){label}{paper}",
                    flush=True,
                )
    if asked.json:
        print(json.dumps({"model": asked.model, "simulated": bool(label), "rows": rows}, indent=1))


if __name__ == "__main__":
    main()
