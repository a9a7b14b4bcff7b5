"""What long and large runs come to: CPU at their begin and at their end, memory at most, and how long their page takes to open.

    python -m benchmarks.growth replans          # 23 replans of the paper's team: a record of a thousand requests
    python -m benchmarks.growth looks            # 100 looks and 20 replans
    python -m benchmarks.growth photo            # fifty things on a photo of 12 megapixels

Each is a process of its own: memory at most is that of the process, modules, simulator and page included. `offline` answers.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np

import wonderful_team as wt
from benchmarks.browser import opening_s
from wonderful_team.api.rollout import make_world, rollout
from wonderful_team.core.actions import Action
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Observation, StepReport

PHOTO_PX = (4000, 3000)


class Unmoved:
    """A world in which every action is said to have run and nothing moves: the team looks, and replans, until a bound ends it."""

    horizon = 10**6

    def __init__(self, world: Any) -> None:
        self._world = world
        self.looked_s: list[float] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self._world, name)

    def observe(self) -> Observation:
        self.looked_s.append(time.process_time())
        seen: Observation = self._world.observe()
        return seen

    def execute(self, action: Action) -> StepReport:
        return StepReport(action, True, {})


def replans(quick: bool) -> str:
    """The paper's team, with pictures side by side: 44 requests a plan."""
    return _rollout("tabletop/everyday/tidy_up", "team:paper", 8 if quick else 23, 0)


def looks(quick: bool) -> str:
    """Sweeping: a look after every push, and a replan once there are no looks left."""
    return _rollout("tabletop/sweep_without_exceeding", "team", 5 if quick else 20, 25 if quick else 100)


def _rollout(scene: str, method: str, most_replans: int, most_looks: int) -> str:
    world = Unmoved(make_world(scene, 3))
    with tempfile.TemporaryDirectory() as out:
        team = wt.Team(model="offline", method=method, out=Path(out), cache="off", max_calls=100_000)
        trial = rollout(team, world, replans=most_replans, reobserve=most_looks, seed=3)
        # One sum for each plan: two looks a subgoal lie within milliseconds.
        spent = [later - before for before, later in zip(world.looked_s, world.looked_s[1:], strict=False)]
        plans = [one for one in spent if one > 0.5 * max(spent[len(spent) // 2 :])]
        early, late = (statistics.median(part) for part in (plans[1:6], plans[-5:]))
        return (
            f"{early:.2f} -> {late:.2f} s a plan, {len(trial.plans)} plans, {trial.usage.calls} requests; "
            f"{_memory_and_page(trial.page)}"
        )


def photo(quick: bool) -> str:
    """Every red block into the bowl, fifty of them, on a large photo."""
    rgb = cv2.resize(blocks(20 if quick else 50), PHOTO_PX, interpolation=cv2.INTER_CUBIC)
    rgb.setflags(write=False)
    with tempfile.TemporaryDirectory() as out:
        before = time.process_time()
        made = wt.Team(model="offline", out=Path(out), cache="off").plan(rgb, "put every red block into the blue bowl")
        seconds = time.process_time() - before
        return f"{seconds:.1f} s, {len(made.plan.actions)} actions; {_memory_and_page(made.page)}"


def blocks(count: int) -> Array:
    """A photo of so many red blocks and a blue bowl on a table, shape (960, 1280, 3), uint8."""
    rng = np.random.default_rng(7)
    rgb = np.full((960, 1280, 3), (214, 208, 196), np.uint8)
    cv2.circle(rgb, (1080, 480), 130, (40, 80, 190), -1, cv2.LINE_AA)
    cv2.circle(rgb, (1080, 480), 104, (30, 60, 150), -1, cv2.LINE_AA)
    places = [(90 + 105 * column, 80 + 115 * row) for column in range(8) for row in range(8)]
    for number in rng.permutation(len(places))[:count]:
        x, y = places[int(number)]
        box = cv2.boxPoints(((x, y), (46, 46), float(rng.uniform(0, 90))))
        cv2.fillPoly(rgb, [np.round(box * 16).astype(np.int32)], (196, 44, 40), cv2.LINE_AA, 4)
    return rgb


def _memory_and_page(page: Path | None) -> str:
    memory = f"{peak_bytes() / 1e6:.0f} MB"
    assert page is not None
    seconds = opening_s(page)
    return f"{memory}; page {page.stat().st_size / 1e6:.1f} MB" + ("" if seconds is None else f", {seconds:.2f} s")


def peak_bytes() -> int:
    """The most memory that this process has held since it began; Linux says so."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


WAYS: dict[str, Callable[[bool], str]] = {"replans": replans, "looks": looks, "photo": photo}


def main() -> None:
    """Measure one and print it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("way", choices=WAYS)
    parser.add_argument("--quick", action="store_true", help="a third of it")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    print(f"load {os.getloadavg()[0]:.1f}; {WAYS[options.way](options.quick)}")


if __name__ == "__main__":
    main()
