"""Hand in damaged files and options of every kind, and count what ends as a crash.

    python -m benchmarks.fuzz_inputs --minutes 60 --seed 0

Pictures, depth, cameras, records, stores, photo files, profiles, kept answers, prompts, own code and the values of options are spoiled
in every round, and read by the commands that read them, in this process. Printed: how many of each kind were tried, which ended as a
crash (exit code 70, an exit code that means nothing, --json that is no JSON, a minute and more) with the command, and the slowest.
"""

from __future__ import annotations

import argparse
import faulthandler
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from tests.fuzzing import KINDS, AgentSession, Kind, attempt

ROUND = 20
LONGEST_S = 60.0
"""No input may take longer; what it does then is shown."""


@dataclass
class Tally:
    """What was tried, and what came of it."""

    session: AgentSession
    tried: Counter[str] = field(default_factory=Counter)
    slowest: dict[str, tuple[float, str]] = field(default_factory=dict)
    wrong: set[str] = field(default_factory=set)
    hung: int = 0

    def round(self, kind: Kind, number: int, inputs: int = ROUND) -> None:
        """Try some inputs of one kind."""

        @seed(number)
        @settings(
            max_examples=inputs,
            deadline=None,
            database=None,
            phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
        @given(st.data())
        def tries(data: st.DataObject) -> None:
            started = time.monotonic()
            faulthandler.dump_traceback_later(LONGEST_S)
            argv, said = attempt(self.session, kind, data.draw)
            faulthandler.cancel_dump_traceback_later()
            took = time.monotonic() - started
            if took > LONGEST_S and not said:
                said, self.hung = f"took {took:.0f} s", self.hung + 1
            name = kind.__name__
            self.tried[name] += 1
            self.slowest[name] = max(self.slowest.get(name, (0.0, "")), (took, str(argv)[:300]))
            if said and said not in self.wrong:
                self.wrong.add(said)
                print(f"\n{name} (seed {number}) {str(argv)[:900]}\n  {said}", flush=True)

        tries()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kinds", default=",".join(kind.__name__ for kind in KINDS))
    asked = parser.parse_args()
    kinds = [kind for kind in KINDS if kind.__name__ in asked.kinds.split(",")]
    with tempfile.TemporaryDirectory() as folder:
        tally, ends = Tally(AgentSession(Path(folder))), time.monotonic() + asked.minutes * 60
        number = asked.seed
        while time.monotonic() < ends:
            for kind in kinds:
                tally.round(kind, number)
            number += 1
    print()
    for name, count in tally.tried.items():
        took, argv = tally.slowest[name]
        print(f"{name:<14} {count:6} tried; slowest {took:5.1f} s: {argv}")
    print(f"{sum(tally.tried.values())} inputs, {len(tally.wrong)} that must not be")
    return 1 if tally.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
