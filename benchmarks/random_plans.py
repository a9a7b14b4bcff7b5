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
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "runtime"))

from gate_cases import edited, judged, random_case  # noqa: E402  they live beside the tests
from gate_oracle import broken_rules  # noqa: E402


def main() -> None:
    """Parse arguments, run, print; exit 1 when a plan outside the rules was admitted."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plans", type=int, default=100_000, help="random plans")
    parser.add_argument("--edited", type=int, default=1000, help="admitted plans in which one thing is changed")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--depth", type=float, default=0.5, help="share of the tables that are seen with depth")
    options = parser.parse_args()
    started, wrong, strict = time.process_time(), list[str](), Counter[str]()
    admitted = sound = changed = still = 0
    for seed in range(options.first, options.first + options.plans):
        rng = np.random.default_rng([seed, 100])
        case = random_case(rng, depth=bool(rng.random() < options.depth))
        report, rules = judged(case), broken_rules(case)
        sound += not rules
        admitted += report.admitted
        if report.admitted and rules:
            wrong.append(f"seed {seed}: {'; '.join(rules)}")
        if not report.admitted and not rules:
            strict.update({check.name.split(" region")[0] for check in report.checks if not check.ok})
        if report.admitted and changed < options.edited:
            what, other = edited(case, rng)
            changed += 1
            passes = judged(other).admitted
            still += passes
            if passes and (rules := broken_rules(other)):
                wrong.append(f"seed {seed}, {what} changed: {'; '.join(rules)}")
    print(f"{options.plans} random plans: {admitted} admitted, {sound} keep every rule of the oracle")
    print(f"{changed} edited plans: {still} admitted")
    print(f"admitted outside the rules: {len(wrong)}   {time.process_time() - started:.0f} s of CPU")
    for line in wrong[:20]:
        print(f"    {line}")
    print(
        "refused within the rules, by check: " + ", ".join(f"{name} {count}" for name, count in strict.most_common(8))
    )
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
