"""What the rivals share: a plan at first, one more after a refusal, and no judgement of what came of it.

Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Appendix D.1: on VIMA-Bench methods are compared in one attempt, open loop.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

from wonderful_team.agents import Prompts, build_request
from wonderful_team.agents.role import Role
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import Question
from wonderful_team.core.actions import Step
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.core.plan_endings import ENDS_A_PLAN, ended_by, to_mend
from wonderful_team.core.protocols import Act, Decision, Done, GaveUp, Situation
from wonderful_team.core.values import (
    Answer,
    GroundedTarget,
    GroundingEvent,
    Plan,
    Provenance,
    Subgoal,
    Target,
    Usage,
)
from wonderful_team.errors import ActionRefusedError, NotFoundError
from wonderful_team.models.client import ModelClient
from wonderful_team.motion import ground_actions


class OpenLoop(ABC):
    """A rival that plans from what is seen, has the plan run, and is done; one that judges what came of it says so in `after`.

    Args:
        client: Where its model is asked: capped and recorded.
        name: As the table of methods has it.
        roles: What it asks as.
    """

    def __init__(self, client: ModelClient, name: str, *roles: Role) -> None:
        self.name = name
        self.client = client
        self.prompts = Prompts.of(*roles)
        self.attempt = 0
        self._asked: Counter[str] = Counter()
        self._best: Plan | None = None
        self._to_mend = ""

    @property
    def usage_by_role(self) -> Mapping[str, Usage]:
        """What this trial cost so far."""
        return dict(self.client.budget.by_role)

    @property
    def model_name(self) -> str:
        """Which model is asked."""
        return self.client.model_name

    @property
    def setting(self) -> Mapping[str, str]:
        """How it is set up, for the record."""
        return {"loop": "open", "prompts": self.prompts.hash}

    async def decide(self, situation: Situation) -> Decision:
        """A plan at first, and again after a refusal while replans are left; after execution it is done."""
        if situation.plan is not None and not situation.executed and situation.refused is None:
            return Act(situation.plan.actions, situation.plan)
        advice: tuple[str, ...] = ()
        if situation.executed:
            judged = await self.after(situation)
            if not isinstance(judged, str):
                return judged
            advice = (judged,)
        if situation.advice:
            advice = (f"A person declined the plan: {situation.advice}",)
        elif situation.refused is not None:
            if situation.replans_left <= 0:
                return GaveUp(str(ActionRefusedError(situation.refused.reasons)), "gate", self._best)
            advice = tuple(f"The safety gate refused: {reason}" for reason in situation.refused.reasons)
        elif self._to_mend and not situation.executed and situation.attempt:
            advice = (f"The last plan could not be made ready: {self._to_mend}.",)
        self.attempt = situation.attempt
        plan = await self._planned(situation, advice)
        if plan.status != "planned":
            return GaveUp(plan.message, plan.stage or "plan", plan, again=bool(self._to_mend))
        return Act(plan.actions, plan) if plan.actions else Done(plan.message)

    async def after(self, situation: Situation) -> Done | GaveUp | str:
        """What follows once the plan has run: the end, or in words what the next plan should heed."""
        return Done("the plan has run; this method does not judge what came of it")

    async def _planned(self, situation: Situation, advice: tuple[str, ...]) -> Plan:
        limits = situation.limits
        scene = self.scene_of(situation)
        before = None if self._best is None else self._best.id
        start = Plan(
            situation.instruction, "failed", keep_out=limits.keep_out, scene_hash=situation.observation.hash, parent=before
        )  # fmt: skip
        self._best, self._to_mend = start, ""
        try:
            plan = await self.make_plan(scene, start, advice)
        except ENDS_A_PLAN as error:
            plan, self._to_mend = ended_by(self._best, error), to_mend(error)
        self._best = plan
        self.client.tell("plan", plan.id, plan)
        return plan

    @staticmethod
    def scene_of(situation: Situation) -> SceneShown:
        """What is seen now, ready to be shown."""
        return SceneShown(
            situation.observation, situation.instruction, situation.vocabulary, situation.limits, situation.facts
        )

    def stage(self, name: str, text: str) -> None:
        """Tell subscribers that something was done, in one line."""
        self.client.tell("stage", name, {"text": text, "attempt": self.attempt})

    @abstractmethod
    async def make_plan(self, scene: SceneShown, start: Plan, advice: tuple[str, ...]) -> Plan:
        """The plan for what is seen now.

        Args:
            scene: What is seen, ready to be shown.
            start: An empty plan that knows its instruction, picture and regions.
            advice: Why the last plan did not run, a line each.

        Raises:
            PlanError, NotFoundError, ModelOutputError, BudgetReached, NotUnderstoodError: It came to none; the best so far is kept.
        """

    async def ask(self, question: Question, role: Role, stage: str, branch: str = "main", sample: int = 0) -> Answer:
        """The settled answer to one question; questions that are asked at the same time belong to different branches."""
        self._asked[branch] += 1
        name = f"{self.attempt}/{stage}/{branch}/{question.contract}/{self._asked[branch]}"
        request = build_request(question, id=name, stage=stage, role=role, sample=sample)
        return await self.client.ask(request)

    def keep(self, plan: Plan) -> Plan:
        """Remember the best so far: what an error leaves behind."""
        self._best = plan
        return plan

    def with_actions(
        self,
        scene: SceneShown,
        plan: Plan,
        subgoals: Sequence[Subgoal],
        grounded: Mapping[str, GroundedTarget],
        steps: tuple[Step, ...],
    ) -> Plan:
        """The plan with the numbers of its steps, which the same code computes as for every other method.

        Raises:
            NotFoundError: A target is not there.
            GeometryError: The numbers of a step cannot be computed.
        """
        targets = tuple(item.target for item in grounded.values())
        plan = self.keep(replace(plan, subgoals=tuple(subgoals), targets=targets, grounded=grounded, steps=steps))
        absent = [item.target for item in grounded.values() if item.status != "found"]
        if absent:
            raise NotFoundError("; ".join(f"{target.id} not found: {target.words}" for target in absent))
        actions = ground_actions(steps, grounded, scene.view, scene.limits)
        said = "" if actions else "nothing to do: the instruction is already fulfilled"
        return self.keep(replace(plan, status="planned", message=said, actions=actions))


def pointed(
    target: Target,
    points: Mapping[str, Point],
    shown: Picture,
    how: str,
    provenance: Provenance,
    box: Box | None = None,
) -> GroundedTarget:
    """A target whose points were given in a picture of the main view, in pixels of that view; absent without any."""
    in_view = {role: shown.frame.point_to_view(point) for role, point in points.items()}
    if not in_view:
        told = GroundingEvent("absent", how, provenance=provenance)
        return GroundedTarget(target, "absent", shown.frame.view_id, history=(told,))
    box = None if box is None else shown.frame.box_to_view(box)
    told = GroundingEvent("point", how, box, tuple(in_view.values()), provenance)
    return GroundedTarget(target, "found", shown.frame.view_id, box, in_view, (told,))
