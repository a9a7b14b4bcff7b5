"""Claims, caps and clocks: a random walk over everything that can happen to them, and the cases that once went wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.evals.claims_walk import Machine, walk
from tests.evals.runners import toy_plan
from wonderful_team.core.caps import Caps
from wonderful_team.evals.leases import LEASE_S, Owner
from wonderful_team.evals.spending import CapReached
from wonderful_team.evals.store import Store
from wonderful_team.evals.trials import TrialRow
from wonderful_team.evals.workers import settle


@pytest.mark.parametrize("seed", range(60))
def test_whatever_happens_the_study_ends_within_its_cap(tmp_path: Path, seed: int) -> None:
    """The walk ends, no cap is passed, nothing that was spent is lost or booked twice, no trial has two results."""
    walked = walk(tmp_path / "s.db", seed)
    assert walked.wrong == []
    assert walked.deaths + walked.jumps > 0


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
