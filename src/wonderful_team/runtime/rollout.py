"""One attempt at one scene: observe, decide, pass the gate, execute, look, replan. Knows no simulator and no model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from wonderful_team.core.protocols import (
    Act,
    ChecksSubgoals,
    Done,
    GaveUp,
    Policy,
    Privileged,
    Situation,
    Subscriber,
    World,
    facts_of,
    offers,
)
from wonderful_team.core.values import Observation, Plan, ReadPlan, SubgoalRun, Trial
from wonderful_team.errors import (
    BudgetReached,
    ConfigError,
    ModelUnavailableError,
    RobotFaultError,
    SafetyStopError,
    WonderfulTeamError,
    WorldUnavailableError,
)
from wonderful_team.runtime.approval import Approval, Approver
from wonderful_team.runtime.execute import Check, Execution
from wonderful_team.runtime.loop import Caller
from wonderful_team.runtime.optional import ChunkPolicy, Horizon
from wonderful_team.runtime.rollout_log import RolloutEnd, RolloutLog
from wonderful_team.runtime.staleness import MAX_AGE_S
from wonderful_team.runtime.user_code import GuardedWorld, checked_of, decision_of, score_of

NOBODY_JUDGED = "; nobody judged the result: there is no scorer, and a method judges only where it may replan"

MAX_ADVICE = 10
"""Most plans of one run that a person may decline with advice for another one."""
MAX_DECISIONS = 500
"""Most times a chunk policy is asked in a world without a horizon."""


def rollout(
    policy: Policy,
    world: World,
    *,
    plan: Plan | ReadPlan | None = None,
    plan_observation: Observation | None = None,
    replans: int = 0,
    reobserve: int = 0,
    scorer: Privileged | None = None,
    subscribers: Sequence[Subscriber] = (),
    approval: Approval | Approver | None = None,
    seed: int | None = None,
    scene: str = "",
    configuration: Mapping[str, Any] | None = None,
    max_age_s: float | None = MAX_AGE_S,
    page: Callable[[], Path | None] | None = None,
    strict: bool = False,
) -> Trial:
    """Run a policy in a world.

    Args:
        policy: The method; its `decide` may be plain or async.
        world: Where it acts. A world with a `horizon` is stopped after that many actions.
        plan: A plan that was read beforehand: exactly its actions run, in its own instruction and scene, or nothing
            moves and the trial ends. Once they ran, replans go on as asked for.
        plan_observation: The picture that plan was made from; without it the scene must be pixel for pixel the same.
        replans: How often the policy may answer with new actions after its first ones ran or were refused, or after it gave up on a plan
            that a new look may mend.
        reobserve: How often the policy may run only the first actions of its plan and be asked again with a new picture, which is
            not a replan. 0: every plan runs whole (open loop). A plan that was read beforehand always runs whole.
        scorer: Judges the outcome after the trial, and only then; None leaves it unscored.
        subscribers: Told of every event, in order.
        approval: Consent to one plan, or a function that is asked for it before motion; given, it is required. A no
            ends the trial; a no with a reason lets the policy make one new plan, which is asked about again.
        seed: Of the scene; None for a photo or a real robot.
        scene: What the trial is called in the record.
        configuration: What else the record should say.
        max_age_s: Oldest picture that may be acted upon [s]; None for no limit.
        page: Writes the page that a person reads before she is asked, and returns its path.
        strict: Refuse a plan that was read beforehand and that Verification did not approve.

    Returns:
        The whole trial. The method's errors are failures with their stage; a provider's absence is an error.

    Raises:
        ConfigError: Before anything moved: wrong use.
        KeyboardInterrupt: The world was stopped first, and subscribers were handed what had happened so far.
    """
    if replans < 0:
        raise ConfigError(f"replans must be 0 or more, got {replans}")
    if reobserve < 0:
        raise ConfigError(f"reobserve must be 0 or more, got {reobserve}")
    if reobserve and (plan is not None or isinstance(approval, Approval)):
        raise ConfigError(
            f"reobserve is {reobserve}, but the plan was read (or approved) beforehand: it runs as it is, so reobserve must be 0"
        )
    world = cast(World, GuardedWorld(world))
    progress = RolloutLog(policy, scene, seed, tuple(subscribers))
    setup = {"method": policy.name, "seed": seed, "replans": replans, "looks": reobserve, **(configuration or {})}
    progress.tell("run", scene, {**setup, "task": world.instruction, "limits": world.limits})
    read = ReadPlan(plan, plan_observation) if isinstance(plan, Plan) else plan
    if read is not None and read.observation is not None:
        progress.tell("plan_scene", scene, read.observation)
    execution = Execution(world, progress, approval, max_age_s, page, strict)
    try:
        with Caller() as caller:
            try:
                ending = _attempts(policy, world, caller, execution, progress, read, replans, reobserve)
            except BaseException:
                # First of all, before anything is waited for.
                _halt(world, progress)
                raise
    except (KeyboardInterrupt, Exception) as error:  # noqa: BLE001  sorted by fault; what is unknown is raised again
        return _stop(progress, error)
    return _scored(progress, ending, scorer)


def _attempts(
    policy: Policy,
    world: World,
    caller: Caller,
    execution: Execution,
    progress: RolloutLog,
    read: ReadPlan | None,
    replans: int,
    reobserve: int,
) -> RolloutEnd:
    """Ask, gate, execute, until the policy or a bound ends it."""
    chunks = offers(policy, ChunkPolicy) and policy.chunks
    horizon = world.horizon if offers(world, Horizon) else None
    attempt, first_run, left, advised = 0, 0, replans, 0
    refused, advice, halted = None, "", None
    replanning = False
    observation = progress.observe(world, "start")
    for _ in range(MAX_DECISIONS):
        # What ran is told once: since the last question.
        told = tuple(progress.runs[first_run:])
        first_run = len(progress.runs)
        situation = Situation(
            observation,
            world.instruction,
            world.vocabulary,
            world.limits,
            attempt=attempt,
            replans_left=left,
            executed=told,
            refused=refused,
            plan=read.plan if read is not None else None,
            reobserve_left=reobserve,
            advice=advice,
            facts=facts_of(world),
        )
        progress.asking(situation)
        decision = decision_of(policy, situation, caller)
        if isinstance(decision, GaveUp) and decision.again and left > replanning:
            # Nothing of it can run, as after a refusal: it was a plan, and the next one is a replan.
            progress.decided(decision)
            if decision.plan is not None:
                progress.add_plan(decision.plan)
            left, replanning, attempt = left - replanning, True, attempt + 1
            read, refused, advice, halted = None, None, "", None
            observation = progress.observe(world, f"attempt {attempt}")
            continue
        if replanning and left == 0 and isinstance(decision, Act):
            # It was asked only for its judgement of what ran last.
            return halted or _ran_out()
        progress.decided(decision)
        if not isinstance(decision, Act):
            return _said(decision, progress)
        left -= replanning
        then = observation if read is None else read.observation
        check = _after_subgoals(policy, caller, progress, replace(situation, replans_left=left), first_run)
        halted = execution.run(decision, then, horizon, read=read, again=left > 0, check=check)
        if halted is not None and halted.final:
            return halted
        read, refused = None, execution.refusal
        advice = execution.declined.because if execution.declined is not None else ""
        looking = decision.reobserve and reobserve > 0 and halted is None
        if advice:
            advised += 1
            if advised > MAX_ADVICE:
                return RolloutEnd("failure", "gate", f"{MAX_ADVICE} plans were declined with advice; nothing moved")
        reobserve -= looking
        replanning = not (looking or advice or (chunks and refused is None))
        attempt += not (looking or (chunks and refused is None))
        if replanning and left == 0 and (replans == 0 or refused is not None):
            return halted or _ran_out()
        observation = progress.observe(world, "look" if looking else f"attempt {attempt}")
    return RolloutEnd("failure", "budget", f"the policy was asked {MAX_DECISIONS} times")


def _after_subgoals(
    policy: Policy, caller: Caller, progress: RolloutLog, asked: Situation, first_run: int
) -> Check | None:
    """Ask a method after every subgoal whether to go on; None for one that is not asked."""
    if not (offers(policy, ChecksSubgoals) and policy.checks_subgoals):
        return None

    def check(run: SubgoalRun, doubts: tuple[str, ...]) -> str:
        told = tuple(progress.runs[first_run:])
        situation = replace(
            asked, observation=run.after, executed=told, refused=None, plan=None, advice="", doubts=doubts
        )
        progress.asking(situation, check=True)
        checked = checked_of(policy, situation, caller)
        progress.checked(checked)
        return checked.stop

    return check


def _said(decision: Done | GaveUp | Any, progress: RolloutLog) -> RolloutEnd:
    match decision:
        case Done():
            return RolloutEnd(None, None, decision.reason or "the method believes that it is done")
        case GaveUp():
            if decision.plan is not None:
                progress.add_plan(decision.plan)
            return RolloutEnd("failure", decision.stage, decision.reason)
    raise ConfigError(f"decide must return Act, Done or GaveUp; it returned {type(decision).__name__}")


def _ran_out() -> RolloutEnd:
    return RolloutEnd(None, None, "the plan's actions ran out")


def _halt(world: World, progress: RolloutLog) -> None:
    """Stop what moves. That it cannot be stopped is told, and hides nothing of what happened before."""
    try:
        world.stop()
    except WonderfulTeamError as worse:
        progress.tell("warning", "halt", f"{worse}: the robot may still be moving; a person must look")
        progress.traced(worse)


def _stop(progress: RolloutLog, error: BaseException) -> Trial:
    """End a trial that an exception cut short; raises what is neither the method's, the provider's nor the robot's."""
    if isinstance(error, WonderfulTeamError):
        progress.traced(error)
    match error:
        case RobotFaultError() | SafetyStopError():
            progress.tell("warning", "halt", f"{error}. The run is halted; a person should look before it goes on.")
            return progress.finish(RolloutEnd("failure", error.stage or "execution", str(error)))
        case ModelUnavailableError() | WorldUnavailableError():
            return progress.finish(RolloutEnd("error", error.stage or "model", str(error)))
        case WonderfulTeamError() if not isinstance(error, ConfigError):
            return progress.finish(RolloutEnd("failure", error.stage or "plan", str(error)))
    interrupted = isinstance(error, KeyboardInterrupt)
    reason = str(error) or "interrupted" if interrupted else f"{type(error).__name__}: {error}"
    progress.tell("warning", "interrupted" if interrupted else "crash", reason)
    progress.finish(RolloutEnd("error", "interrupted" if interrupted else "crash", reason))
    raise error


def _scored(progress: RolloutLog, ending: RolloutEnd, scorer: Privileged | None) -> Trial:
    """Let truth decide, now that nothing can learn from it any more."""
    if scorer is None:
        unjudged = NOBODY_JUDGED if ending.outcome is None and progress.unasked else ""
        return progress.finish(RolloutEnd(ending.outcome or "unscored", ending.stage, f"{ending.reason}{unjudged}"))
    try:
        score = score_of(scorer)
    except BudgetReached as error:
        reason = f"{ending.reason}; nobody judged the result: {error}"
        return progress.finish(RolloutEnd(ending.outcome or "unscored", ending.stage or error.stage, reason))
    except WonderfulTeamError as error:
        progress.traced(error)
        return progress.finish(RolloutEnd("error", error.stage or "world", str(error)))
    match score.success:
        case True:
            return progress.finish(RolloutEnd("success", None, score.reason or ending.reason))
        case False:
            said = "; ".join(text for text in (ending.reason, score.reason) if text)
            # Nothing failed in being carried out where nothing was: that there was something to do was not seen.
            otherwise = "execution" if progress.runs else "plan"
            return progress.finish(RolloutEnd("failure", ending.stage or score.stage or otherwise, said))
    said = score.reason or "the scorer could not judge"
    return progress.finish(RolloutEnd(ending.outcome or "unscored", ending.stage, said))
