"""The driver: every motion ends, and says how."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.fetch.driver import (
    COLLISION_N,
    GRIP_STEPS,
    HOME_M,
    MOST,
    OVER_M,
    STEP_M,
    TOUCH_N,
    Driver,
    Felt,
)


class Toy:
    """A tool that goes half of the way that it is told in a step, as the real one about does."""

    def __init__(self, force: Callable[[Array], float] = lambda tool: 0.0, share: float = 0.5) -> None:
        self.tool, self.opening, self.gripped, self.force, self.share = (
            np.array([0.2, 0.0, 0.3]),
            0.1,
            False,
            force,
            share,
        )
        self.actions: list[Array] = []

    def felt(self) -> Felt:
        return Felt(self.tool.copy(), self.opening, self.force(self.tool), self.gripped, 0.04 * len(self.actions))

    def step(self, action: Array) -> Felt:
        self.actions.append(action)
        assert action.shape == (4,)
        assert np.abs(action[:3]).max() <= MOST + 1e-6
        self.tool = self.tool + self.share * STEP_M * action[:3]
        return self.felt()


def driver_of(toy: Toy) -> Driver:
    return Driver(toy.step, toy.felt())


def test_a_straight_way_stays_straight_and_arrives() -> None:
    toy = Toy()
    goal, start = np.array([0.35, 0.25, 0.1]), toy.tool.copy()
    way = (goal - start) / np.linalg.norm(goal - start)
    off: list[float] = []
    driver = driver_of(toy)
    driver.watch = lambda: off.append(float(np.linalg.norm(np.cross(driver.felt.tool_m - start, way))))
    moved = driver.move(goal)
    assert (moved.stopped_by, moved.error_m < 0.002) == ("", True)
    assert max(off) < 0.004


@pytest.mark.parametrize(("goal", "stopped", "limit"), [((0.2, 0.0, 0.05), "contact", TOUCH_N), ((0.2, 0.3, 0.3), "collision", COLLISION_N)])  # fmt: skip
def test_force_stops_a_motion_a_smaller_one_on_the_way_down(
    goal: tuple[float, ...], stopped: str, limit: float
) -> None:
    start = np.array([0.2, 0.0, 0.3])
    met = Toy(lambda tool: limit + 1 if np.linalg.norm(tool - start) > 0.1 else 0.0)
    moved = driver_of(met).move(np.array(goal))
    assert moved.stopped_by == stopped
    assert moved.force_n == limit + 1
    assert np.linalg.norm(met.tool - start) < 0.14
    lighter = Toy(lambda tool: limit - 1 if np.linalg.norm(tool - start) > 0.1 else 0.0)
    assert driver_of(lighter).move(np.array(goal)).stopped_by == ""


def test_what_never_arrives_ends_all_the_same() -> None:
    toy = Toy(share=0.0)
    moved = driver_of(toy).move(np.array([0.3, 0.3, 0.3]))
    assert moved.error_m > 0.3
    assert len(toy.actions) < 100
    toy.actions.clear()
    restless = Toy()

    def jitter(action: Array) -> Felt:
        restless.opening += 0.01 if len(restless.actions) % 2 else -0.01
        return Toy.step(restless, action)

    Driver(jitter, restless.felt()).grip(True)
    assert len(restless.actions) == GRIP_STEPS


def test_closed_fingers_keep_squeezing_and_hold_only_what_keeps_them_apart() -> None:
    toy = Toy()
    driver = driver_of(toy)
    toy.gripped, toy.opening = True, 0.03
    driver.grip(True)
    assert driver.holding
    driver.move(np.array([0.25, 0.0, 0.3]))
    assert all(action[3] < 0 for action in toy.actions)
    tight, loose = driver_of(Toy()), driver_of(Toy())
    tight.grip(True, tight=True)
    loose.grip(True)
    toy.opening = 0.002
    driver.rest(1)
    assert not driver.holding
    toy.opening, toy.gripped = 0.03, False
    driver.rest(1)
    assert not driver.holding
    driver.grip(False)
    assert toy.actions[-1][3] > 0


def test_home_goes_up_first_and_halting_ends_every_motion_at_once() -> None:
    toy = Toy()
    driver = driver_of(toy)
    driver.move(np.array([0.2, 0.0, 0.05]))
    heights: list[float] = []
    driver.watch = lambda: heights.append(float(toy.tool[2]) if toy.tool[0] < 0.15 else 1.0)
    assert driver.home().error_m < 0.002
    assert min(heights) > OVER_M - 0.05
    assert driver.parked
    assert toy.tool == pytest.approx(HOME_M, abs=0.003)
    driver.halt()
    count = len(toy.actions)
    assert driver.move(np.array([0.2, 0.0, 0.3])).stopped_by == "stop"
    assert driver.grip(True).stopped_by == "stop"
    assert len(toy.actions) == count


@pytest.mark.parametrize(
    "broken", [{}, {"tool_m": [1.0, 2.0]}, {"tool_m": "here"}, {"tool_m": [1.0, 2.0, float("nan")]}]
)
def test_a_measurement_that_is_none_is_refused(broken: dict[str, object]) -> None:
    said = {"fingers_m": 0.1, "force_n": 0.0, "gripped": False, "time_s": 1.0}
    assert Felt.of({**said, "tool_m": [1.0, 2.0, 3.0]}, np.zeros(3)).opening_m > 0.1
    with pytest.raises(ValueError, match=r"lacks a measurement|means nothing"):
        Felt.of({**said, **broken}, np.zeros(3))
