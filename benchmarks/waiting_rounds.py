"""Print the chain of waiting rounds of one plan, by name, and what it sends.

    python -m benchmarks.waiting_rounds

A model that takes one (virtual) second per answer and agrees with everything plans for two targets; requests that
wait for each other make the rounds. Nothing here says how good a plan is.
"""

from __future__ import annotations

import json
from typing import Any

from tests.planning.rounds import measure
from wonderful_team.core.values import Request, Words
from wonderful_team.images import draw, to_png
from wonderful_team.planning import TeamConfig


def sizes(requests: list[Request]) -> dict[str, int]:
    """Calls, pictures, characters of words and bytes of PNG that these requests send."""
    words = sum(len(r.system) + sum(len(p.text) for p in r.parts if isinstance(p, Words)) for r in requests)
    schema = sum(len(json.dumps(r.output.model_json_schema())) for r in requests)
    pictures = [picture for r in requests for picture in r.pictures]
    return {
        "calls": len(requests),
        "pictures": len(pictures),
        "characters": words,
        "schema characters": schema,
        "png bytes": sum(len(to_png(draw(picture))) for picture in pictures),
    }


def describe(name: str, config: TeamConfig) -> dict[str, Any]:
    """Print one way of working and return its figures."""
    plan, monitor, seconds = measure(config)
    figures = sizes([request for _, request in monitor.sent])
    print(f"\n{name}: {seconds:.0f} waiting rounds, plan {plan.status}")
    for number, kinds in enumerate(monitor.rounds(), start=1):
        print(f"  {number:2d}  " + " + ".join(f"{kind} x{n}" if n > 1 else kind for kind, n in kinds.items()))
    print("  " + ", ".join(f"{value:,} {key}" for key, value in figures.items()))
    return {"rounds": round(seconds), **figures}


def main() -> None:
    """Print the chain for both ways of working and for the switch-offs."""
    print(
        "two targets, one_step, no doubt, first boxes accepted, Memory on; photo 640 x 480; model: agreeable (scripted)"
    )
    for mode in ("paper", "lean"):
        describe(mode, TeamConfig(mode=mode))
    describe("lean, thorough", TeamConfig(mode="lean", thorough=True))
    for ablation in ("s1", "s2", "s4", "s6", "s7", "s8"):
        describe(f"paper, {ablation}", TeamConfig(mode="paper", ablation=ablation))


if __name__ == "__main__":
    main()
