"""Wrong plans planted into the whole lean team: how often Verification objects, and how often to right ones.

    python -m benchmarks.planted_plans [--n 100] [--first 1000]

The faults are those of `planted_faults`, which asks Verification about the plan alone. Here a plain plan is checked once,
with its steps, drawn over the picture, as the lean team does. `--thorough` has every plan checked by itself as well.
"""

from __future__ import annotations

import argparse
import asyncio

from benchmarks.confusion import Confusion
from benchmarks.planted_faults import show, spoiled_plans
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.protocols import Event
from wonderful_team.models.wrappers import Injecting, Injection
from wonderful_team.offline import OfflineModel
from wonderful_team.offline.answers.moves import with_moves
from wonderful_team.planning import TeamConfig, TeamPolicy


class Drafts:
    """Counts how often a plan was drafted."""

    count = 0

    def on_event(self, event: Event) -> None:
        self.count += event.kind == "request" and event.content.contract == "DraftPlan"


async def check_plans_in_team(n: int, first: int, config: TeamConfig) -> dict[str, Confusion]:
    """Half of the plans are spoiled; counted is whether it went back before actions came of it."""
    by_kind: dict[str, Confusion] = {}
    async for where, _, kind, plan in spoiled_plans(n, first):
        # A wrong plan states the moves of what it says: nothing in it contradicts itself.
        drafted = with_moves(plan, where.shown.task, PICK_PLACE.step_kinds)
        injection = Injection(("DraftPlan",), lambda value, request, drafted=drafted: drafted, f"plan: {kind}")
        drafts = Drafts()
        team = TeamPolicy(Injecting(OfflineModel(), [injection]), config, subscribers=[drafts])
        made = await team.make_plan(where.world.observe(), where.world.instruction, PICK_PLACE, where.world.limits)
        # A plan that could not be carried out goes back as well, with what was measured.
        objected = bool(made.questions) or made.status != "planned" or drafts.count > 1
        by_kind[kind] = by_kind.get(kind, Confusion()).add(bad=kind != "none", objected=objected)
        if (kind != "none") != objected:
            print(f"    {where.task} seed {where.seed}, fault {kind}: {made.status}, approved {made.verified}")
    return by_kind


def main() -> None:
    """Parse arguments, run and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=100, help="plans, half of them bad")
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--thorough", action="store_true", help="every question is asked")
    options = parser.parse_args()
    config = TeamConfig(mode="lean", thorough=options.thorough)
    show("Verification in the lean team", asyncio.run(check_plans_in_team(options.n, options.first, config)))


if __name__ == "__main__":
    main()
