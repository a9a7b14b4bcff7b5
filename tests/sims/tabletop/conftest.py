"""Hands for tests: things are carried, pushed and nudged by short sentences, and the verdict is read."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from wonderful_team.core.actions import PickPlace, Push
from wonderful_team.sims.tabletop import TabletopWorld, make_world

AWAY_M = (0.9, 0.0)


class Hand:
    """Acts on one world by sentences; things and places are named by what they are in the rules.

    Things: `a0`, `a1` ... those of the first phase's goals, `b0` ... of the second's, `d0` ... distractors, `s0` ... things
    that count in a zone, `x0` ... strangers to it. Places: `goal` where the thing has to go in its phase, `goal2`, `goal3`
    of later phases, `home` where it stood, `bare` free table, `away` off the table, or the name of a thing.
    """

    def __init__(self, world: TabletopWorld) -> None:
        self.world = world
        self.truth = world.privileged.truth()
        self.home = {name: thing["position_m"][:2] for name, thing in self.truth["things"].items()}

    def name(self, word: str) -> str:
        kind, number = word[0], int(word[1:])
        goals = {"a": 0, "b": 1, "c": 2}
        if kind in goals:
            return self.truth["phases"][goals[kind]][number]["thing"]
        listed = {"d": self.truth["distractors"]}
        if self.truth["counts"]:
            listed |= {"s": self.truth["counts"][0]["things"], "x": self.truth["counts"][0]["strangers"]}
        return listed[kind][number]

    def thing(self, name: str) -> dict:
        return self.world.privileged.truth()["things"][name]

    def at(self, name: str) -> np.ndarray:
        return np.array(self.thing(name)["position_m"][:2])

    def bare(self) -> np.ndarray:
        """The point of the table that is farthest from everything, and from every place that a goal names."""
        busy = [thing["position_m"][:2] for thing in self.world.privileged.truth()["things"].values()]
        busy += [goal["at_m"] for goal in self.truth["goals"] if goal["at_m"]] + list(self.home.values())
        points = [(x, y) for x in np.arange(0.33, 0.68, 0.02) for y in np.arange(-0.41, 0.42, 0.02)]
        return np.array(max(points, key=lambda p: min(math.dist(p, other) for other in busy)))

    def place(self, word: str, name: str) -> np.ndarray:
        word, _, of = word.partition("_of_")
        if of:
            return self.place(word, self.name(of))
        if word.startswith("goal"):
            phase = int(word[4:] or 1) - 1
            goal = next(goal for goal in self.truth["phases"][phase] if goal["thing"] == name)
            return np.array(goal["at_m"]) if goal["at_m"] else self.at(goal["near"][0])
        fixed = {"home": self.home[name], "away": AWAY_M}
        if word in fixed:
            return np.array(fixed[word])
        return self.bare() if word == "bare" else self.at(self.name(word))

    def do(self, sentence: str) -> None:
        """`a0 > goal`, `d0 > goal_of_a0`, `a0 > goal +9cm`, `nudge a0 > away`, `miss`, `solve`, `other` (a bystander moves).

        `a0 > home turned 10` turns it by what its goal leaves to turn, and 10 degrees more.
        """
        words = sentence.split()
        if words[0] == "solve":
            for _ in range(self.world.horizon):
                for action in self.world.privileged.oracle()[:1]:
                    self.world.execute(action)
            return
        if words[0] == "miss":
            self._miss()
            return
        if words[0] == "other":
            wanted = {goal["thing"] for goal in self.truth["goals"]}
            bystander = next(n for n, t in self.truth["things"].items() if n not in wanted and t["movable"])
            self._carry(bystander, self.bare(), 0.0)
            return
        nudged = words[0] == "nudge"
        name, _, word, *more = words[1:] if nudged else words
        name = self.name(name)
        to, yaw = self.place(word, name), 0.0
        for extra in more:
            if extra.endswith("cm"):
                # Sideways, towards the middle of the table.
                to = to + np.array([0.0, -math.copysign(float(extra[:-2]) / 100, to[1])])
            elif extra != "turned":
                yaw = self._left_to_turn(name) + math.radians(float(extra))
        if nudged:
            self.world.privileged.nudge(name, *(to - self.at(name)), yaw_rad=yaw)
        else:
            self._carry(name, to, yaw)

    def _left_to_turn(self, name: str) -> float:
        goal = next(goal for goal in self.truth["goals"] if goal["thing"] == name)
        return 0.0 if goal["yaw_rad"] is None else goal["yaw_rad"] - self.thing(name)["yaw_rad"]

    def _miss(self) -> None:
        if self.world.vocabulary.kinds == ("push",):
            point = self.bare()
            self.world.execute(Push((*point, 0.0), (*(point + [0.0, 0.02]), 0.0)))
        else:
            point = self.bare()
            report = self.world.execute(PickPlace((*point, 0.0), (*point, 0.0)))
            assert report.measured["held"] is False

    def _carry(self, name: str, to: np.ndarray, yaw: float) -> None:
        thing = self.thing(name)
        pick, centre = np.array(thing["grasp_m"]), np.array(thing["position_m"])
        turn = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
        end = to + turn @ (pick - centre)[:2]
        report = self.world.execute(PickPlace(pick, (*end, 0.0), math.remainder(yaw, 2 * math.pi)))
        assert report.measured["held"], name

    def push(self, name: str, start: np.ndarray, end: np.ndarray) -> None:
        """Set a thing down and push it straight on until it lies at another place."""
        self.world.privileged.nudge(name, *(start - self.at(name)), yaw_rad=self._square(name, end - start))
        way = (end - start) / np.linalg.norm(end - start)
        self.world.execute(Push((*(start - 0.03 * way), 0.0), (*(end - 0.015 * way), 0.0)))

    def _square(self, name: str, way: np.ndarray) -> float:
        return math.atan2(way[1], way[0]) - self.thing(name)["yaw_rad"]

    def frame(self, across: float, out: float) -> np.ndarray:
        """A point by the three-sided frame: across its opening and out of it, from its middle [m]."""
        frame = self.thing(self.truth["slots"]["bounds"])
        yaw = frame["yaw_rad"]
        outward = np.array([-math.cos(yaw), -math.sin(yaw)])
        return np.array(frame["position_m"][:2]) + out * outward + across * np.array([-outward[1], outward[0]])

    @property
    def verdict(self) -> str:
        score = self.world.privileged.score()
        if score.success:
            return "success"
        return f"failure: {score.reason}" if self.world.privileged.failed else "open"


_FOUND: dict[tuple[str, object, int], int] = {}
"""The first seed that fits, so that it is looked for once."""


@pytest.fixture
def hands() -> Iterator[Callable[..., Hand]]:
    """Makes hands at the first scene from a seed on that fits, and closes their worlds."""
    made: list[TabletopWorld] = []

    def make(task: str, fits: Callable[[dict], bool] | None = None, seed: int = 0) -> Hand:
        for number in range(_FOUND.get((task, fits, seed), seed), seed + 60):
            world = make_world(task, number)
            if fits is None or fits(world.privileged.truth()):
                made.append(world)
                _FOUND[task, fits, seed] = number
                return Hand(world)
            world.close()
        raise AssertionError(f"no seed of {task} from {seed} on fits")

    yield make
    for world in made:
        world.close()
