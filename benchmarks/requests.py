"""What one plan asks of a model that answers rightly: requests, pictures, words and bytes, by task and by kind of question.

    python -m benchmarks.requests [--method team --method team:paper] [--task NAME ...] [--first 900000] [--seeds 1] [--json FILE]

Each task is planned once from its first picture by `simulated:perfect`, and run without a second look or attempt. Counted
is what is sent for the plan: a picture as often as it is sent, a distinct one once in its request, words with the role's
standing words, and the PNG files as a model of plain pixels is sent them. What is asked twice because an answer was not
valid counts twice; the schema of the answers is not counted.
"""

from __future__ import annotations

import argparse
import json
import statistics
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from wonderful_team import registry
from wonderful_team.api.method import team_config
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import Request, Words
from wonderful_team.evals.suites import VIMA_TASKS
from wonderful_team.models.conventions import PIXELS
from wonderful_team.models.wire import compose
from wonderful_team.planning import TeamPolicy
from wonderful_team.runtime import rollout

COUNTS = ("requests", "pictures", "distinct", "characters", "image_bytes")


@dataclass
class Sent:
    """What was sent.

    Attributes:
        distinct: Pictures that differ from every other one of their request, by their pixels and marks.
    """

    requests: int = 0
    pictures: int = 0
    distinct: int = 0
    characters: int = 0
    image_bytes: int = 0

    def __add__(self, other: Sent) -> Sent:
        return Sent(*(getattr(self, name) + getattr(other, name) for name in COUNTS))


def weigh(request: Request) -> Sent:
    """One request as it goes out."""
    pieces = compose(request, PIXELS).pieces
    images = [piece for piece in pieces if isinstance(piece, bytes)]
    said = [request.system, *(part.text for part in request.parts if isinstance(part, Words))]
    return Sent(1, len(images), len(set(images)), sum(map(len, said)), sum(map(len, images)))


@dataclass
class Counter:
    """Hears every request, and weighs it."""

    by_contract: dict[str, Sent] = field(default_factory=lambda: defaultdict(Sent))

    def on_event(self, event: Event) -> None:
        if event.kind == "request":
            self.by_contract[event.content.contract] += weigh(event.content)

    @property
    def total(self) -> Sent:
        return sum(self.by_contract.values(), Sent())


@dataclass(frozen=True)
class Trial:
    """One task by one method."""

    method: str
    task: str
    seed: int
    targets: int
    outcome: str
    by_contract: Mapping[str, Sent]

    @property
    def total(self) -> Sent:
        return sum(self.by_contract.values(), Sent())


def count(method: str, task: str, seed: int, model: str = "simulated:perfect") -> Trial:
    """Plan and run one scene."""
    config, counter = team_config(method), Counter()
    if config is None:
        raise SystemExit(f"{method} is not the team")
    world: Any = registry.make_world(f"tabletop/{task}", seed)
    try:
        team = TeamPolicy(registry.make_model(model, world=world), config, subscribers=(counter,))
        trial = rollout(team, world, replans=0, scorer=world.privileged, seed=seed, max_age_s=None)
    finally:
        world.close()
    targets = len(trial.plans[0].targets) if trial.plans else 0
    return Trial(method, task, seed, targets, str(trial.outcome), dict(counter.by_contract))


def _row(name: str, sent: Sent, more: str = "") -> str:
    return (
        f"{name:<36}{sent.requests:>9}{sent.pictures:>10}{sent.distinct:>10}{sent.characters:>12}"
        f"{sent.image_bytes / 1024:>10.0f} KiB  {more}"
    )


def table(method: str, trials: Iterable[Trial]) -> str:
    """Every task, the means, and the kinds of question."""
    own = [trial for trial in trials if trial.method == method]
    lines = [
        f"\n{method}",
        f"{'task':<36}{'requests':>9}{'pictures':>10}{'distinct':>10}{'characters':>12}{'PNG':>14}",
    ]
    lines += [_row(trial.task, trial.total, f"{trial.targets} targets, {trial.outcome}") for trial in own]
    means = [statistics.mean(getattr(trial.total, name) for trial in own) for name in COUNTS]
    lines.append(
        f"{'mean':<36}{means[0]:>9.2f}{means[1]:>10.2f}{means[2]:>10.2f}{means[3]:>12.0f}{means[4] / 1024:>10.0f} KiB"
    )
    kinds: dict[str, Sent] = defaultdict(Sent)
    for trial in own:
        for contract, sent in trial.by_contract.items():
            kinds[contract] += sent
    lines.append(f"by kind of question, all {len(own)} trials")
    lines += [_row(contract, kinds[contract]) for contract in sorted(kinds)]
    return "\n".join(lines)


def main() -> None:
    """Count, print, and optionally write JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--method", action="append", help="default: team and team:paper; may be repeated")
    parser.add_argument("--task", action="append", help="only this task; may be repeated")
    parser.add_argument("--model", default="simulated:perfect")
    parser.add_argument("--first", type=int, default=900000, help="first seed")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    methods = options.method or ["team", "team:paper"]
    trials = [
        count(method, task, seed, options.model)
        for method in methods
        for task in options.task or VIMA_TASKS
        for seed in range(options.first, options.first + options.seeds)
    ]
    print(f"model {options.model}, seeds {options.first} to {options.first + options.seeds - 1}, one attempt")
    for method in methods:
        print(table(method, trials), flush=True)
    if options.json:
        told = [{**asdict(trial), "total": asdict(trial.total)} for trial in trials]
        options.json.write_text(json.dumps(told, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
