"""Attack every part that is promised to hold, and count what gave way.

    python -m benchmarks.attack                       # sizes as below: hours
    python -m benchmarks.attack --share 0.01          # the same, a hundredth of each: minutes
    python -m benchmarks.attack --only gate,sandbox --plans 5000 --edited 200 --programs 100 --seed 7

| group   | what is tried                                                                       | option     |
|---------|-------------------------------------------------------------------------------------|------------|
| model   | faults of models over real sockets in five formats, whole plans made under them     | --faults   |
| sandbox | programs that reach outside, never end, exhaust whoever reads them or lie of calls  | --programs |
| gate    | random plans, judged by the gate and by an oracle of its own                        | --plans    |
| edited  | admitted plans in which one thing is changed                                        | --edited   |
| kills   | kill -9 of sweeps with their workers, at random moments                             | --kills    |
| clocks  | deaths of processes, and clocks that jump by a minute, over a study with a cap      | --jumps    |
| files   | damaged files and options of every kind, read by the commands that read them        | --files    |
| writes  | every write of every command fails, once and from then on (a full disk)             | --writes   |

Each group draws from what the tests draw from (`tests/`), for longer. Printed, for each: attempts; crashes (an error that is none of ours,
or an exit code that means nothing); hangs (past the stated limit: a plan 90 s, each run of a program 2 s more than it was given, a sweep 120 s, a
command 60 s); lost (a result lost, doubled or booked wrongly, a plan that is not the right one); outside (admitted outside the rules, a cap
passed, a key told, something touched outside of the sandbox). Exit 1 when anything gave way. No model of a vendor takes part, and nothing
is sent to another machine.
"""

from __future__ import annotations

import argparse
import asyncio
import random
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.fault_campaign import campaign
from benchmarks.fuzz_inputs import Tally
from benchmarks.random_plans import through_the_gate
from tests.evals.claims_walk import walk
from tests.evals.sweeps import killed
from tests.fuzzing import KINDS, AgentSession
from tests.sandbox.calling import calling_program, ran_calling
from tests.sandbox.programs import program, ran
from tests.write_fault_cases import CASES, fail_writes, prepare

SIZES = {
    "model": ("faults", 10_000),
    "sandbox": ("programs", 500),
    "gate": ("plans", 100_000),
    "edited": ("edited", 1_000),
    "kills": ("kills", 50),
    "clocks": ("jumps", 150),
    "files": ("files", 1_000),
    "writes": ("writes", 2_000),
}
"""Option and size of each group."""
KILLS_A_SWEEP = 5
SHOWN = 5


@dataclass
class Found:
    """What came of one group; `words` say what gave way."""

    attempts: int
    what: str
    crashes: int = 0
    hangs: int = 0
    lost: int = 0
    outside: int = 0
    words: list[str] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def gave_way(self) -> int:
        return self.crashes + self.hangs + self.lost + self.outside


def model(faults: int, seed: int) -> Found:
    """Faults of models over sockets."""
    tally = asyncio.run(campaign(faults, seed, at_once=8, quiet=True))
    bad = {kind: len(lines) for kind, lines in tally.bad.items()}
    return Found(
        tally.faults,
        f"faults in {tally.plans} plans",
        crashes=bad.get("crashes", 0) + bad.get("wrong exit codes", 0),
        hangs=bad.get("hangs", 0) + bad.get("endless loops", 0),
        lost=bad.get("wrong plans", 0),
        outside=bad.get("keys told", 0),
        words=[f"{kind}: {line}" for kind, lines in tally.bad.items() for line in lines],
    )


def sandbox(programs: int, seed: int) -> Found:
    """Programs of models: in turn functions that give a path, and programs that call the host's functions."""
    found, fine = Found(programs, ""), 0
    for number in range(programs):
        rng = random.Random(f"{seed}/{number}")
        code = calling_program(rng) if number % 2 else program(rng)
        try:
            one = ran_calling(code) if number % 2 else ran(code)
        except Exception as error:  # noqa: BLE001  a crash is what is looked for
            found.crashes += 1
            found.words.append(f"program {number}: {error!r}\n{code[:400]}")
            continue
        fine += one.ended != "error"
        late = any(words.startswith("took") for words in one.wrong)
        found.hangs += late
        found.outside += len(one.wrong) > late
        found.words += [f"program {number}: {'; '.join(one.wrong)}\n{code[:400]}"] if one.wrong else []
    found.what = f"programs, half of them calling; {fine} ended without an error"
    return found


def gate(plans: int, seed: int, edited: int = 0) -> Found:
    """Random plans, and edited ones, through the gate."""
    passed = through_the_gate(plans, edited, first=seed * 1_000_000)
    return Found(
        passed.changed if edited else passed.plans,
        f"edited plans, {passed.still} admitted" if edited else f"random plans, {passed.admitted} admitted",
        crashes=len(passed.crashed),
        outside=len(passed.wrong),
        words=[*passed.wrong, *passed.crashed],
    )


def edited(plans: int, seed: int) -> Found:
    """Admitted plans in which one thing is changed; about half of the random ones are admitted."""
    return gate(4 * plans, seed + 500, edited=plans)


def kills(kills: int, seed: int) -> Found:
    """Sweeps killed at random moments."""
    found, sweeps = Found(0, ""), 0
    while found.attempts < kills:
        sweeps += 1
        with tempfile.TemporaryDirectory() as folder:
            ended = killed(Path(folder), seed * 1000 + sweeps, most=min(KILLS_A_SWEEP, kills - found.attempts))
        found.attempts += max(1, ended.kills)
        found.hangs += ended.hung
        found.lost += bool(ended.wrong) and not ended.hung
        found.words += ended.wrong
    found.what = f"kills in {sweeps} sweeps"
    return found


def clocks(jumps: int, seed: int) -> Found:
    """Deaths and jumps of clocks over a store with a cap."""
    found, walks, deaths = Found(0, ""), 0, 0
    while found.attempts < jumps:
        with tempfile.TemporaryDirectory() as folder:
            walked = walk(Path(folder) / "s.db", seed * 1000 + walks)
        walks += 1
        deaths += walked.deaths
        found.attempts += max(1, walked.deaths + walked.jumps)
        found.hangs += walked.endless
        found.lost += bool(walked.wrong) and not walked.endless
        found.words += walked.wrong
    found.what = f"deaths ({deaths}) and jumps in {walks} walks"
    return found


def files(files: int, seed: int) -> Found:
    """Damaged files and options."""
    share = max(1, -(-files // len(KINDS)))
    with tempfile.TemporaryDirectory() as folder:
        tally = Tally(AgentSession(Path(folder)))
        for kind in KINDS:
            tally.round(kind, seed, share)
    tried = sum(tally.tried.values())
    crashes = len(tally.wrong) - tally.hung
    return Found(tried, f"inputs of {len(KINDS)} kinds", crashes, tally.hung, words=sorted(tally.wrong))


def writes(writes: int, seed: int) -> Found:
    """Writes that fail: every one of every command, or as many as are asked for, at even distances over all."""
    found = Found(0, "")
    ways = [(case, lasting) for case in CASES for lasting in (False, True)]
    with tempfile.TemporaryDirectory() as folder:
        setting = prepare(Path(folder))
        # The first one alone tells how many there are.
        points = sum(fail_writes(case, setting, every=10**9, lasting=lasting)[0] for case, lasting in ways)
        every = max(1, -(-points // writes))
        for case, lasting in ways:
            _, outcomes = fail_writes(case, setting, every=every, lasting=lasting)
            found.attempts += len(outcomes)
            found.lost += sum(bool(one.wrong) for one in outcomes)
            found.words += [f"{case.name}, {one.point}: {'; '.join(one.wrong)}" for one in outcomes if one.wrong]
    found.what = f"of {points} writes of {len(CASES)} commands, once and from then on"
    return found


GROUPS: dict[str, Callable[[int, int], Found]] = {
    "model": model,
    "sandbox": sandbox,
    "gate": gate,
    "edited": edited,
    "kills": kills,
    "clocks": clocks,
    "files": files,
    "writes": writes,
}
"""One function a group: how many attempts, and the seed."""


def table(found: dict[str, Found]) -> str:
    """The groups, a line each."""
    lines = [f"{'group':8} {'attempts':>8} {'crashes':>8} {'hangs':>6} {'lost':>6} {'outside':>8} {'seconds':>8}  what"]
    lines += [
        f"{name:8} {one.attempts:8d} {one.crashes:8d} {one.hangs:6d} {one.lost:6d} {one.outside:8d} {one.seconds:8.0f}  {one.what}"
        for name, one in found.items()
    ]
    return "\n".join(lines)


def main() -> None:
    """Parse arguments, attack, print; exit 1 when anything gave way."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, (option, size) in SIZES.items():
        parser.add_argument(f"--{option}", type=int, help=f"attempts of the group {name} [default: {size}]")
    parser.add_argument("--share", type=float, default=1.0, help="share of the default sizes")
    parser.add_argument("--only", default=",".join(GROUPS), help="groups, with commas")
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    unknown = sorted(set(asked.only.split(",")) - set(GROUPS))
    if unknown:
        parser.error(f"--only {', '.join(unknown)}: valid are {', '.join(GROUPS)}")
    found: dict[str, Found] = {}
    for name in asked.only.split(","):
        option, size = SIZES[name]
        given = getattr(asked, option)
        started = time.monotonic()
        one = GROUPS[name](max(1, round(size * asked.share)) if given is None else given, asked.seed)
        one.seconds = time.monotonic() - started
        found[name] = one
        print(f"{name}: {one.attempts} {one.what}, {one.gave_way} gave way, {one.seconds:.0f} s", flush=True)
        for words in one.words[:SHOWN]:
            print(f"    {words[:800]}", flush=True)
    print(f"\nseed {asked.seed}\n{table(found)}")
    sys.exit(1 if any(one.gave_way for one in found.values()) else 0)


if __name__ == "__main__":
    main()
