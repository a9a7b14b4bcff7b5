"""The Team: plan, check, ground, act; then look, judge and replan. One of several methods behind `Policy`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from wonderful_team.agents.scene import SceneShown
from wonderful_team.core.actions import Vocabulary
from wonderful_team.core.caps import Caps
from wonderful_team.core.plan_endings import ENDS_A_PLAN, ended_by, to_mend
from wonderful_team.core.protocols import Act, Checked, Decision, Detector, Done, GaveUp, Model, Situation, Subscriber
from wonderful_team.core.values import (
    NO_WORKSPACE,
    AskUser,
    Instruction,
    KeepOut,
    Limits,
    Observation,
    Plan,
    Usage,
    Verdict,
)
from wonderful_team.detectors import name_of
from wonderful_team.errors import ActionRefusedError, ConfigError, NeedsClarification
from wonderful_team.models.budget import Budget
from wonderful_team.models.client import DEADLINE_S, ModelClient
from wonderful_team.planning import judging
from wonderful_team.planning.checking import SubgoalChecks, done_subgoals
from wonderful_team.planning.clarifying import clarify
from wonderful_team.planning.config import TeamConfig
from wonderful_team.planning.looking import condensed, done_lines, first_part, is_uncertain
from wonderful_team.planning.making import UNTIL, Progress, Until, make
from wonderful_team.planning.notes import one_line
from wonderful_team.planning.session import AgentSession, needed_detector, settle


class TeamPolicy:
    """A team of agents over one model, or over one model per role.

    Args:
        model: A model, or a mapping from role to model with "*" for the rest.
        config: Way of working, setting, bounds, words.
        caps: Upper limits on calls, tokens, seconds and money, per trial.
        subscribers: Told of everything that happens.
        detector: Who finds things where `config.grounding` is "detector".
        ask: Asks the user what neither picture nor instruction settles; None: such a question ends planning.

    Raises:
        ConfigError: A detector is needed and not there.
    """

    def __init__(
        self,
        model: Model | Mapping[str, Model],
        config: TeamConfig | None = None,
        *,
        caps: Caps | None = None,
        subscribers: Sequence[Subscriber] = (),
        concurrency: int = 8,
        deadline_s: float = DEADLINE_S,
        detector: Detector | None = None,
        ask: AskUser | None = None,
    ) -> None:
        self._ask = ask
        self.config = config or TeamConfig()
        self.name = self.config.name
        self._detector = needed_detector(self.config, detector)
        self._caps = caps or Caps()
        self._client = ModelClient(
            model,
            budget=Budget(self._caps),
            subscribers=subscribers,
            concurrency=concurrency,
            deadline_s=deadline_s,
        )
        self.reset()

    @property
    def usage_by_role(self) -> Mapping[str, Usage]:
        """What this trial cost so far."""
        return dict(self._client.budget.by_role)

    @property
    def usage(self) -> Usage:
        return self._client.budget.spent

    @property
    def model_name(self) -> str:
        """Which model serves the team, or which role has which."""
        return self._client.model_name

    @property
    def setting(self) -> Mapping[str, str]:
        """How the team is set up, for the record."""
        config = self.config
        told = {"way": config.mode, "members": config.ablation, "prompts": config.prompts.hash}
        if config.grounding != "team":
            told["grounding"] = config.grounding
        if self._detector is not None:
            told["detector"] = name_of(self._detector)
        return told

    def _begin(self, instruction: Instruction) -> AgentSession:
        return AgentSession(self._client, self.config, instruction.text, self._detector)

    def reset(self) -> None:
        """Forget the trial: notebooks, memory, budget."""
        self._client.budget = Budget(self._caps)
        self._session: AgentSession | None = None
        self._last: tuple[SceneShown, Plan] | None = None
        self._looking = False
        self._to_mend = ""
        self._said: tuple[str, ...] = ()
        self._done: tuple[str, ...] = ()
        self._checks = SubgoalChecks()

    async def make_plan(
        self,
        observation: Observation,
        instruction: Instruction,
        vocabulary: Vocabulary,
        limits: Limits = NO_WORKSPACE,
        *,
        until: Until = "actions",
        keep_out: Sequence[KeepOut] = (),
        advice: Sequence[str] = (),
        done: Sequence[str] = (),
        facts: str = "",
        parent: str | None = None,
    ) -> Plan:
        """A plan for what is seen now. Failures of the method come back as the plan's status, with the best so far.

        `advice` is what went wrong before, or was said against the last plan; `done` what was carried out since the
        instruction was given, as planned; `facts` what is known of the robot and its place, one fact a line.

        Raises:
            ModelUnavailableError: The provider did not answer.
            ConfigError: Wrong use.
        """
        if until not in UNTIL:
            raise ConfigError(f"until {until!r}: valid are {', '.join(UNTIL)}")
        scene = SceneShown(
            observation, instruction, vocabulary, limits, facts, tuple(keep_out), self._said, tuple(done)
        )
        session = self._session or self._begin(instruction)
        self._session = session
        start = Plan(instruction, "failed", keep_out=tuple(keep_out), scene_hash=observation.hash, parent=parent)
        progress, self._to_mend = Progress(start), ""
        try:
            for line in advice:
                session.note("verification", "before", one_line(f"What went wrong before this plan: {line}"))
            plan, scene = await self._plan_asking(session, scene, progress, until, tuple(advice))
            # What Memory is still writing belongs to this plan: whether it is kept must not be a matter of luck.
            await session.memory.barrier()
        except ENDS_A_PLAN as error:
            plan, self._to_mend = ended_by(progress.plan, error), to_mend(error)
        finally:
            await settle(session)
        plan = replace(plan, functions=session.functions)
        session.tell_skipped()
        session.begin_attempt()
        self._last = (scene, plan)
        self._client.tell("plan", plan.id, plan)
        return plan

    async def _plan_asking(
        self, session: AgentSession, scene: SceneShown, progress: Progress, until: Until, advice: tuple[str, ...]
    ) -> tuple[Plan, SceneShown]:
        """A plan, the user asked where nothing else settles what is meant; and the scene with what the user said."""
        start = progress.plan
        for _ in range(self.config.bounds.clarifications):
            try:
                return await make(session, scene, progress, until, advice), scene
            except NeedsClarification as error:
                self._said = (*self._said, (await clarify(session, self._ask, error, self._said)).words)
                scene, progress.plan = replace(scene, said=self._said), start
        return await make(session, scene, progress, until, advice), scene

    async def decide(self, situation: Situation) -> Decision:
        """Policy: plan at first; after execution judge, and replan while allowed."""
        if situation.attempt == 0 and not situation.executed and situation.refused is None:
            self.reset()
            if situation.plan is not None:
                return self._take_over(situation, situation.plan)
            return await self._next_plan(situation, (), None)
        looking, self._looking = self._looking, False
        if self._last is None:
            raise ConfigError("the team is asked to go on with a trial that it did not begin")
        scene, plan = self._last
        if situation.refused is not None:
            return await self._after_refusal(situation, plan)
        assert self._session is not None
        if self._to_mend and not situation.executed:
            self._session.stage("replan", f"{self._to_mend}: looked again, and planned anew")
            return await self._next_plan(situation, (f"The last plan could not be made ready: {self._to_mend}.",), plan)
        if looking and all(report.executed for run in situation.executed for report in run.reports):
            # Not judged first: the new plan holds what is left to do in the new picture.
            self._done = (*self._done, *done_lines(plan))
            return await self._next_plan(situation, (), plan)
        verdicts = await self._checks.verdicts(self._session, scene, plan, situation)
        self._done = done_subgoals(plan, verdicts)
        if all(verdict.status == "done" for verdict in verdicts):
            return Done("every subgoal is done", verdicts)
        causes = judging.causes(verdicts)
        if situation.replans_left <= 0:
            return GaveUp(f"no replans left; {causes}", "execution", plan, verdicts)
        now = replace(_scene_of(situation), said=self._said)
        advice = await judging.advise(self._session, now, plan, verdicts, situation.executed, situation.replans_left)
        if advice.decision == "done":
            return Done(advice.reasoning, verdicts)
        if advice.decision == "give_up":
            return GaveUp(advice.cause or causes, "execution", plan, verdicts)
        told = () if self._checks.stopped else verdicts  # those of a plan that was stopped were told then
        return await self._next_plan(situation, (f"{advice.cause} {advice.advice}".strip(),), plan, told)

    @property
    def checks_subgoals(self) -> bool:
        """Policy: `paper` judges whole attempts only, as the paper does."""
        return self.config.mode == "lean"

    async def check(self, situation: Situation) -> Checked:
        """Policy: after a subgoal, while others are still to run."""
        if self._session is None or self._last is None:
            raise ConfigError("the team is asked about a subgoal of a trial that it did not begin")
        return await self._checks.check(self._session, *self._last, situation)

    async def _after_refusal(self, situation: Situation, plan: Plan) -> Decision:
        assert situation.refused is not None
        self._done = done_subgoals(plan, self._checks.known) or self._done
        if situation.advice:
            self._said = (*self._said, f"declined the last plan: {situation.advice}")
            return await self._next_plan(situation, (f"A person declined the plan: {situation.advice}",), plan)
        reasons = situation.refused.reasons
        if situation.replans_left <= 0:
            return GaveUp(str(ActionRefusedError(reasons)), "gate", plan)
        return await self._next_plan(situation, tuple(f"The safety gate refused: {reason}" for reason in reasons), plan)

    def _take_over(self, situation: Situation, plan: Plan) -> Decision:
        self._session = self._begin(situation.instruction)
        self._session.attempt = 1
        # The plan was made in an earlier sitting of this very task: what was accepted for it need not be written again.
        self._session.functions = plan.functions
        self._last = (_scene_of(situation), plan)
        return Act(plan.actions, plan)

    async def _next_plan(
        self,
        situation: Situation,
        advice: tuple[str, ...],
        before: Plan | None,
        verdicts: tuple[Verdict, ...] = (),
    ) -> Decision:
        self._checks = SubgoalChecks()
        plan = await self.make_plan(
            situation.observation,
            situation.instruction,
            situation.vocabulary,
            situation.limits,
            keep_out=situation.limits.keep_out,
            advice=advice,
            done=condensed(self._done),
            facts=situation.facts,
            parent=before.id if before is not None else None,
        )
        if plan.status != "planned":
            return GaveUp(plan.message, plan.stage or "plan", plan, verdicts, bool(self._to_mend))
        if not plan.actions:
            return Done(plan.message, verdicts)
        if situation.reobserve_left > 0 and is_uncertain(plan):
            self._looking = True
            first = first_part(plan)
            self._last = None if self._last is None else (self._last[0], first)
            return Act(first.actions, first, verdicts, reobserve=True)
        return Act(plan.actions, plan, verdicts)


def _scene_of(situation: Situation) -> SceneShown:
    return SceneShown(
        situation.observation, situation.instruction, situation.vocabulary, situation.limits, situation.facts
    )
