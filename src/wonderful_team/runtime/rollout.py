"""One attempt at one scene: observe, decide, pass the gate, execute, look, replan. Knows no simulator and no model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, cast

from wonderful_team.errors import (
    ConfigError,
    ModelUnavailableError,
    RobotFaultError,
    SafetyStopError,
    WonderfulTeamError,
    WorldUnavailableError,
)
from wonderful_team.interfaces import Act, Done, GaveUp, Policy, Privileged, Situation, Subscriber, World
from wonderful_team.runtime.approval import Approval, Approver
from wonderful_team.runtime.execute import Execution
from wonderful_team.runtime.freshness import MAX_AGE_S
from wonderful_team.runtime.loop import Caller
from wonderful_team.runtime.optional import ChunkPolicy, Horizon
from wonderful_team.runtime.progress import Ending, Progress
from wonderful_team.runtime.user_code import GuardedScorer, GuardedWorld, decision_of
from wonderful_team.types import Observation, Plan, Trial

MAX_DECISIONS = 500
"""Most times a chunk policy is asked in a world without a horizon."""


def rollout(
    policy: Policy,
    world: World,
    *,
    plan: Plan | None = None,
    plan_observation: Observation | None = None,
    replans: int = 0,
    looks: int = 0,
    scorer: Privileged | None = None,
    subscribers: Sequence[Subscriber] = (),
    approval: Approval | Approver | None = None,
    seed: int | None = None,
    scene: str = "",
    configuration: Mapping[str, Any] | None = None,
    max_age_s: float | None = MAX_AGE_S,
) -> Trial:
    """Run a policy in a world.

    Args:
        policy: The method; its `decide` may be plain or async.
        world: Where it acts. A world with a `horizon` is stopped after that many actions.
        plan: A plan that was read beforehand: exactly its actions run, or the gate refuses.
        plan_observation: The picture that plan was made from; without it the scene must be pixel for pixel the same.
        replans: How often the policy may answer with new actions after its first ones ran out or were refused.
        looks: How often the policy may run only the first actions of its plan and be asked again with a new picture, which is
            not a replan. 0: every plan runs whole (open loop). A plan that was read beforehand always runs whole.
        scorer: Judges the outcome after the trial, and only then; None leaves it unscored.
        subscribers: Told of every event, in order.
        approval: Consent to one plan, or a function that is asked for it before motion; given, it is required.
        seed: Of the scene; None for a photo or a real robot.
        scene: What the trial is called in the record.
        configuration: What else the record should say.
        max_age_s: Oldest picture that may be acted upon [s]; None for no limit.

    Returns:
        The whole trial. The method's errors are failures with their stage; a provider's absence is an error.

    Raises:
        ConfigError: Before anything moved: wrong use.
        KeyboardInterrupt: The world was stopped first, and subscribers were handed what had happened so far.
    """
    if replans < 0:
        raise ConfigError(f"replans must be 0 or more, got {replans}")
    if looks < 0:
        raise ConfigError(f"looks must be 0 or more, got {looks}")
    if looks and (plan is not None or isinstance(approval, Approval)):
        raise ConfigError(
            f"looks is {looks}, but the plan was read (or approved) beforehand: it runs as it is, so looks must be 0"
        )
    world = cast(World, GuardedWorld(world))
    progress = Progress(policy, scene, seed, tuple(subscribers))
    setup = {"method": policy.name, "seed": seed, "replans": replans, "looks": looks, **(configuration or {})}
    progress.tell("run", scene, {**setup, "task": world.instruction, "limits": world.limits})
    execution = Execution(world, progress, approval, max_age_s, plan)
    try:
        with Caller() as caller:
            ending = _attempts(policy, world, caller, execution, progress, plan, plan_observation, replans, looks)
    except (KeyboardInterrupt, Exception) as error:  # noqa: BLE001  sorted by fault; what is unknown is raised again
        return _stop(world, progress, error)
    return _scored(progress, ending, scorer)


def _attempts(
    policy: Policy,
    world: World,
    caller: Caller,
    execution: Execution,
    progress: Progress,
    plan: Plan | None,
    plan_observation: Observation | None,
    replans: int,
    looks: int,
) -> Ending:
    """Ask, gate, execute, until the policy or a bound ends it."""
    chunks = isinstance(policy, ChunkPolicy) and policy.chunks
    horizon = world.horizon if isinstance(world, Horizon) else None
    attempt, refused, first_run = 0, None, 0
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
            replans_left=replans - attempt,
            executed=told,
            refused=refused,
            plan=plan if attempt == 0 else None,
            looks_left=looks,
        )
        progress.asking(situation)
        decision = decision_of(policy, situation, caller)
        progress.decided(decision)
        if not isinstance(decision, Act):
            return _said(decision, progress)
        then = plan_observation if plan is not None and attempt == 0 else observation
        halted = execution.run(decision, then, horizon, expected=plan if attempt == 0 else None)
        if halted is not None and halted.final:
            return halted
        refused = execution.refusal
        looking = decision.look and looks > 0 and halted is None
        if looking:
            looks -= 1
        elif not chunks or refused is not None:
            if attempt >= replans:
                return halted or Ending(None, None, "the plan's actions ran out")
            attempt += 1
        observation = progress.observe(world, "look" if looking else f"attempt {attempt}")
    return Ending("failure", "budget", f"the policy was asked {MAX_DECISIONS} times")


def _said(decision: Done | GaveUp | Any, progress: Progress) -> Ending:
    match decision:
        case Done():
            return Ending(None, None, decision.reason or "the method believes that it is done")
        case GaveUp():
            if decision.plan is not None:
                progress.add_plan(decision.plan)
            return Ending("failure", decision.stage, decision.reason)
    raise ConfigError(f"decide must return Act, Done or GaveUp; it returned {type(decision).__name__}")


def _stop(world: World, progress: Progress, error: BaseException) -> Trial:
    """End a trial that an exception cut short; raises what is neither the method's, the provider's nor the robot's."""
    try:
        world.stop()
    except WonderfulTeamError as worse:
        progress.tell("warning", "halt", f"{worse}: the robot may still be moving; a person must look")
        progress.traced(worse)
    if isinstance(error, WonderfulTeamError):
        progress.traced(error)
    match error:
        case RobotFaultError() | SafetyStopError():
            progress.tell("warning", "halt", f"{error}. The run is halted; a person should look before it goes on.")
            return progress.finish(Ending("failure", error.stage or "execution", str(error)))
        case ModelUnavailableError() | WorldUnavailableError():
            return progress.finish(Ending("error", error.stage or "model", str(error)))
        case WonderfulTeamError() if not isinstance(error, ConfigError):
            return progress.finish(Ending("failure", error.stage or "plan", str(error)))
    interrupted = isinstance(error, KeyboardInterrupt)
    reason = "interrupted" if interrupted else f"{type(error).__name__}: {error}"
    progress.tell("warning", "interrupted" if interrupted else "crash", reason)
    progress.finish(Ending("error", "interrupted" if interrupted else "crash", reason))
    raise error


def _scored(progress: Progress, ending: Ending, scorer: Privileged | None) -> Trial:
    """Let truth decide, now that nothing can learn from it any more."""
    if scorer is None:
        return progress.finish(Ending(ending.outcome or "unscored", ending.stage, ending.reason))
    try:
        score = GuardedScorer(scorer).score()
    except WonderfulTeamError as error:
        progress.traced(error)
        return progress.finish(Ending("error", error.stage or "world", str(error)))
    match score.success:
        case True:
            return progress.finish(Ending("success", None, score.reason or ending.reason))
        case False:
            said = "; ".join(text for text in (ending.reason, score.reason) if text)
            return progress.finish(Ending("failure", ending.stage or score.stage or "execution", said))
    said = score.reason or "the scorer could not judge"
    return progress.finish(Ending(ending.outcome or "unscored", ending.stage, said))
