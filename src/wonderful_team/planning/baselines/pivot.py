"""`pivot`: points found by selecting among numbered marks, from a cloud that shrinks round the selected ones.

Sources: Nasiriany et al. 2024, PIVOT, arXiv:2402.07872; its replication in Wang, Shen & Stadie 2024, arXiv:2407.19094, Appendix G.2.
Followed, from the replication: uniform sampling; a new radius that is twice the largest distance of a selected mark from their mean, with
a radius of its own for each edge of the picture; 3 iterations, 3 parallel runs; one further query that selects among the runs'
results; pixel coordinates, so that marks are numbered points and no arrows (as on RAVENS).
Left open by both: how many marks are drawn (here 25 over the whole view, then 10) and how many are selected (3); the shape that is sampled in
(an ellipse with the two radii); the least radius, where one mark alone is selected or all lie in a line (half of the one before);
what a run ends with (the mark it ranks first in its last iteration); what is done when nothing is selected (the run ends without a
result; without any the target is taken to be absent). PIVOT finds points and plans nothing: subgoals, targets and steps come from
two plain questions before it. It gives no boxes: what code computes from a thing's outline, such as places beside it, it cannot have.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from wonderful_team.agents.common import ANSWER, DATA, EXAMPLES, INSTRUCTION, LISTED, PICTURES, system_words
from wonderful_team.agents.rendering import (
    ability_parts,
    example_parts,
    listed,
    picture_parts,
    subgoal_parts,
    target_parts,
    task_parts,
    words,
)
from wonderful_team.agents.role import Ask, role
from wonderful_team.agents.scene import SceneShown, show_views
from wonderful_team.contracts import DraftPlan, MarkSelection, PlainPlan, SelectMarks, ShownSlot, StepList, WriteSteps
from wonderful_team.core.actions import At, PushStep, Step
from wonderful_team.core.pictures import Candidates, Picture, Point
from wonderful_team.core.together import together
from wonderful_team.core.values import (
    GroundedTarget,
    GroundingEvent,
    Observation,
    Part,
    Plan,
    PointRole,
    Target,
)
from wonderful_team.models.client import ModelClient
from wonderful_team.planning.baselines.open_loop import OpenLoop

ITERATIONS, PARALLEL = 3, 3
SAMPLES = (25, 10, 10)
"""Marks drawn in each iteration."""
SELECTED = 3
"""Marks that may be selected in each iteration."""
SPREAD = 2.0
"""The next radius, in largest distances of a selected mark from their mean."""
LEAST_SHARE = 0.5
"""Where the selected marks do not differ along an edge, its radius becomes this share of the one before."""
MARK_SHARE = 0.015
"""Marks keep this far from the picture's edge, as a share of its longer side, so that they are seen whole."""

PLANNER = role(
    "drafter",
    system_words(
        """
You plan for a robot. Another model finds a point in the main view for every target that you list; you give no coordinates.
""",
        PICTURES + "\n" + EXAMPLES,
        DATA + "\n" + INSTRUCTION,
        ANSWER,
    ),
    Ask(
        DraftPlan,
        f"""
Write the plan: subgoals in the order in which they are carried out (G1, G2, and so on), each one result that a later picture can
show, and the targets that they need.
- What is found of a target is a point, no outline. So a free spot beside a thing is a target of its own, of kind area.
- No subgoals and targets only when the main view shows that the instruction is already fulfilled.

{LISTED}
- A thing that goes back to where it stood needs no area of its own: steps can say "origin".
""",
        lambda question: [
            *task_parts(question.task),
            *ability_parts(question.step_kinds),
            *listed("What went wrong before, to be avoided now", question.advice),
        ],
    ),
    Ask(
        WriteSteps,
        """
Write the robot's steps for this plan, in order; every subgoal is served. Steps name targets by id. A place is "at" a target, or the
"origin" of a target (where it stood at the start). rotate_deg: only what the instruction or its pictures state; clockwise seen
from above is positive; 0 when nothing is said.
""",
        lambda question: [
            *task_parts(question.task),
            *ability_parts(question.step_kinds),
            *subgoal_parts(question.subgoals),
            *target_parts(question.targets),
            *listed("Subgoals with a path of their own", question.functions),
            *(words("Doubted before:", question.doubt) if question.doubt else []),
        ],
    ),
)

_WANTED: dict[PointRole, str] = {
    "pick": "where the robot takes hold of it: on its solid material, never in a hole",
    "grasp": "where a gripper closes on it: on its solid material",
    "place": "where the middle of what is put there is to come to lie",
    "push_start": "where the front of the tool comes down to push it: beside it, on the side away from where it should go",
    "push_end": "where the front of the tool stops when what it pushes has arrived there",
}


def _render_select(question: SelectMarks) -> list[Part]:
    return [
        *example_parts(question.examples),
        *target_parts((question.target,), "Target"),
        *picture_parts(question.view, "the main view"),
        *words(f"Wanted: a point {_WANTED[question.role]}. Select at most {question.most}."),
    ]


SELECTOR = role(
    "selector",
    system_words(
        """
You find a point in a picture by choosing among numbered dots that were scattered over it. In later rounds they are scattered anew, round
those that you chose.
""",
        PICTURES + "\n" + EXAMPLES,
        DATA,
        ANSWER,
    ),
    Ask(
        SelectMarks,
        """
Give the numbers of the dots that come nearest to the point that is wanted, the best one first. When none is quite right, those that
are nearest to it; no number only when the target is not in the picture at all.
""",
        _render_select,
    ),
    grounds=True,
)


@dataclass(frozen=True)
class Cloud:
    """Where marks are sampled: uniformly in an ellipse, or at first in the whole view.

    Attributes:
        radii: Along the horizontal and the vertical edge [picture px].
    """

    centre: Point
    radii: tuple[float, float]
    whole: bool = False

    @classmethod
    def over(cls, picture: Picture) -> Cloud:
        """All of a view."""
        valid = picture.frame.valid
        return cls(valid.centre, (valid.width / 2, valid.height / 2), whole=True)

    def sample(self, count: int, picture: Picture, rng: np.random.Generator) -> tuple[Point, ...]:
        """Marks that lie whole in the view; those outside are drawn again, and at last moved to its edge."""
        room = MARK_SHARE * max(picture.size_px)
        valid = picture.frame.valid.grown(-room, -room, -room, -room)
        points: list[Point] = []
        for _ in range(20 * count):
            unit = rng.uniform(-1.0, 1.0, 2)
            x, y = np.asarray(self.centre) + np.asarray(self.radii) * unit
            point = (float(x), float(y))
            if (self.whole or float(unit @ unit) <= 1.0) and valid.contains(point):
                points.append(point)
            if len(points) == count:
                return tuple(points)
        nearest = (min(max(self.centre[0], valid.x0), valid.x1), min(max(self.centre[1], valid.y0), valid.y1))
        return (*points, *[nearest] * (count - len(points)))

    def narrowed(self, selected: Sequence[Point]) -> Cloud:
        """The cloud round these marks."""
        mean = np.mean(selected, axis=0)
        away = np.abs(np.asarray(selected) - mean).max(axis=0)
        radii = [SPREAD * far if far > 1.0 else LEAST_SHARE * old for far, old in zip(away, self.radii, strict=True)]
        return Cloud((float(mean[0]), float(mean[1])), (float(radii[0]), float(radii[1])))


class Pivot(OpenLoop):
    """Plans in two questions, then finds every point in ITERATIONS x PARALLEL + 1.

    Args:
        client: Where the model is asked.
    """

    def __init__(self, client: ModelClient) -> None:
        super().__init__(client, "pivot", PLANNER, SELECTOR)

    async def make_plan(self, scene: SceneShown, start: Plan, advice: tuple[str, ...]) -> Plan:
        """One plan; all its points at once."""
        kinds = tuple(kind for kind in scene.vocabulary.step_kinds if kind != "follow")
        question = DraftPlan(scene.task, kinds, True, advice, plain=True)
        draft: PlainPlan = (await self.ask(question, PLANNER, "plan")).value
        subgoals, targets, steps = draft.to_subgoals(), draft.to_targets(), tuple[Step, ...]()
        if subgoals:
            asked = WriteSteps(scene.task, kinds, subgoals, targets, outlines=False)
            written: StepList = (await self.ask(asked, PLANNER, "act")).value
            steps = written.to_steps()
        view, seed = scene.views[0], scene.observation.hash
        found = await together(
            self._ground(view, target, _roles(target, steps), scene.examples([target]), seed) for target in targets
        )
        grounded = {item.target.id: item for item in found}
        return self.with_actions(scene, start, subgoals, grounded, steps)

    async def _ground(
        self, view: Picture, target: Target, roles: Sequence[PointRole], examples: tuple[ShownSlot, ...], seed: str
    ) -> GroundedTarget:
        found = await together(self._point(view, target, role, examples, seed) for role in roles)
        told = tuple(event for _, events in found for event in events)
        points: dict[str, Point] = {
            role: view.frame.point_to_view(point)
            for role, (point, _) in zip(roles, found, strict=True)
            if point is not None
        }
        here: Literal["found", "absent"] = "found" if len(points) == len(roles) else "absent"
        return GroundedTarget(target, here, view.frame.view_id, None, points, told)

    async def _point(
        self, view: Picture, target: Target, role: PointRole, examples: tuple[ShownSlot, ...], seed: str
    ) -> tuple[Point | None, list[GroundingEvent]]:
        """One point of a target [px of the picture], and how it came about."""
        runs = await together(self._run(view, target, role, examples, seed, run) for run in range(1, PARALLEL + 1))
        events = [event for _, told in runs for event in told]
        ends = tuple(point for point, _ in runs if point is not None)
        if not ends:
            return None, events
        shown = view.marked(Candidates(ends))
        question = SelectMarks(target, role, shown, 1, examples)
        answer = await self.ask(question, SELECTOR, "ground", f"{target.id}.{role}.final")
        selection: MarkSelection = answer.value
        if not selection.numbers:
            return None, events
        point = ends[selection.numbers[0] - 1]
        said = f"{role}: the result of one run of {len(ends)}"
        in_view = view.frame.point_to_view(point)
        return point, [*events, GroundingEvent("chosen", said, None, (in_view,), answer.provenance)]

    async def _run(
        self, view: Picture, target: Target, role: PointRole, examples: tuple[ShownSlot, ...], seed: str, run: int
    ) -> tuple[Point | None, list[GroundingEvent]]:
        """One of the parallel runs: what it ends with, and its iterations."""
        cloud, best, events = Cloud.over(view), None, list[GroundingEvent]()
        for iteration, count in enumerate(SAMPLES, start=1):
            key = f"{seed}|{self.attempt}|{target.id}|{role}|{run}|{iteration}"
            rng = np.random.default_rng(zlib.crc32(key.encode()))
            marks = Candidates(cloud.sample(count, view, rng))
            question = SelectMarks(target, role, view.marked(marks), SELECTED, examples)
            answer = await self.ask(question, SELECTOR, "ground", f"{target.id}.{role}.run{run}", sample=run)
            selection: MarkSelection = answer.value
            points = [marks.at(number) for number in selection.numbers]
            told = f"{role}, run {run}, iteration {iteration}: {len(points)} of {count} marks selected"
            in_view = tuple(view.frame.point_to_view(point) for point in points)
            events.append(GroundingEvent("centre", told, None, in_view, answer.provenance))
            if not points:
                return None, events
            best, cloud = points[0], cloud.narrowed(points)
        return best, events

    async def ground(self, observation: Observation, asked: Sequence[str]) -> list[GroundedTarget]:
        """Things found by their descriptions, without a plan."""
        view, seed = show_views(observation)[0], observation.hash
        targets = [Target(f"T{number}", "object", said) for number, said in enumerate(asked, start=1)]
        return await together(self._ground(view, target, ("pick",), (), seed) for target in targets)

    async def locate(self, observation: Observation, asked: Sequence[str]) -> list[Point | None]:
        """Where things in a photo are: a point in pixels of the photo for each, or None."""
        return [item.points.get("pick") for item in await self.ground(observation, asked)]


def _roles(target: Target, steps: Sequence[Step]) -> tuple[PointRole, ...]:
    """The points to be found: what the target lists, and for what is pushed both ends of the tool's way."""
    ends: list[PointRole] = []
    for step in steps:
        if isinstance(step, PushStep):
            ends += ["push_start"] if step.start == At(target.id) else []
            ends += ["push_end"] if step.end == At(target.id) else []
    return tuple(dict.fromkeys(ends)) or target.roles
