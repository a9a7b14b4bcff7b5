"""Random and edited plans through the safety gate, against rules of an oracle of its own (tests/runtime/gate_oracle.py).

    python -m benchmarks.random_plans                              # 100,000 random plans and 1,000 edited ones
    python -m benchmarks.random_plans --plans 5000 --edited 500    # a few minutes
    python -m benchmarks.random_plans --plans 100000 --depth 0.05  # mostly without depth, which is faster

Wanted: none admitted that breaks a rule. How many that break none are refused is told as well: the gate is stricter than
the rules where it has to be, and a gate that refuses everything would pass. No model takes part.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from tests.runtime.gate_cases import edited, judged, random_case
from tests.runtime.gate_oracle import broken_rules


@dataclass
class Passed:
    """What came of random plans, and of admitted ones in which one thing was changed.

    Attributes:
        sound: Random plans that keep every rule of the oracle.
        changed, still: Edited plans, and how many of them are admitted.
        wrong: Plans admitted outside the rules, in words.
        crashed: Plans over which the gate or the oracle broke, in words.
        strict: Checks that refused plans within the rules, with how many.
    """

    plans: int = 0
    admitted: int = 0
    sound: int = 0
    changed: int = 0
    still: int = 0
    wrong: list[str] = field(default_factory=list)
    crashed: list[str] = field(default_factory=list)
    strict: Counter[str] = field(default_factory=Counter)


def through_the_gate(plans: int, most_edited: int, first: int = 0, depth: float = 0.5) -> Passed:
    """Judge random plans by the gate and by the oracle.

    Args:
        plans: How many.
        most_edited: Most admitted plans in which one thing is changed.
        first: First seed.
        depth: Share of the tables that are seen with depth.
    """
    passed = Passed()
    for seed in range(first, first + plans):
        try:
            _one(seed, most_edited, depth, passed)
        except Exception as error:  # noqa: BLE001  a crash is what is looked for
            passed.crashed.append(f"seed {seed}: {error!r}")
    return passed


def _one(seed: int, most_edited: int, depth: float, passed: Passed) -> None:
    rng = np.random.default_rng([seed, 100])
    case = random_case(rng, depth=bool(rng.random() < depth))
    report, rules = judged(case), broken_rules(case)
    passed.plans += 1
    passed.sound += not rules
    passed.admitted += report.admitted
    if report.admitted and rules:
        passed.wrong.append(f"seed {seed}: {'; '.join(rules)}")
    if not report.admitted and not rules:
        passed.strict.update({check.name.split(" region")[0] for check in report.checks if not check.ok})
    if report.admitted and passed.changed < most_edited:
        what, other = edited(case, rng)
        passed.changed += 1
        passes = judged(other).admitted
        passed.still += passes
        if passes and (rules := broken_rules(other)):
            passed.wrong.append(f"seed {seed}, {what} changed: {'; '.join(rules)}")


def main() -> None:
    """Parse arguments, run, print; exit 1 when a plan outside the rules was admitted."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plans", type=int, default=100_000, help="random plans")
    parser.add_argument("--edited", type=int, default=1000, help="admitted plans in which one thing is changed")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--depth", type=float, default=0.5, help="share of the tables that are seen with depth")
    options = parser.parse_args()
    started = time.process_time()
    passed = through_the_gate(options.plans, options.edited, options.first, options.depth)
    print(f"{passed.plans} random plans: {passed.admitted} admitted, {passed.sound} keep every rule of the oracle")
    print(f"{passed.changed} edited plans: {passed.still} admitted")
    print(f"admitted outside the rules: {len(passed.wrong)}   {time.process_time() - started:.0f} s of CPU")
    for line in [*passed.wrong, *passed.crashed][:20]:
        print(f"    {line}")
    refused = ", ".join(f"{name} {count}" for name, count in passed.strict.most_common(8))
    print(f"refused within the rules, by check: {refused}")
    sys.exit(1 if passed.wrong or passed.crashed else 0)


if __name__ == "__main__":
    main()
