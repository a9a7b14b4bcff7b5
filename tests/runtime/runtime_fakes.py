"""A small world of coloured squares on a grey table, and policies for it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from wonderful_team.core.actions import PICK_PLACE, At, PickPlace, PickPlaceStep, Vocabulary
from wonderful_team.core.geometry import AffineCamera, Box
from wonderful_team.core.protocols import Act, Done, Score, Situation
from wonderful_team.core.values import (
    GroundedTarget,
    GroundingEvent,
    Instruction,
    Limits,
    NumberSource,
    Observation,
    Plan,
    PlannedAction,
    StepReport,
    Subgoal,
    Target,
    View,
)

PX_PER_M = 256.0
SIZE_PX = (256, 128)
HALF_PX = 8
COLOURS = {"red": (200, 40, 40), "blue": (40, 60, 200), "green": (40, 160, 60)}


def camera() -> AffineCamera:
    """Seen from straight above: x [0.25, 0.75] m runs down the picture, y [-0.5, 0.5] m to the right."""
    return AffineCamera(
        np.array([[0, PX_PER_M, 0, 0.5 * PX_PER_M], [PX_PER_M, 0, 0, -0.25 * PX_PER_M], [0, 0, -1.0, 1.0]])
    )


def to_m(point: tuple[float, float]) -> np.ndarray:
    return camera().on_plane(np.array([point]), 0.0)[0]


@dataclass
class SquaresWorld:
    """Moves squares where it is told; `nudge` moves one before the n-th look, `trouble` is raised by an action."""

    squares: dict[str, tuple[float, float]] = field(
        default_factory=lambda: {"red": (60.0, 60.0), "blue": (160.0, 90.0)}
    )
    vocabulary: Vocabulary = PICK_PLACE
    limits: Limits = Limits((0.25, -0.5, 0.0), (0.75, 0.5, 0.3))
    instruction: Instruction = Instruction("put the red square at the upper right")
    horizon: int | None = None
    nudge: dict[int, tuple[str, float]] = field(default_factory=dict)
    trouble: dict[int, BaseException] = field(default_factory=dict)
    noise: float = 0.0
    reobserve: int = 0
    ran: int = 0
    stopped: int = 0

    def observe(self) -> Observation:
        self.reobserve += 1
        if self.reobserve in self.nudge:
            name, by_px = self.nudge[self.reobserve]
            x, y = self.squares[name]
            self.squares[name] = (x + by_px, y)
        rgb = np.full((SIZE_PX[1], SIZE_PX[0], 3), 150, dtype=np.float64)
        for name, (x, y) in self.squares.items():
            rgb[round(y) - HALF_PX : round(y) + HALF_PX, round(x) - HALF_PX : round(x) + HALF_PX] = COLOURS[name]
        rgb += np.random.default_rng(self.reobserve).normal(0, self.noise, rgb.shape) if self.noise else 0.0
        view = View("top", "top", 0.1 * self.ran, np.clip(rgb, 0, 255).astype(np.uint8), camera=camera())
        return Observation({"top": view})

    def execute(self, action: PickPlace) -> StepReport:
        self.ran += 1
        if self.ran in self.trouble:
            raise self.trouble[self.ran]
        pick, place = camera().project(np.array([action.pick_m, action.place_m]))
        for name, centre in self.squares.items():
            if np.abs(np.array(centre) - pick).max() < HALF_PX:
                self.squares[name] = (float(place[0]), float(place[1]))
                return StepReport(action, True, {"held": True})
        return StepReport(action, False, {"held": False}, "nothing was held")

    def stop(self) -> None:
        self.stopped += 1

    def close(self) -> None:
        pass


@dataclass
class SquaresTruth:
    """Scores a world of squares: is the square near the goal?"""

    world: SquaresWorld
    goals: dict[str, tuple[float, float]]

    def score(self) -> Score:
        far = [name for name, goal in self.goals.items() if np.abs(np.array(self.world.squares[name]) - goal).max() > 4]
        return Score(not far, "execution" if far else None, f"not at its goal: {', '.join(far)}" if far else "")

    def truth(self) -> dict[str, object]:
        return dict(self.world.squares)

    def oracle(self) -> tuple[PickPlace, ...]:
        return ()


def planned(number: int, pick: tuple[float, float], place: tuple[float, float], **changes: object) -> PlannedAction:
    """One pick and place by pixels; target ids are T1, T2 for the first action, T3, T4 for the next."""
    one, two = f"T{2 * number - 1}", f"T{2 * number}"
    sources = tuple(
        NumberSource(role, target, point, tuple(to_m(point).tolist()), f"{target} point, on the table")
        for role, target, point in (("pick", one, pick), ("place", two, place))
    )
    action = PickPlace(to_m(pick), to_m(place))
    return PlannedAction(PickPlaceStep(f"G{number}", one, At(two)), action, sources)


def make_plan(
    observation: Observation, moves: list[tuple[tuple[float, float], tuple[float, float]]], **fields: object
) -> Plan:
    """A complete plan for moves given as (pick, place) pixels."""
    actions = tuple(planned(number, *move) for number, move in enumerate(moves, start=1))
    grounded = {}
    for action, (pick, place) in zip(actions, moves, strict=True):
        one, two = (source.target for source in action.sources)
        box = Box.around(pick, 2 * HALF_PX, 2 * HALF_PX)
        history = (
            GroundingEvent("centre", "three samples", points=(pick, (pick[0] + 4, pick[1] - 3))),
            GroundingEvent("box", "first box", box.shifted(5, -4)),
            GroundingEvent("verdict", "revise: cuts the right edge", box.shifted(5, -4)),
            GroundingEvent("move", "5 px left, 4 px down", box),
            GroundingEvent("verdict", "accept: tight on the target", box),
            GroundingEvent("point", "the middle", box, (pick,)),
        )
        grounded[one] = GroundedTarget(
            Target(one, "object", "square", where="on the table"), "found", "top", box, {"pick": pick}, history
        )
        grounded[two] = GroundedTarget(Target(two, "area", "free space"), "found", "top", None, {"place": place})
    subgoals = tuple(
        Subgoal(f"G{n}", f"move square {n}", targets=(f"T{2 * n - 1}", f"T{2 * n}")) for n in range(1, len(moves) + 1)
    )
    values: dict[str, object] = {
        "instruction": Instruction("put the red square at the upper right"),
        "status": "planned",
        "subgoals": subgoals,
        "targets": tuple(item.target for item in grounded.values()),
        "verified": True,
        "steps": tuple(action.step for action in actions),
        "grounded": grounded,
        "actions": actions,
        "scene_hash": observation.hash,
        "first_draft": (Subgoal("G1", "grab the square"), *subgoals[1:]),
    }
    return Plan(**{**values, **fields})  # type: ignore[arg-type]


@dataclass
class MovesPolicy:
    """Answers each question with the next list of moves, then says it is done."""

    answers: list[list[tuple[tuple[float, float], tuple[float, float]]]]
    name: str = "moves"
    asked: list[Situation] = field(default_factory=list)

    def decide(self, situation: Situation) -> Act | Done:
        self.asked.append(situation)
        if situation.plan is not None:
            return Act(situation.plan.actions, situation.plan)
        if not self.answers:
            return Done("looks right")
        plan = make_plan(situation.observation, self.answers.pop(0))
        return Act(plan.actions, plan)


class Listener:
    """Keeps every event."""

    def __init__(self) -> None:
        self.events: list[object] = []

    def on_event(self, event: object) -> None:
        self.events.append(event)
