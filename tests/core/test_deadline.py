"""The limit on a run's time: calls that do not come back are given up, and everything asks the same clock."""

from __future__ import annotations

import threading
import time

import pytest

from wonderful_team.core import deadline
from wonderful_team.core.deadline import Deadline, bounded, check, limited, to_end
from wonderful_team.errors import BudgetReached, ConfigError

LONG_S = 60.0
"""Nothing may wait so long; a test that did would show it by its time-out."""


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_the_limit_names_cap_time_passed_and_what_was_under_way() -> None:
    clock = Clock()
    limit = Deadline(5.0, clock)
    clock.now += 4.0
    limit.check("drawing")
    assert limit.left_s == 1.0
    clock.now += 2.5
    assert limit.passed
    with pytest.raises(BudgetReached, match=r"the cap of 5 s is reached \(6\.5 s passed\) during drawing"):
        limit.check("drawing")


def test_without_a_limit_calls_stay_in_the_callers_thread() -> None:
    assert bounded("it", threading.current_thread) is threading.current_thread()
    assert to_end("it", threading.current_thread) is threading.current_thread()
    assert deadline.left_s() is None
    check("it")


def test_with_a_limit_all_calls_share_one_thread() -> None:
    with limited(LONG_S):
        first = bounded("it", threading.current_thread)
        assert first is not threading.current_thread()
        assert bounded("it", threading.current_thread) is first
        assert to_end("it", threading.current_thread) is first
        # A call within a call does not wait for itself.
        assert bounded("it", bounded, "inner", threading.current_thread) is first


def test_what_a_call_raises_is_raised() -> None:
    with limited(LONG_S), pytest.raises(ZeroDivisionError):
        bounded("it", lambda: 1 / 0)


def test_a_call_in_python_is_interrupted_and_its_thread_goes_on() -> None:
    turns = []

    def endless() -> None:
        while True:
            turns.append(threading.current_thread())
            time.sleep(0.001)

    with limited(0.2) as limit:
        assert limit is not None
        with pytest.raises(BudgetReached, match="during endless"):
            bounded("endless", endless)
        assert to_end("stop", threading.current_thread) is turns[0]
        ran = len(turns)
        time.sleep(0.05)
        assert len(turns) == ran


def test_a_call_that_keeps_blocking_is_left_behind_and_the_end_runs_elsewhere() -> None:
    held, blocking = threading.Event(), []

    def block() -> None:
        blocking.append(threading.current_thread())
        held.wait(LONG_S)

    try:
        with limited(0.1):
            with pytest.raises(BudgetReached, match="left behind: a thread cannot be ended"):
                bounded("block", block)
            with pytest.raises(BudgetReached):
                bounded("more", threading.current_thread)
            assert to_end("stop", threading.current_thread) is not blocking[0]
    finally:
        held.set()


def test_no_except_exception_keeps_a_call_alive() -> None:
    def stubborn() -> None:
        while True:
            try:
                while True:
                    time.sleep(0.001)
            except Exception:  # noqa: BLE001  as a user's driver may have it
                continue

    with limited(0.1), pytest.raises(BudgetReached) as caught:
        bounded("stubborn", stubborn)
    assert "left behind" not in str(caught.value)


def test_the_earlier_limit_holds() -> None:
    with limited(LONG_S) as outer:
        with limited(2 * LONG_S) as inner:
            assert inner is outer
        with limited(1.0) as inner:
            assert inner is not None
            assert inner.seconds == 1.0
        with limited(None, apart=True) as inner:
            assert inner is not outer
            assert inner is not None
            assert inner.seconds <= LONG_S
        assert deadline.left_s(1.0) == 1.0
    assert deadline.current() is None


def test_a_limit_must_be_positive() -> None:
    for seconds in (0.0, -1.0, float("nan")):
        with pytest.raises(ConfigError, match="must be positive"):
            Deadline(seconds)
