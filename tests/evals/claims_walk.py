"""A study's store under everything that can happen to it, by chance, with what was really spent counted apart.

Several processes on two machines start, spend, finish, die, hang and come back; clocks of the day jump by a minute either way.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from pathlib import Path

from tests.evals.runners import toy_plan
from wonderful_team.core.caps import Caps
from wonderful_team.evals.leases import LEASE_S, Owner, Surroundings
from wonderful_team.evals.spending import CapReached
from wonderful_team.evals.store import Store
from wonderful_team.evals.stored_rows import Claim
from wonderful_team.evals.trials import TrialRow
from wonderful_team.evals.workers import settle

STEPS = 150
CAPS = (20, 60, 200, 2000)

MOST_STEPS = 4000


@dataclass
class Machine:
    """Its clocks, and which of its processes live."""

    name: str
    wall_s: float = 1_000_000.0
    steady_s: float = 500.0
    jump_s: float = 0.0
    alive: set[int] = field(default_factory=set)

    def surroundings(self) -> Surroundings:
        return Surroundings(
            self.name, lambda: self.wall_s + self.jump_s, lambda: self.steady_s, lambda pid, born: pid in self.alive
        )


@dataclass
class Process:
    """One worker: idle, or at a claimed trial that has cost something so far."""

    machine: Machine
    pid: int
    store: Store
    owner: Owner
    claim: Claim | None = None
    spent: int = 0
    hangs: bool = False


class World:
    """Everything that happens, by chance."""

    def __init__(self, file: Path, seed: int, cap: int) -> None:
        self.chance, self.file = random.Random(seed), file
        self.machines = [Machine("a"), Machine("b")]
        self.processes: list[Process] = []
        self.caps = Caps(calls=cap)
        self.really_spent = self.deaths = self.jumps = 0
        self.numbers = iter(range(1, 100_000))
        self.written: list[int] = []
        self.capped = self.endless = False
        plan = toy_plan(2)
        self.study = plan.name
        with Store(file) as store:
            store.want(plan.name, plan.trials(), plan.request())
            self.wants = {
                row[0]: self.chance.choice([1, 3, 9, 14]) for row in store._base.execute("SELECT id FROM trials")
            }

    def start(self) -> None:
        if len(self.processes) < 3:
            machine = self.chance.choice(self.machines)
            pid = next(self.numbers)
            machine.alive.add(pid)
            owner = Owner(machine.name, pid, "born", 0, "", f"t{pid}")
            self.processes.append(Process(machine, pid, Store(self.file, here=machine.surroundings()), owner))

    def step(self) -> None:
        if not self.processes:
            return self.start()
        what, one = self.chance.random(), self.chance.choice(self.processes)
        if what < 0.05:
            return self.start()
        if what < 0.08:
            return self.die(one)
        if what < 0.10:
            self.jumps += 1
            self.chance.choice(self.machines).jump_s = self.chance.choice([-60, 0, 60])
            return None
        if what < 0.12:
            one.hangs = not one.hangs
            return None
        if what < 0.16:
            self.pass_time(self.chance.choice([1, 20, LEASE_S + 5]))
            return None
        return None if one.hangs else self.work(one)

    def pass_time(self, seconds: float) -> None:
        """Living workers renew their leases as time passes; hanging ones do not."""
        while seconds > 0:
            for machine in self.machines:
                machine.wall_s += min(seconds, 25)
                machine.steady_s += min(seconds, 25)
            for one in self.processes:
                if one.claim is not None and not one.hangs:
                    one.store.renew(one.claim.trial, one.owner)
            seconds -= 25

    def die(self, one: Process) -> None:
        self.deaths += 1
        one.machine.alive.discard(one.pid)
        one.store.close()
        self.processes.remove(one)

    def work(self, one: Process) -> None:
        if one.claim is None:
            try:
                one.claim, one.spent = one.store.claim(self.study, one.owner, self.caps), 0
            except CapReached:
                self.capped = True
            return
        trial, most = one.claim.trial, one.claim.left.calls
        assert most is not None
        wanted = self.wants[trial]
        if one.spent < min(most, wanted):
            one.spent += 1
            self.really_spent += 1
            return
        result = TrialRow("success", calls=one.spent, usd=None)
        if wanted > most:
            result = TrialRow("failure", "budget", f"the cap of {most} calls is reached", calls=one.spent, usd=None)
        if settle(one.store, one.owner, one.claim, Caps(), result):
            self.written.append(trial)
        one.claim = None

    def end(self) -> None:
        """From here on nothing breaks: one process is left, and it must come to an end."""
        for one in list(self.processes):
            self.die(one)
        self.pass_time(LEASE_S + 100)
        self.start()
        (last,) = self.processes
        self.capped = False
        for _ in range(MOST_STEPS):
            self.work(last)
            if self.capped or last.store.count(self.study, "done") == last.store.count_all(self.study):
                return
        self.endless = True


@dataclass
class Walked:
    """What came of one walk: how often a process died or a clock jumped, and what must not be."""

    deaths: int
    jumps: int
    endless: bool
    wrong: list[str]


def _kept(store: Store, study: str) -> tuple[float, ...]:
    total = store._totals(study)
    return tuple(total[name] for name in ("wanted", "done", "success", "calls", "tokens"))


def _sums(store: Store, study: str) -> tuple[float, ...]:
    """The same, added up from the trials and the attempts that were thrown away."""
    mine = "(SELECT trial FROM wanted WHERE study = ?)"
    trials = store._base.execute(
        "SELECT COUNT(*), SUM(state = 'done'), SUM(state = 'done' AND outcome IS 'success'), "
        f"SUM((state = 'done') * COALESCE(calls, 0)), SUM((state = 'done') * COALESCE(tokens, 0)) FROM trials WHERE id IN {mine}",
        (study,),
    ).fetchone()
    lost = store._base.execute(
        f"SELECT COALESCE(SUM(calls), 0), COALESCE(SUM(tokens), 0) FROM discarded WHERE trial IN {mine}", (study,)
    ).fetchone()
    return (*tuple(trials)[:3], trials[3] + lost[0], trials[4] + lost[1])


def walk(file: Path, seed: int) -> Walked:
    """One random walk over a new store, and its end, in which nothing breaks any more."""
    cap = CAPS[seed % len(CAPS)]
    world, wrong = World(file, seed, cap), list[str]()

    def check(holds: bool, words: str) -> None:
        if not holds:
            wrong.append(f"seed {seed}: {words}")

    for _ in range(STEPS):
        world.step()
        check(world.really_spent <= cap, f"{world.really_spent} calls were spent under a cap of {cap}")
    world.end()
    check(world.really_spent <= cap, f"{world.really_spent} calls were spent under a cap of {cap}")
    check(not world.endless, "the study neither ends nor says that its cap is reached")
    with Store(file) as store:
        booked, done = store.spending(world.study), store.count(world.study, "done")
        check(world.really_spent <= booked.calls, f"{world.really_spent} calls were spent, {booked.calls} are booked")
        check(booked.calls <= cap, f"{booked.calls} calls are booked under a cap of {cap}")
        check(booked.held == (0, 0, 0.0) or bool(booked.in_flight), f"nothing is in flight, yet {booked.held} is held")
        check(
            len(world.written) == len(set(world.written)) == done, f"{len(world.written)} results written, {done} done"
        )
        check(_sums(store, world.study) == _kept(store, world.study), "the totals are not the sums of the trials")
        check(world.capped or done == store.count_all(world.study), "trials are left although no cap is reached")
    for one in world.processes:
        one.store.close()
    return Walked(world.deaths, world.jumps, world.endless, wrong)
