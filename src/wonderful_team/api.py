"""The Python face: synchronous, safe in notebooks, recorded. `import wonderful_team as wt` offers what stands here."""

from __future__ import annotations

import inspect
import time
import warnings
from collections.abc import Callable, Coroutine, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from wonderful_team import registry, types
from wonderful_team.actions import PICK_PLACE, VOCABULARIES, Vocabulary
from wonderful_team.errors import ConfigError, UnknownNameError, WonderfulTeamError
from wonderful_team.finding import find
from wonderful_team.geometry import PlanarCamera
from wonderful_team.interfaces import Decision, Event, Policy, Privileged, Situation, Subscriber, World
from wonderful_team.made import MadePlan, RecordedTrial
from wonderful_team.methods import Method
from wonderful_team.observe import Seen, seen
from wonderful_team.planning import Team as Planner
from wonderful_team.planning import Until
from wonderful_team.runs import find_run, new_run_folder
from wonderful_team.runtime import Approval, Approver, check_gate
from wonderful_team.runtime import rollout as roll_out
from wonderful_team.runtime.loop import Caller
from wonderful_team.runtime.page import write_page
from wonderful_team.runtime.recorder import Recorder
from wonderful_team.runtime.setup import setup_entry
from wonderful_team.runtime.stored_run import StoredRun, load_stored_run
from wonderful_team.runtime.user_code import GuardedWorld, close_world
from wonderful_team.types import NO_WORKSPACE, GateReport, Instruction, KeepOut, Limits, Plan, Target, Usage


@dataclass(frozen=True, eq=False)
class _Work:
    """A plan under way and what it costs."""

    plan: Coroutine[Any, Any, Plan]
    usage_by_role: Callable[[], Mapping[str, Usage]]


@dataclass
class Team(Method):
    """The team of agents. Every call of `plan` or `ground` is one run with a folder and a page of its own.

    Takes what `Method` takes; its method is one of the team's.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        if self._config is None:
            raise ConfigError(
                f"method {self.method!r} is not the team: run it with wt.rollout(wt.Method(method=…), world)"
            )
        self._deciding: Policy | None = None

    async def decide(self, situation: Situation) -> Decision:
        """`Policy`: what to do now."""
        if self._deciding is None or situation.attempt == 0:
            self._deciding = self.policy()
        decision = self._deciding.decide(situation)
        return await decision if inspect.isawaitable(decision) else decision

    def plan(
        self,
        observation: Seen,
        instruction: str | Instruction,
        *,
        vocabulary: str | Vocabulary = PICK_PLACE,
        limits: Limits | None = None,
        until: Until = "actions",
        keep_out: Sequence[KeepOut] = (),
    ) -> MadePlan:
        """Plan for what is seen; nothing moves.

        Args:
            observation: A photo (its path, its pixels, `Observation.from_files`) or `world.observe()`.
            instruction: What is wanted.
            vocabulary: Kinds of action that may be used: pick_place, push, arm, or a Vocabulary.
            limits: The workspace; default that of the photo's camera file or corners, if any.
            until: Stop early: draft, checked, grounded.
            keep_out: Regions nothing may enter.

        Returns:
            The plan; its `status` says how it ended, and failures of the method keep the best so far.

        Raises:
            ConfigError: Wrong use.
            ModelUnavailableError: The provider did not answer.
        """
        self.check_ready()
        observation = seen(observation)
        wanted = instruction_of(instruction)
        words = vocabulary_named(vocabulary)
        bounds = limits or getattr(observation, "limits", None) or NO_WORKSPACE

        def make(recorder: Recorder) -> _Work:
            planner = self.policy(recorder)
            assert isinstance(planner, Planner)
            work = planner.make_plan(observation, wanted, words, bounds, until=until, keep_out=keep_out)
            return _Work(work, lambda: planner.usage_by_role)

        setup = setup_entry("plan", words, bounds, until=until, keep_out=keep_out)
        return self._recorded(observation, wanted, words, bounds, setup, make)

    def ground(self, observation: Seen, objects: str | Sequence[str] = (), areas: str | Sequence[str] = ()) -> MadePlan:
        """Find things in a picture: boxes and points, no plan.

        Args:
            observation: Where to look, as for `plan`: its main view.
            objects: One or several descriptions of things that have an outline.
            areas: One or several descriptions of free areas.

        Raises:
            ConfigError: Nothing is asked for.
        """
        self.check_ready()
        observation = seen(observation)
        objects, areas = ([words] if isinstance(words, str) else list(words) for words in (objects, areas))
        targets = [Target(f"T{number}", "object", words) for number, words in enumerate(objects, start=1)]
        targets += [Target(f"T{number}", "area", words) for number, words in enumerate(areas, start=len(targets) + 1)]
        if not targets:
            raise ConfigError("ground: at least one description is needed")
        wanted = Instruction("Find: " + "; ".join(target.words for target in targets))

        def make(recorder: Recorder) -> _Work:
            assert self._config is not None
            door = self.door(recorder)
            return _Work(find(door, self._config, observation, wanted, targets), lambda: door.budget.by_role)

        setup = setup_entry("ground", PICK_PLACE, NO_WORKSPACE, targets=targets)
        return self._recorded(observation, wanted, PICK_PLACE, NO_WORKSPACE, setup, make)

    def _recorded(
        self,
        observation: types.Observation,
        instruction: Instruction,
        vocabulary: Vocabulary,
        limits: Limits,
        setup: Mapping[str, Any],
        make: Callable[[Recorder], _Work],
    ) -> MadePlan:
        """Make a plan in a run folder of its own, pass it through the gate, and write its page."""
        folder = new_run_folder(instruction.plain_text, self.out)
        recorder = Recorder(folder, command=self.command)
        everyone = (recorder, *self.subscribers)
        started = time.monotonic()
        told = {**self.configuration(), "task": instruction, "limits": limits, "setup": setup, "words": self.words()}
        tell(everyone, "run", str(setup["entry"]), told)
        for text in self.warnings:
            tell(everyone, "warning", "setup", text)
        tell(everyone, "observe", "start", observation)
        if limits is NO_WORKSPACE and observation.main.camera is not None:
            tell(everyone, "warning", "workspace", "no workspace is stated: the gate checks everything but that")
        if observation.main.depth_m is None and _calibrated(observation):
            tell(
                everyone,
                "warning",
                "heights",
                "no depth is given: every height is taken to be the table's (--depth FILE)",
            )
        work = make(recorder)
        try:
            with Caller() as caller:
                plan: Plan = caller.wait_for(work.plan)
            gate = plan_gate(plan, observation, vocabulary, limits)
            if gate is not None:
                tell(everyone, "gate", "before motion", gate)
            tell(everyone, "done", plan.status, plan)
        except WonderfulTeamError as error:
            tell_failure(everyone, error)
            error.folder = folder
            raise
        finally:
            recorder.close()
            _page_of(folder)
        spent, seconds = dict(work.usage_by_role()), time.monotonic() - started
        return MadePlan(plan, observation, gate, spent, seconds, folder, recorder.warnings)


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


def rollout(
    method: Method | Policy,
    world: World | str,
    *,
    plan: MadePlan | Plan | None = None,
    replans: int = 0,
    looks: int = 0,
    approval: Approval | Approver | None = None,
    seed: int | None = None,
    scene: str = "",
    scored: bool = True,
    out: str | Path | None = None,
    subscribers: Sequence[Subscriber] = (),
) -> RecordedTrial:
    """Run a method in a world, recorded.

    Args:
        method: A Team, a Method, or anything with the Policy interface.
        world: Where it acts: a world, or its name as `make_world` takes it, with `seed`; it is then closed at the end.
        plan: A plan that was read beforehand: exactly that plan runs, or the gate refuses.
        replans: How often the method may plan again after its first attempt.
        looks: How often it may run only the first push of a plan, look, and plan the rest anew; that is no replan.
        approval: Consent to one plan, or a function that is asked for it before motion.
        seed: What the record says of the scene's seed.
        scene: What the record calls the scene.
        scored: Let the world's scorer, where it has one, judge the outcome afterwards.
        out: Where the run folder goes; default the team's, else $WONDERFUL_TEAM_RUNS or `runs`.
        subscribers: Told of every event as it happens.

    Raises:
        ConfigError: Wrong use, before anything moved.
    """
    if isinstance(world, str):
        made_here = make_world(world, seed or 0)
        try:
            return rollout(
                method,
                made_here,
                plan=plan,
                replans=replans,
                looks=looks,
                approval=approval,
                seed=seed or 0,
                scene=scene or registry.scene_name(world, seed or 0),
                scored=scored,
                out=out,
                subscribers=subscribers,
            )
        finally:
            close_world(made_here, lambda text: warnings.warn(text, stacklevel=2))
    if not isinstance(method, Method) and not callable(getattr(method, "decide", None)):
        raise ConfigError(
            f"a {type(method).__name__} is no method; valid: a wt.Team, a wt.Method, or an object with decide(situation)"
        )
    if isinstance(method, Method):
        method = method.in_world(world)
    named = method if isinstance(method, Method) else None
    # Read as the rollout reads it: what a user's world raises or holds is named as the world's.
    place = GuardedWorld(world)
    folder = new_run_folder(place.instruction.plain_text, out if out is not None else (named.out if named else None))
    recorder = Recorder(folder, command=named.command if named else None)
    if named is not None:
        for text in named.warnings:
            tell((recorder, *subscribers, *named.subscribers), "warning", "setup", text)
    made = plan if isinstance(plan, MadePlan) else None
    scorer: Privileged | None = registry.privileged(world) if scored else None
    given = made.plan if made is not None else plan
    setup = setup_entry(
        "run",
        place.vocabulary,
        place.limits,
        keep_out=place.limits.keep_out,
        scene=scene,
        seed=seed,
        replans=replans,
        looks=looks,
        plan=None if given is None else given.id,
        scored=scorer is not None,
    )
    everyone = (recorder, *subscribers, *(named.subscribers if named else ()))
    try:
        policy: Policy = method.policy(recorder, *subscribers) if isinstance(method, Method) else method
        trial = roll_out(
            policy,
            world,
            plan=given,  # type: ignore[arg-type]
            plan_observation=made.observation if made is not None else None,
            replans=replans,
            looks=looks,
            scorer=scorer,
            subscribers=everyone,
            approval=approval,
            seed=seed,
            scene=scene,
            configuration={
                **(named.configuration() if named else {}),
                "task": world.instruction,
                "limits": world.limits,
                "setup": setup,
                "words": named.words() if named else {},
            },
        )
    except WonderfulTeamError as error:
        if not recorder.ended:
            tell_failure(everyone, error)
        error.folder = folder
        raise
    finally:
        recorder.close()
        _page_of(folder)
    held = {item.name: getattr(trial, item.name) for item in fields(trial)}
    return RecordedTrial(**held, folder=folder, warnings=recorder.warnings)


def task(name: str, *, instruction: str, horizon: int = 1, **more: Any) -> Callable[[Callable[..., Any]], Any]:
    """Make a tabletop task of a function `(scene, rng)` that sets the table; see docs/own-task.md."""
    from wonderful_team.sims.tabletop import task as tabletop_task

    return tabletop_task(name, instruction=instruction, horizon=horizon, **more)


def instruction_of(words: str | Instruction) -> Instruction:
    """An instruction of words.

    Raises:
        ConfigError: Neither words nor an instruction.
    """
    if isinstance(words, Instruction):
        return words
    if not isinstance(words, str):
        raise ConfigError(f"a {type(words).__name__} is no instruction; valid: text, or a wt.Instruction")
    return Instruction(words)


def load_run(run: str | Path, out: str | Path | None = None) -> StoredRun:
    """A recorded run.

    Args:
        run: Its folder, the folder's name or a part of it, or "latest".
        out: Where run folders lie; default $WONDERFUL_TEAM_RUNS or `runs`.

    Raises:
        UnknownNameError: No such run.
        ConfigError: Its record cannot be read.
    """
    return load_stored_run(find_run(str(run), out))


def vocabulary_named(vocabulary: str | Vocabulary) -> Vocabulary:
    """A vocabulary by its name."""
    if isinstance(vocabulary, Vocabulary):
        return vocabulary
    if vocabulary not in VOCABULARIES:
        raise UnknownNameError("vocabulary", vocabulary, VOCABULARIES)
    return VOCABULARIES[vocabulary]


def plan_gate(plan: Plan, observation: types.Observation, vocabulary: Vocabulary, limits: Limits) -> GateReport | None:
    """What the gate says of a plan that is not run now; None without actions."""
    if plan.status != "planned" or not plan.actions:
        return None
    # A photo with a camera file says where the robot is, so its heights have to be known; a world's robot may find them.
    photo = getattr(observation, "limits", None) is not None and _calibrated(observation)
    return check_gate(
        plan.actions,
        vocabulary=vocabulary,
        limits=limits,
        plan=plan,
        then=observation,
        now=observation,
        measured_heights=photo,
    )


def _calibrated(observation: types.Observation) -> bool:
    """Whether the main view's camera could turn depth into metres."""
    return observation.main.camera is not None and not isinstance(observation.main.camera, PlanarCamera)


def _page_of(folder: Path) -> None:
    """Write the page. A run may have cost money and moved a robot: a defect of the page must not lose its result."""
    try:
        write_page(folder)
    except Exception as error:  # noqa: BLE001  told as a warning; `wonderful-team show` writes the page anew
        warnings.warn(f"the page of {folder} could not be written: {type(error).__name__}: {error}", stacklevel=3)


def tell(subscribers: Sequence[Subscriber], kind: str, name: str, content: Any) -> None:
    """Pass an event on."""
    for subscriber in subscribers:
        subscriber.on_event(Event(kind, name, content))


def tell_failure(subscribers: Sequence[Subscriber], error: WonderfulTeamError) -> None:
    """End a run that an error ended, with the traceback of the user's own code where there is one."""
    if error.trace:
        tell(subscribers, "crash", type(error).__name__, error)
    tell(subscribers, "done", "error", error)
