"""Worlds by name, tasks of the user's own, and a method at work in a world, recorded."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from wonderful_team import registry
from wonderful_team.api.method import Method
from wonderful_team.api.recording import tell, write_page_or_warn, write_rerun_or_note
from wonderful_team.api.results import PlanResult, TrialResult
from wonderful_team.api.team import _failing, _recording, _recording_unless_success
from wonderful_team.core.deadline import limited
from wonderful_team.core.protocols import Policy, Privileged, Subscriber, World, privileged
from wonderful_team.core.renamed import renamed_arguments
from wonderful_team.core.values import Instruction, KeepOut, Plan, ReadPlan
from wonderful_team.errors import ConfigError
from wonderful_team.record import read_run_plan
from wonderful_team.record.late import LateRecorder
from wonderful_team.record.recorder import Recorder
from wonderful_team.record.rerun_recording import RERUN_NAME, RerunRecording, check_rerun
from wonderful_team.record.run_folders import find_run
from wonderful_team.record.setup import setup_entry
from wonderful_team.runtime import Approval, Approver
from wonderful_team.runtime import rollout as roll_out
from wonderful_team.runtime.user_code import GuardedWorld, close_world


def make_world(
    name: str | Any,
    seed: int = 0,
    instruction: str | Instruction | None = None,
    keep_out: Sequence[KeepOut] = (),
    **arguments: Any,
) -> World:
    """A world with one scene set up in it, such as `make_world("tabletop/rotate", seed=3)`.

    Args:
        name: WORLD/TASK, FILE.py:NAME, or an object of your own that is to be used as a world.
        seed: Of the scene.
        instruction: Instead of the world's own; its scorer is then dropped.
        keep_out: Regions nothing may enter, beside the world's own.
        **arguments: For the constructor of a world of FILE.py:NAME, such as a robot's address:
            `make_world("arm.py:Arm", address="10.0.0.5")`; in a name they stand as "arm.py:Arm?address=10.0.0.5".

    Raises:
        ConfigError: An unknown name, or a world without an instruction.
        WorldUnavailableError: The world's own code raised.
    """
    return registry.make_world(name, seed, instruction, keep_out, **arguments)


@renamed_arguments(looks="reobserve")
def rollout(
    method: Method | Policy,
    world: World | str,
    *,
    plan: PlanResult | ReadPlan | Plan | str | Path | None = None,
    replans: int = 0,
    reobserve: int = 0,
    approval: Approval | Approver | None = None,
    seed: int | None = None,
    scene: str = "",
    scored: bool = True,
    out: str | Path | None = None,
    subscribers: Sequence[Subscriber] = (),
    rerun: str | Path | bool = False,
) -> TrialResult:
    """Run a method in a world, recorded.

    Args:
        method: A Team, a Method, or anything with the Policy interface.
        world: Where it acts: a world, or its name as `make_world` takes it, with `seed`; it is then closed at the end.
        plan: A plan that was read beforehand: what `team.plan` returned, or the folder of the run that made it. Exactly
            that plan runs, in its own instruction and scene, or nothing moves; after it ran, replans go on as asked.
            A bare `Plan` comes without its picture: then the scene must be the same pixel for pixel.
        replans: How often the method may plan again after its first attempt.
        reobserve: How often it may run only the first push of a plan, look, and plan the rest anew; that is no replan.
        approval: Consent to one plan (`plan.approve("Ada")`), or a function that takes a `Proposal` and returns
            `proposal.approve(…)` or `proposal.decline(…)`. A no ends the trial; a no with a reason is advice for one
            new plan, which is asked about again.
        seed: What the record says of the scene's seed.
        scene: What the record calls the scene.
        scored: Let the world's scorer, where it has one, judge the outcome afterwards.
        out: Where the run folder goes; default the team's, else $WONDERFUL_TEAM_RUNS or `runs`.
        subscribers: Told of every event as it happens.
        rerun: Where a recording for Rerun's viewer goes, FILE.rrd; True: into the run folder. It is the optional part `rerun`.

    Raises:
        ConfigError: Wrong use, before anything moved.
        MissingExtraError: `rerun` is asked for, and its optional part is not installed; nothing moved.
        KeyboardInterrupt: Ctrl-C. The world was stopped and the record is whole.
        SystemExit: SIGTERM or SIGHUP, likewise; its code is 128 + the signal's number.
    """
    if rerun is not False:
        check_rerun(None if isinstance(rerun, bool) else Path(rerun))
    longest_s = method.max_seconds if isinstance(method, Method) else None
    if isinstance(world, str):
        with contextlib.ExitStack() as closing:
            closing.enter_context(limited(longest_s))
            made_here = make_world(world, seed or 0)
            closing.callback(close_world, made_here, lambda text: warnings.warn(text, stacklevel=2))
            return rollout(
                method,
                made_here,
                plan=plan,
                replans=replans,
                reobserve=reobserve,
                approval=approval,
                seed=seed or 0,
                scene=scene or registry.scene_name(world, seed or 0),
                scored=scored,
                out=out,
                subscribers=subscribers,
                rerun=rerun,
            )
    if not isinstance(method, Method) and not callable(getattr(method, "decide", None)):
        raise ConfigError(
            f"a {type(method).__name__} is no method; valid: a wt.Team, a wt.Method, or an object with decide(situation)"
        )
    return rollout_in_world(
        method,
        world,
        read=_read(plan),
        replans=replans,
        reobserve=reobserve,
        approval=approval,
        seed=seed,
        scene=scene,
        scored=scored,
        out=out,
        subscribers=subscribers,
        rerun=rerun,
    )


def rollout_in_world(
    method: Method | Policy,
    world: World,
    *,
    read: ReadPlan | None = None,
    replans: int = 0,
    reobserve: int = 0,
    approval: Approval | Approver | None = None,
    seed: int | None = None,
    scene: str = "",
    scored: bool = True,
    out: str | Path | None = None,
    subscribers: Sequence[Subscriber] = (),
    rerun: str | Path | bool = False,
    unless_success: bool = False,
) -> TrialResult:
    """`rollout` once its world and plan are at hand.

    With `unless_success` only a trial that does not succeed gets a run folder. There is then no page before motion to approve, and no
    recording for Rerun.
    """
    longest_s = method.max_seconds if isinstance(method, Method) else None
    if isinstance(method, Method):
        method = method.in_world(world)
    named = method if isinstance(method, Method) else None
    # Read as the rollout reads it: what a user's world raises or holds is named as the world's.
    guarded = GuardedWorld(world)
    scorer: Privileged | None = privileged(world) if scored else None
    setup = setup_entry(
        "run",
        guarded.vocabulary,
        guarded.limits,
        keep_out=guarded.limits.keep_out,
        scene=scene,
        seed=seed,
        replans=replans,
        reobserve=reobserve,
        plan=None if read is None else read.plan.id,
        scored=scorer is not None,
        facts=guarded.facts,
    )
    recording = None if rerun is False else RerunRecording()
    subscribers = subscribers if recording is None else (*subscribers, recording)
    place, command = (out or named.out, named.command) if named else (out, None)
    words = guarded.instruction.plain_text
    making: contextlib.AbstractContextManager[Recorder | LateRecorder] = (
        _recording_unless_success(words, place, command) if unless_success else _recording(words, place, command)
    )
    with limited(longest_s), making as recorder:
        everyone = (recorder, *subscribers, *(named.subscribers if named else ()))
        for text in named.warnings if named else ():
            tell(everyone, "warning", "setup", text)
        with _failing(recorder, everyone), _kept(recording, recorder, rerun):
            trial = roll_out(
                method.policy(recorder, *subscribers) if isinstance(method, Method) else method,
                world,
                plan=read,
                replans=replans,
                reobserve=reobserve,
                scorer=scorer,
                subscribers=everyone,
                approval=approval,
                seed=seed,
                scene=scene,
                configuration={
                    **(named.configuration() if named else {}),
                    "task": guarded.instruction,
                    "limits": guarded.limits,
                    "setup": setup,
                    "words": named.words() if named else {},
                },
                page=lambda: write_page_or_warn(recorder) if isinstance(recorder, Recorder) else None,
                strict=named.strict if named else False,
            )
    happened = {item.name: getattr(trial, item.name) for item in fields(trial)}
    return TrialResult(**happened, folder=recorder.folder, warnings=recorder.warnings, unwritten=recorder.unwritten)


@contextlib.contextmanager
def _kept(
    recording: RerunRecording | None, recorder: Recorder | LateRecorder, rerun: str | Path | bool
) -> Iterator[None]:
    """A recording for Rerun is written however the run ends."""
    try:
        yield
    finally:
        if recording is not None and isinstance(recorder, Recorder):
            path = recorder.folder / RERUN_NAME if isinstance(rerun, bool) else Path(rerun)
            write_rerun_or_note(recording, recorder, path)


def task(name: str, *, instruction: str, horizon: int = 1, **more: Any) -> Callable[[Callable[..., Any]], Any]:
    """Make a tabletop task of a function `(scene, rng)` that sets the table; see docs/extending.md."""
    from wonderful_team.sims.tabletop import task as tabletop_task

    return tabletop_task(name, instruction=instruction, horizon=horizon, **more)


def _read(plan: PlanResult | ReadPlan | Plan | str | Path | None) -> ReadPlan | None:
    """A plan that is handed in, with its picture and its page where those are at hand.

    Raises:
        ConfigError: It is no plan, or its folder holds none.
    """
    match plan:
        case None | ReadPlan():
            return plan
        case PlanResult():
            photo = getattr(plan.observation, "photo", False)
            return ReadPlan(plan.plan, plan.observation, plan.page, same_clock=not photo)
        case Plan():
            return ReadPlan(plan)
        case str() | Path():
            return read_run_plan(find_run(str(plan)))
    raise ConfigError(
        f"plan: a {type(plan).__name__} is no plan; valid: what team.plan returned, or the folder of the run that made it"
    )
