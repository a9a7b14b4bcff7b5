"""Strike plans with random faults over real sockets, in all wire formats, and count what must never happen.

    python -m benchmarks.fault_campaign --faults 10000 --seed 0

Local servers speak the vendors' formats; behind them stands a model that agrees with everything, so the right plan is known.
Every plan goes through the real providers and the whole team. Printed: crashes (an error that is none of ours), hangs,
exit codes that do not follow from the faults, plans that are not the right one, and keys in any text.
"""

from __future__ import annotations

import argparse
import asyncio
import random
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from typing import Any

from tests.models.providers.asking import small_scene
from tests.planning.stub_model import stub_model, stub_script
from tests.servers.brains import AgentSession, Brain, Tapped, Unmatched, typed_brain
from tests.servers.faults import ANSWER, LINE, SERVER, Fault
from tests.servers.heard import Heard, Reply
from tests.servers.server import Rules, WireServer
from tests.servers.wiring import WIRES
from wonderful_team.cli.wording import EXIT_OF_STATUS
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import NO_WORKSPACE, Instruction, Observation, Plan
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.planning.config import Mode

SECRET = "wt-campaign-secret-3f9a"
STALLS = ("hang", "drip")
DEADLINE_S, STALL_DEADLINE_S, LONGEST_PLAN_S = 30.0, 4.0, 90.0
MOST_REQUESTS = 400
PLANS_PER_PROVIDER = 8
TRIES = 3
WAYS: tuple[Mode, ...] = ("lean", "paper")
FINAL_CODES = {
    "refusal": 1, "filtered": 1, "cut_off": 1, "cut_empty": 1, "quota": 3, "unauthorized": 2, "forbidden": 2,
    "not_found": 2, "context_too_long": 2, "bad_request": 2, "too_many_pictures": 2,
}  # fmt: skip
"""Exit codes of faults after which no second try can help."""
NO_ANSWER = (
    "malformed", "prose", "empty_text", "wrong_schema", "json_list", "json_null", "deep_json", "huge_number", "outside",
    "nan",
)  # fmt: skip
"""Answers that are sent back; three in a row for one question end the plan with code 1."""
LEARNT = ("too_heavy", "picture_too_heavy", "context_too_long")
"""Not drawn: a provider that was told so sends lighter pictures from then on, which the servers do not know by their pixels, or refuses early."""
HARMLESS = ("fenced", "thinking_before", "double_encoded", "quoted_number", "parroted", "no_usage", "thinking_field")
TOLERANCE_PX = 0.6


@dataclass
class Blow:
    """What one plan is struck with.

    Attributes:
        chance: Of a fault at each request.
        lasting: One fault for every request from `start` on; None for random ones.
        struck: Faults that reached their request, with the contract that was asked.
    """

    rng: random.Random
    chance: float
    names: tuple[str, ...]
    lasting: str | None
    start: int
    session: AgentSession
    requests: int = 0
    struck: list[tuple[str, str]] = field(default_factory=list)

    @property
    def stalls(self) -> bool:
        """Stalls are among the faults, and the deadline is therefore short."""
        return any(name in self.names for name in STALLS)

    def next(self, heard: Heard) -> Fault | None:
        """The fault for the request that has just come."""
        number, self.requests = self.requests, self.requests + 1
        if self.requests > MOST_REQUESTS:
            return Fault("unauthorized")
        if self.lasting is not None:
            name = self.lasting if number >= self.start else None
        else:
            name = self.rng.choice(self.names) if self.rng.random() < self.chance else None
        if name is None:
            return None
        try:
            contract = self.session.find(heard).contract
        except Unmatched:
            contract = "cancelled"
        self.struck.append((name, contract))
        return Fault(name, 0.02)


@dataclass
class Tally:
    """What was counted; `bad` holds one line for each thing that must not happen."""

    plans: int = 0
    faults: int = 0
    requests: int = 0
    endings: Counter[str] = field(default_factory=Counter)
    by_fault: Counter[str] = field(default_factory=Counter)
    by_wire: Counter[str] = field(default_factory=Counter)
    by_stage: Counter[str] = field(default_factory=Counter)
    bad: dict[str, list[str]] = field(default_factory=dict)

    def blame(self, kind: str, text: str) -> None:
        self.bad.setdefault(kind, []).append(text)

    def add(self, other: Tally) -> None:
        """Count another tally in."""
        self.plans, self.faults, self.requests = (
            self.plans + other.plans,
            self.faults + other.faults,
            self.requests + other.requests,
        )
        for name in ("endings", "by_fault", "by_wire", "by_stage"):
            getattr(self, name).update(getattr(other, name))
        for kind, lines in other.bad.items():
            self.bad.setdefault(kind, []).extend(lines)


class Ears:
    """Keeps every text that subscribers are told, to look for keys."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def on_event(self, event: Event) -> None:
        if event.kind in ("warning", "invalid", "failed", "stage"):
            self.texts.append(repr(event.content))
        elif event.kind == "answer":
            self.texts.append(event.content[1].raw + repr(event.content[1].repairs))


def draw_blow(rng: random.Random, session: AgentSession) -> Blow:
    """Few or many passing faults, or one that lasts; stalls only in some plans, for they cost time."""
    passing = (
        *HARMLESS,
        *NO_ANSWER,
        *(n for n in SERVER if n not in (*FINAL_CODES, *LEARNT)),
        *(n for n in LINE if n not in STALLS),
    )
    everything = tuple(name for name in (*ANSWER, *SERVER, *LINE) if name not in (*STALLS, *LEARNT))
    dice = rng.random()
    if dice < 0.25:
        return Blow(rng, 0.0, (), rng.choice(everything), rng.randrange(8), session)
    if dice < 0.30:
        return Blow(rng, 0.15, (*passing, *STALLS, *STALLS), None, 0, session)
    if dice < 0.65:
        return Blow(rng, rng.choice((0.2, 0.5)), passing, None, 0, session)
    return Blow(rng, rng.choice((0.1, 0.3, 0.6)), everything, None, 0, session)


def allowed_codes(blow: Blow) -> set[int]:
    """Exit codes that follow from the faults that struck."""
    names = [name for name, _ in blow.struck]
    codes = {FINAL_CODES[name] for name in names if name in FINAL_CODES}
    if "quota" in names:
        codes.add(3)
    empties = ("empty_choices", "empty_200", "error_200", "other_shape")
    if sum(name in (*NO_ANSWER, *empties) for name in names) >= 3:
        codes.add(1)
    if "absent" in names:
        codes.add(1)
    # Google's own client breaks on JSON that is nested too deep: there it is no reply at all.
    # A refusal of many pictures is a try, too: the next one goes out with all of them on one sheet.
    answered = {*NO_ANSWER, *HARMLESS, *FINAL_CODES, "absent"} - {"deep_json", "too_many_pictures"}
    failing = sum(name not in answered for name in names)
    # With a short deadline, a busy machine is a stalled one.
    if failing >= TRIES or blow.stalls:
        codes.add(3)
    main_line = [
        name for name, contract in blow.struck if name in FINAL_CODES and contract not in ("Remember", "cancelled")
    ]
    # These may pass: pictures are pasted on one sheet; some services mean a rate limit.
    if not [name for name in main_line if name not in ("too_many_pictures", "quota")]:
        codes.add(0)
    return codes


async def one_plan(
    wire: str, provider: Any, blow: Blow, right: dict[str, Plan], tally: Tally, label: str, rng: random.Random
) -> None:
    """Make one plan under blows and judge how it ended."""
    ears = Ears()
    mode: Mode = "paper" if rng.random() < 0.15 else "lean"
    team = TeamPolicy(Tapped(provider, blow.session), TeamConfig(mode=mode), subscribers=(ears,))
    work = team.make_plan(*scene())
    texts, code, plan = ears.texts, -1, None
    try:
        plan = await asyncio.wait_for(work, LONGEST_PLAN_S)
        code = EXIT_OF_STATUS[plan.status]
        texts.append(plan.message)
        ending = plan.status
    except WonderfulTeamError as error:
        code, ending = error.exit_code, type(error).__name__
        texts.append(f"{error!r} {error.__cause__!r} {error.__context__!r}")
    except TimeoutError:
        ending = "hang"
        tally.blame("hangs", f"{label}: {wire} {mode} after {blow.struck}")
    except Exception as error:  # noqa: BLE001  a crash is what is looked for
        ending = f"crash {type(error).__name__}"
        tally.blame("crashes", f"{label}: {wire} {mode}: {error!r} after {blow.struck}")
    tally.plans += 1
    tally.faults += len(blow.struck)
    tally.requests += blow.requests
    tally.endings[ending] += 1
    tally.by_wire[wire] += len(blow.struck)
    tally.by_fault.update(name for name, _ in blow.struck)
    tally.by_stage.update(contract for _, contract in blow.struck)
    if any(SECRET in text for text in texts):
        tally.blame("keys told", f"{label}: {wire} after {blow.struck}")
    if blow.requests > MOST_REQUESTS:
        tally.blame("endless loops", f"{label}: {wire} {blow.requests} requests after {blow.struck[:5]}")
    if code >= 0 and code not in allowed_codes(blow):
        tally.blame(
            "wrong exit codes", f"{label}: {wire} {mode} {ending} ({texts[-1][:160]}) = {code} after {blow.struck}"
        )
    if (
        plan is not None
        and code == 0
        and not is_right(plan, right[mode])
        and not any(n == "absent" for n, _ in blow.struck)
    ):
        tally.blame("wrong plans", f"{label}: {wire} {mode} after {blow.struck}")


def scene() -> tuple[Observation, Instruction, Any, Any]:
    """What is asked: always the same."""
    seen = Observation({"top": small_scene()})
    return seen, Instruction("put the first thing into the second thing"), PICK_PLACE, NO_WORKSPACE


def is_right(plan: Plan, right: Plan) -> bool:
    """The same steps, and points within what whole numbers lose."""
    if plan.status != right.status or plan.steps != right.steps or set(plan.grounded) != set(right.grounded):
        return False
    return all(
        abs(a - b) <= TOLERANCE_PX
        for name, target in right.grounded.items()
        for role, point in target.points.items()
        for a, b in zip(plan.grounded[name].points.get(role, (1e9, 1e9)), point, strict=True)
    )


async def worker(
    number: int,
    seed: int,
    servers: dict[str, WireServer],
    blows: dict[str, Blow],
    right: Plan,
    tally: Tally,
    wanted: int,
) -> None:
    """Make plans, several on each provider, until enough faults have struck."""
    rng = random.Random(f"{seed}/{number}")
    while tally.faults < wanted:
        name = rng.choice(list(WIRES))
        secret = f"{SECRET}-{number}-{rng.randrange(10**9)}"
        providers = {
            stalls: WIRES[name].provider(
                servers[name], api_key=secret, first_wait_s=0.005, tries=TRIES,
                deadline_s=STALL_DEADLINE_S if stalls else DEADLINE_S,
            )
            for stalls in (False, True)
        }  # fmt: skip
        for turn in range(PLANS_PER_PROVIDER):
            blow = draw_blow(rng, AgentSession())
            blows[secret] = blow
            provider = providers[blow.stalls]
            await one_plan(
                name, provider, blow, right, tally, f"seed {seed}, worker {number}, {secret[-9:]}/{turn}", rng
            )
            if tally.faults >= wanted:
                break
        for provider in providers.values():
            await provider.aclose()


async def warm_up(servers: dict[str, WireServer], blows: dict[str, Blow], right: dict[str, Plan], tally: Tally) -> None:
    """One plan through each format without any fault; the clients are imported here, before anything is timed."""
    for name, wire in WIRES.items():
        blow = Blow(random.Random(0), 0.0, (), None, 0, AgentSession())
        blows[SECRET] = blow
        provider = wire.provider(servers[name], api_key=SECRET, deadline_s=60.0)
        await one_plan(name, provider, blow, right, tally, "warm-up", random.Random(0))
        await provider.aclose()


def brain_of(blows: dict[str, Blow], wire: str) -> Brain:
    """Answers for the plan that a request belongs to: every provider has a key of its own."""
    script = stub_script()

    def brain(heard: Heard) -> Reply | str:
        session = blows[heard.secret].session
        return typed_brain(session, lambda request: script[request.contract](request), WIRES[wire].speech)(heard)

    return brain


async def campaign(wanted: int, seed: int, at_once: int, quiet: bool = False) -> Tally:
    """Strike `wanted` faults."""
    tally, blows = Tally(), dict[str, Blow]()
    right = {mode: await TeamPolicy(stub_model(), TeamConfig(mode=mode)).make_plan(*scene()) for mode in WAYS}
    servers = {
        name: WireServer(
            brain_of(blows, name),
            Rules(key=None, local=not wire.vendor),
            lambda heard, _: blows[heard.secret].next(heard),
            remember=False,
        )
        for name, wire in WIRES.items()
    }
    for server in servers.values():
        server.__enter__()
    await warm_up(servers, blows, right, tally)
    started = time.monotonic()
    jobs = [asyncio.ensure_future(worker(n, seed, servers, blows, right, tally, wanted)) for n in range(at_once)]
    try:
        while jobs and not all(job.done() for job in jobs):
            await asyncio.wait(jobs, timeout=10)
            if not quiet:
                print(progress(tally, wanted, time.monotonic() - started), flush=True)
        await asyncio.gather(*jobs)
    finally:
        for server in servers.values():
            server.__exit__()
    return tally


def progress(tally: Tally, wanted: int, seconds: float) -> str:
    bad = ", ".join(f"{kind} {len(lines)}" for kind, lines in tally.bad.items()) or "nothing wrong"
    return (
        f"{seconds:6.0f} s  {tally.faults:6d} of {wanted} faults  {tally.plans} plans  {tally.requests} requests  {bad}"
    )


def report(tally: Tally, seconds: float) -> None:
    """Print what was found."""
    print(f"\n{tally.faults} faults in {tally.plans} plans, {tally.requests} requests, {seconds:.0f} s")
    for title, counted in (("ended as", tally.endings), ("by format", tally.by_wire), ("by question", tally.by_stage)):
        print(f"{title}: " + ", ".join(f"{name} {count}" for name, count in counted.most_common()))
    print("by fault: " + ", ".join(f"{name} {count}" for name, count in sorted(tally.by_fault.items())))
    for kind in ("crashes", "hangs", "wrong exit codes", "wrong plans", "endless loops", "keys told"):
        lines = tally.bad.get(kind, [])
        print(f"{kind:18s}{len(lines)}")
        for line in lines[:5]:
            print(f"    {line[:600]}")


def run(wanted: int, seed: int, at_once: int, quiet: bool) -> Tally:
    """One process's share."""
    return asyncio.run(campaign(wanted, seed, at_once, quiet))


def main() -> None:
    """Run it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--faults", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--at-once", type=int, default=8, help="plans at once in each process")
    parser.add_argument("--processes", type=int, default=1)
    asked = parser.parse_args()
    started, tally = time.monotonic(), Tally()
    if asked.processes == 1:
        tally = run(asked.faults, asked.seed, asked.at_once, False)
    else:
        share = -(-asked.faults // asked.processes)
        with ProcessPoolExecutor(asked.processes, get_context("spawn")) as pool:
            seeds = [asked.seed * 1000 + number for number in range(asked.processes)]
            jobs = [pool.submit(run, share, seed, asked.at_once, number > 0) for number, seed in enumerate(seeds)]
            for job in jobs:
                tally.add(job.result())
    report(tally, time.monotonic() - started)
    raise SystemExit(1 if tally.bad else 0)


if __name__ == "__main__":
    main()
