"""The Python face: synchronous, safe in notebooks, recorded. `import wonderful_team as wt` offers what stands here."""

from __future__ import annotations

import contextlib
import inspect
import time
import warnings
from collections.abc import Callable, Coroutine, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from wonderful_team import registry
from wonderful_team.core import values
from wonderful_team.core.actions import PICK_PLACE, VOCABULARIES, Vocabulary
from wonderful_team.core.geometry import PlanarCamera
from wonderful_team.core.protocols import Decision, Event, Policy, Privileged, Situation, Subscriber, World, privileged
from wonderful_team.core.values import (
    NO_WORKSPACE,
    GateReport,
    Instruction,
    KeepOut,
    Limits,
    Plan,
    ReadPlan,
    Target,
    Usage,
)
from wonderful_team.errors import ConfigError, UnknownNameError, WonderfulTeamError
from wonderful_team.finding import find
from wonderful_team.interrupts import ends_on_signal, held
from wonderful_team.made import MadePlan, RecordedTrial
from wonderful_team.methods import Method
from wonderful_team.observe import Seen, seen
from wonderful_team.pages import write_page
from wonderful_team.planning import Team as Planner
from wonderful_team.planning import Until
from wonderful_team.record import read_run_plan
from wonderful_team.record.recorder import Recorder
from wonderful_team.record.run_folders import find_run, new_run_folder
from wonderful_team.record.setup import setup_entry
from wonderful_team.record.stored_run import StoredRun, load_stored_run
from wonderful_team.runtime import Approval, Approver, check_gate
from wonderful_team.runtime import rollout as roll_out
from wonderful_team.runtime.loop import Caller
from wonderful_team.runtime.user_code import GuardedWorld, close_world


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
        observation: values.Observation,
        instruction: Instruction,
        vocabulary: Vocabulary,
        limits: Limits,
        setup: Mapping[str, Any],
        make: Callable[[Recorder], _Work],
    ) -> MadePlan:
        """Make a plan in a run folder of its own, pass it through the gate, and write its page."""
        started = time.monotonic()
        with _recording(instruction.plain_text, self.out, self.command) as recorder:
            everyone = (recorder, *self.subscribers)
            told = {**self.configuration(), "task": instruction, "limits": limits, "setup": setup}
            tell(everyone, "run", str(setup["entry"]), {**told, "words": self.words()})
            tell(everyone, "observe", "start", observation)
            for name, text in _cautions(self.warnings, observation, limits):
                tell(everyone, "warning", name, text)
            with _failing(recorder, everyone), Caller() as caller:
                work = make(recorder)
                plan: Plan = caller.wait_for(work.plan)
                gate = plan_gate(plan, observation, vocabulary, limits)
                if gate is not None:
                    tell(everyone, "gate", "before motion", gate)
                status = plan.status if gate is None or gate.admitted else "refused"
                tell(everyone, "done", status, plan)
        spent, seconds = dict(work.usage_by_role()), time.monotonic() - started
        return MadePlan(plan, observation, gate, spent, seconds, recorder.folder, recorder.warnings)


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
    plan: MadePlan | ReadPlan | Plan | str | Path | None = None,
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
        plan: A plan that was read beforehand: what `team.plan` returned, or the folder of the run that made it. Exactly
            that plan runs, in its own instruction and scene, or nothing moves; after it ran, replans go on as asked.
            A bare `Plan` comes without its picture: then the scene must be the same pixel for pixel.
        replans: How often the method may plan again after its first attempt.
        looks: How often it may run only the first push of a plan, look, and plan the rest anew; that is no replan.
        approval: Consent to one plan (`plan.approve("Ada")`), or a function that takes a `Proposal` and returns
            `proposal.approve(…)` or `proposal.decline(…)`. A no ends the trial; a no with a reason is advice for one
            new plan, which is asked about again.
        seed: What the record says of the scene's seed.
        scene: What the record calls the scene.
        scored: Let the world's scorer, where it has one, judge the outcome afterwards.
        out: Where the run folder goes; default the team's, else $WONDERFUL_TEAM_RUNS or `runs`.
        subscribers: Told of every event as it happens.

    Raises:
        ConfigError: Wrong use, before anything moved.
        KeyboardInterrupt: Ctrl-C. The world was stopped and the record is whole.
        SystemExit: SIGTERM or SIGHUP, likewise; its code is 128 + the signal's number.
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
    read = _read(plan)
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
        looks=looks,
        plan=None if read is None else read.plan.id,
        scored=scorer is not None,
    )
    place, command = (out or named.out, named.command) if named else (out, None)
    with _recording(guarded.instruction.plain_text, place, command) as recorder:
        everyone = (recorder, *subscribers, *(named.subscribers if named else ()))
        for text in named.warnings if named else ():
            tell(everyone, "warning", "setup", text)
        with _failing(recorder, everyone):
            trial = roll_out(
                method.policy(recorder, *subscribers) if isinstance(method, Method) else method,
                world,
                plan=read,
                replans=replans,
                looks=looks,
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
                page=lambda: _page_of(recorder.folder),
                strict=named.strict if named else False,
            )
    happened = {item.name: getattr(trial, item.name) for item in fields(trial)}
    return RecordedTrial(**happened, folder=recorder.folder, warnings=recorder.warnings)


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


def plan_gate(plan: Plan, observation: values.Observation, vocabulary: Vocabulary, limits: Limits) -> GateReport | None:
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


def _cautions(told: Sequence[str], observation: values.Observation, limits: Limits) -> Iterator[tuple[str, str]]:
    """What the user is warned of before a plan is made, by name."""
    yield from (("setup", text) for text in told)
    if limits is NO_WORKSPACE and observation.main.camera is not None:
        yield "workspace", "no workspace is stated: the gate checks everything but that"
    if observation.main.depth_m is None and _calibrated(observation):
        yield "heights", "no depth is given: every height is taken to be the table's (--depth FILE)"


def _calibrated(observation: values.Observation) -> bool:
    """Whether the main view's camera could turn depth into metres."""
    return observation.main.camera is not None and not isinstance(observation.main.camera, PlanarCamera)


def _read(plan: MadePlan | ReadPlan | Plan | str | Path | None) -> ReadPlan | None:
    """A plan that is handed in, with its picture and its page where those are at hand.

    Raises:
        ConfigError: It is no plan, or its folder holds none.
    """
    match plan:
        case None | ReadPlan():
            return plan
        case MadePlan():
            photo = getattr(plan.observation, "photo", False)
            return ReadPlan(plan.plan, plan.observation, plan.page, same_clock=not photo)
        case Plan():
            return ReadPlan(plan)
        case str() | Path():
            return read_run_plan(find_run(str(plan)))
    raise ConfigError(
        f"plan: a {type(plan).__name__} is no plan; valid: what team.plan returned, or the folder of the run that made it"
    )


@contextlib.contextmanager
def _recording(text: str, out: str | Path | None, command: str | None) -> Iterator[Recorder]:
    """A run folder of its own, whose record and page are whole whatever ends the run: its end, an error, a signal."""
    with ends_on_signal(), contextlib.ExitStack() as closing:
        with held():
            recorder = Recorder(new_run_folder(text, out), command=command)
            closing.callback(_close, recorder)
        yield recorder


def _close(recorder: Recorder) -> None:
    """The record and the page, whole: a signal that comes meanwhile is raised afterwards."""
    with held():
        recorder.close()
        _page_of(recorder.folder)


def _page_of(folder: Path) -> Path | None:
    """Write the page. A run may have cost money and moved a robot: a defect of the page must not lose its result."""
    try:
        return write_page(folder)
    except Exception as error:  # noqa: BLE001  told as a warning; `wonderful-team show` writes the page anew
        warnings.warn(f"the page of {folder} could not be written: {type(error).__name__}: {error}", stacklevel=3)
    return None


@contextlib.contextmanager
def _failing(recorder: Recorder, everyone: Sequence[Subscriber]) -> Iterator[None]:
    """An error that ends a run is told, and knows the run's folder."""
    try:
        yield
    except WonderfulTeamError as error:
        if not recorder.ended:
            tell_failure(everyone, error)
        error.folder = recorder.folder
        raise


def tell(subscribers: Sequence[Subscriber], kind: str, name: str, content: Any) -> None:
    """Pass an event on."""
    for subscriber in subscribers:
        subscriber.on_event(Event(kind, name, content))


def tell_failure(subscribers: Sequence[Subscriber], error: WonderfulTeamError) -> None:
    """End a run that an error ended, with the traceback of the user's own code where there is one."""
    if error.trace:
        tell(subscribers, "crash", type(error).__name__, error)
    tell(subscribers, "done", "error", error)
