"""Claims, caps and clocks, tried by a random walk over everything that can happen to them.

Several processes on two machines start, spend, finish, die, hang and come back; clocks of the day jump by a minute either way.
Whatever the order: the walk ends, no cap is passed, nothing that was spent is lost or booked twice, no trial has two results.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from tests.evals.runners import toy_plan
from wonderful_team.core.caps import Caps
from wonderful_team.evals.leases import LEASE_S, Owner, Surroundings
from wonderful_team.evals.spending import CapReached
from wonderful_team.evals.store import Claim, Store
from wonderful_team.evals.trials import TrialRow
from wonderful_team.evals.workers import settle

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
        self.really_spent = 0
        self.numbers = iter(range(1, 100_000))
        self.written: list[int] = []
        self.capped = False
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
        pytest.fail("the study neither ends nor says that its cap is reached")


@pytest.mark.parametrize("seed", range(60))
def test_whatever_happens_the_study_ends_within_its_cap(tmp_path: Path, seed: int) -> None:
    cap = (20, 60, 200, 2000)[seed % 4]
    world = World(tmp_path / "s.db", seed, cap)
    for _ in range(150):
        world.step()
        assert world.really_spent <= cap
    world.end()
    assert world.really_spent <= cap
    with Store(world.file) as store:
        booked = store.spending(world.study)
        assert world.really_spent <= booked.calls <= cap, "what was spent is booked, at most once"
        assert booked.held == (0, 0, 0.0) or booked.in_flight
        assert len(world.written) == len(set(world.written)) == store.count(world.study, "done")
        if not world.capped:
            assert store.count(world.study, "done") == store.count_all(world.study)
    for one in world.processes:
        one.store.close()


def test_a_dead_process_does_not_hold_what_is_left(tmp_path: Path) -> None:
    """It was waited for without end: its trial was taken over only when no other trial was pending."""
    here = Machine("a", alive={1, 2})
    with Store(tmp_path / "s.db", here=here.surroundings()) as store:
        plan = toy_plan(2)
        store.want(plan.name, plan.trials(), plan.request())
        first, second = (Owner("a", pid, "born", 0, "", str(pid)) for pid in (1, 2))
        claim = store.claim(plan.name, first, Caps(calls=8))
        assert claim is not None
        assert store.claim(plan.name, second, Caps(calls=8)) is None, "the first holds all, while it lives"
        here.alive.discard(1)
        with pytest.raises(CapReached, match="8 spent"):
            store.claim(plan.name, second, Caps(calls=8))
        assert store.spending(plan.name).calls == 8, "what the dead one held counts as spent"
        assert store.claim(plan.name, second, Caps(calls=16)) is not None


def test_a_cheap_first_trial_does_not_cut_the_others_for_ever(tmp_path: Path) -> None:
    here = Machine("a", alive={1})
    with Store(tmp_path / "s.db", here=here.surroundings()) as store:
        plan = toy_plan(2)
        store.want(plan.name, plan.trials(), plan.request())
        owner, caps = Owner("a", 1, "born", 0, "", "1"), Caps(calls=1000)
        claim = store.claim(plan.name, owner, caps)
        assert claim is not None
        settle(store, owner, claim, Caps(), TrialRow("success", calls=1, usd=None))
        cuts = 0
        while store.count(plan.name, "done") < store.count_all(plan.name):
            claim = store.claim(plan.name, owner, caps)
            assert claim is not None
            assert claim.left.calls is not None
            # Cut before its second call, however much it was allowed below twenty: it reports what it made.
            enough = claim.left.calls >= 20
            reason = "" if enough else f"the cap of {claim.left.calls} calls is reached"
            result = TrialRow(
                "success" if enough else "failure", None if enough else "budget", reason, calls=1, usd=None
            )
            cuts += not settle(store, owner, claim, Caps(), result)
            assert cuts < 50


def test_a_clock_that_jumps_frees_no_living_process_of_this_machine(tmp_path: Path) -> None:
    here, there = Machine("a", alive={1}), Machine("b", alive={2})
    plan = toy_plan(1)
    with (
        Store(tmp_path / "s.db", here=here.surroundings()) as mine,
        Store(tmp_path / "s.db", here=there.surroundings()) as other,
    ):
        mine.want(plan.name, plan.trials(), plan.request())
        claims = [mine.claim(plan.name, Owner("a", 1, "born", 0, "", str(n))) for n in range(mine.count_all(plan.name))]
        assert None not in claims
        here.wall_s += 3600
        assert mine.claim(plan.name, Owner("a", 1, "born", 0, "", "late")) is None
        there.wall_s += 60
        assert other.claim(plan.name, Owner("b", 2, "born", 0, "", "late")) is None, (
            "a minute of difference is no lapse"
        )


def test_a_late_result_of_a_lost_claim_is_booked_once_and_not_written(tmp_path: Path) -> None:
    here = Machine("a", alive={1, 2})
    plan = toy_plan(1)
    with Store(tmp_path / "s.db", here=here.surroundings()) as store:
        store.want(plan.name, plan.trials(), plan.request())
        slow, quick = (Owner("a", pid, "born", 0, "", str(pid)) for pid in (1, 2))
        claim = store.claim(plan.name, slow)
        assert claim is not None
        here.steady_s += LEASE_S + 1
        again = store.claim(plan.name, quick)
        assert again is not None
        assert again.trial == claim.trial
        assert store.finish(again.trial, quick, TrialRow("success", calls=3, usd=None))
        assert not store.finish(claim.trial, slow, TrialRow("success", calls=7, usd=None))
        assert not store.finish(claim.trial, slow, TrialRow("success", calls=7, usd=None))
        assert store.spending(plan.name).calls == 3 + 7
