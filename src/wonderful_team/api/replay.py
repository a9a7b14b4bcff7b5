"""Run a recorded run again: exactly (replay), or with another model from some stage on (branch).

Nothing real moves. A replay puts the method into the recorded situations, with the pictures and reports of that time.
Programs that a model wrote run again in the sandbox; what a detector found comes from the record. A branch may lead elsewhere, so a trial branches only in a simulator of ours, which is set up from its seed; of any
other trial the first plan is made again.
"""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wonderful_team import registry
from wonderful_team.agents import Prompts
from wonderful_team.api.method import Method
from wonderful_team.api.results import PlanResult, TrialResult
from wonderful_team.api.rollout import rollout
from wonderful_team.api.team import Team
from wonderful_team.core.actions import Vocabulary
from wonderful_team.core.filesystem import write_public
from wonderful_team.core.protocols import ChecksSubgoals, Event, Model, Policy, Subscriber, World, offers
from wonderful_team.core.values import AskUser, Observation, Plan
from wonderful_team.errors import ConfigError, ReplayError, WonderfulTeamError, reading
from wonderful_team.models.replay import Branching, ReplayModel, check_asked_at
from wonderful_team.record.detections import RecordedDetector
from wonderful_team.record.plan_file import has_short_id
from wonderful_team.record.record_schema import read_record
from wonderful_team.record.setup import Setup, read_setup, same_limits
from wonderful_team.record.stored import stored_instruction, stored_observation
from wonderful_team.record.story import Asked, recorded_plan, situations
from wonderful_team.registry.files import check_names_no_code, names_no_code
from wonderful_team.runtime.loop import Caller


@dataclass(frozen=True, eq=False)
class Replayed:
    """How a replay came out.

    Attributes:
        then, now: Ids of the plans, in order: in the record, and made again.
        answers: How many answers came from the record.
        differences: Where words or pictures differed (tolerant replays only).
    """

    then: tuple[str, ...]
    now: tuple[str, ...]
    answers: int
    differences: tuple[str, ...]

    @property
    def same(self) -> bool:
        """Whether the same plans came out."""
        return self.then == self.now


def replay(folder: Path, *, tolerant: bool = False, subscribers: Sequence[Subscriber] = ()) -> Replayed:
    """Make a recorded run's plans again from its own answers; no model and no network. Leaves no run folder behind.

    A method marked PRIVILEGED was told a simulator's truth: its world is made again from task and seed, and nothing moves in it.

    Args:
        folder: The run's folder.
        tolerant: Go on where words or pictures differ from the record (a later release has other words), and say so.
        subscribers: Told of every event as it happens.

    Raises:
        ReplayError: What is asked is not what was asked then; names the request and what differs.
        ConfigError: The record cannot be run again.
    """
    record = read_record(folder)
    setup = read_setup(record, str(folder))
    model, plans = ReplayModel(record, tolerant=tolerant), _Plans()
    detector = RecordedDetector(record) if "detector" in record["configuration"] else None
    with (
        tempfile.TemporaryDirectory(prefix="wonderful-team-replay-") as place,
        _truth_again(folder, record, setup) as world,
    ):
        everyone = (plans, *subscribers)
        method = _method(folder, record, model, out=place, subscribers=everyone, detector=detector, world=world)
        try:
            if setup.entry == "run":
                policy = method.policy()
                with reading(f"{folder}: the record"):
                    asked = list(situations(folder, record, setup))
                with Caller() as caller:
                    for one in asked:
                        plans.seen(one.situation.observation)
                        caller.wait_for(_answered(policy, one))
            else:
                _plan_again(folder, record, setup, method)
        except WonderfulTeamError as error:
            # What ended the run then ends it again; anything else did not happen then.
            if error not in (*model.failed, *(detector.broke if detector else ())):
                raise
    plans_then = record["planner"]["plans"]
    then = dict.fromkeys(str(entry["id"]) for entry in plans_then)
    short = all(has_short_id(entry) for entry in plans_then)
    # A plan that was handed in is never told as one that was made.
    now = [] if setup.plan is None else [setup.plan]
    now += [plans.short_id(plan) if short else plan.id for plan in plans.made]
    return Replayed(tuple(then), tuple(dict.fromkeys(now)), model.replayed, tuple(model.differences))


def _answered(policy: Policy, asked: Asked) -> Any:
    """What a method says where it was asked then: what to do, or whether to go on.

    Raises:
        ConfigError: It was asked whether to go on, and cannot be.
    """
    if not asked.check:
        return policy.decide(asked.situation)
    if not offers(policy, ChecksSubgoals):
        raise ConfigError(
            f"the record asks method {policy.name!r} after a subgoal whether to go on, and it has no check()"
        )
    return policy.check(asked.situation)


class _Plans:
    """Hears which plans were made, and for which pictures."""

    def __init__(self) -> None:
        self.made: list[Plan] = []
        self._short_hashes: dict[str, str] = {}

    def on_event(self, event: Event) -> None:
        if event.kind == "plan":
            self.made.append(event.content)
        elif event.kind == "observe":
            self.seen(event.content)

    def seen(self, observation: Observation) -> None:
        """A picture that a plan may be made for."""
        self._short_hashes[observation.hash] = observation.short_hash

    def short_id(self, plan: Plan) -> str:
        """The plan's id as earlier releases had it."""
        return plan.short_id(self._short_hashes.get(plan.scene_hash))


def branch(
    folder: Path,
    stage: str,
    model: str | Model | Mapping[str, str | Model],
    *,
    out: str | Path | None = None,
    subscribers: Sequence[Subscriber] = (),
    command: str | None = None,
    **caps: Any,
) -> PlanResult | TrialResult:
    """Run again with another model from a stage on; the answers before it come from the record.

    Args:
        folder: The parent run's folder.
        stage: plan, ground, act or replan.
        model: Who answers from there on: as for Team.
        out: Where the new run folder goes; its record names the parent.
        subscribers: Told of every event as it happens.
        command: The command line, for the page.
        **caps: Of the new run: max_calls, max_tokens, max_seconds, max_usd, and other arguments of Team.

    Raises:
        UnknownNameError: No such stage or model.
        ConfigError: As for replay.
    """
    folder = folder.resolve()
    record = read_record(folder)
    recorded = ReplayModel(record)
    wanted: Mapping[str, str | Model] = model if isinstance(model, Mapping) else {registry.DEFAULT_ROLE: model}
    setup = read_setup(record, str(folder))
    rival = registry.team_mode(_method_name(folder, record)) is None
    if rival:
        check_asked_at(stage, record)
    arguments = {**caps, "out": out, "subscribers": tuple(subscribers), "command": command}
    if "detector" in record["configuration"]:
        # Another model may look for other things: the detector itself is asked.
        named = str(record["configuration"]["detector"])
        arguments["detector"] = caps.get("detector") or _detector_again(folder, named)
    with contextlib.ExitStack() as closing:
        world = closing.enter_context(_world_again(folder, record, setup)) if _is_ours(setup) else None
        made = {role: registry.make_model(one, world=world) for role, one in wanted.items()}
        models = {role: Branching(recorded, one, stage, as_asked=rival) for role, one in made.items()}
        parent = {"run": folder.name, "from": stage}
        method = _method(folder, record, models, parent=parent, world=world, **arguments)
        if world is None:
            return _plan_again(folder, record, setup, method)
        return _trial_again(folder, record, setup, method, world)


def _detector_again(folder: Path, named: str) -> str:
    """The detector of a record, if it can be made here.

    Raises:
        ConfigError: It cannot, or it is code.
    """
    try:
        registry.make_detector(check_names_no_code(named, f"{folder}: the record"))
    except ConfigError as error:
        raise ConfigError(
            f"{folder}: this run looked with detector {named!r}, which a branch needs and does not have here: {error}; hand one in, "
            "as in branch(folder, stage, model, detector=…)"
        ) from error
    return named


def _is_ours(setup: Setup) -> bool:
    """Whether the run was a trial in a simulator of ours, which its task and seed set up again."""
    return setup.entry == "run" and setup.scene.partition("/")[0] in registry.WORLDS


@contextlib.contextmanager
def _truth_again(folder: Path, record: Mapping[str, Any], setup: Setup) -> Iterator[World | None]:
    """The world whose truth a method marked PRIVILEGED was told, looked at once; None for every other method.

    Raises:
        ConfigError: It cannot be made again.
        ReplayError: It does not look as it did then.
    """
    named = _method_name(folder, record)
    row = registry.method_row(named)
    if row is None or not row.privileged:
        yield None
        return
    why = f"{folder}: method {named!r} was told a simulator's truth, which the record does not hold"
    if not _is_ours(setup):
        raise ConfigError(
            f"{why}, and its world cannot be made again: it is called {setup.scene!r}; valid: a task of {', '.join(registry.WORLDS)} "
            "that was run by its name, or with scene= and seed= of wt.rollout"
        )
    with reading(f"{folder}: the record"):
        then = stored_observation(folder, record, 0)
    with _world_again(folder, record, setup) as world:
        if world.observe().hash != then.hash:
            raise ReplayError(f"{why}; {setup.scene}, made again, does not look as it did then")
        yield world


def _method_name(folder: Path, record: Mapping[str, Any]) -> str:
    """The method of a record, which can be run again.

    Raises:
        ConfigError: The record does not say what it was, or it is code.
    """
    missing = [name for name in ("method", "concurrency", "strict") if name not in record["configuration"]]
    if missing:
        raise ConfigError(f"{folder}: the record does not say its {', '.join(missing)}, so it cannot be run again")
    return check_names_no_code(str(record["configuration"]["method"]), f"{folder}: the method of this record")


def _method(folder: Path, record: Mapping[str, Any], model: Model | Mapping[str, Model], **more: Any) -> Method:
    """The method as it was set up then, a team with its words of then, over another model."""
    configuration, named = record["configuration"], _method_name(folder, record)
    kind = Method if registry.team_mode(named) is None else Team
    with tempfile.TemporaryDirectory(prefix="wonderful-team-words-") as words:
        _write_words(Path(words), record.get("words") or {})
        return kind(
            model=model,
            method=named,
            concurrency=int(configuration["concurrency"]),
            prompts=words,
            strict=bool(configuration["strict"]),
            # Earlier releases asked every question.
            thorough=bool(configuration.get("thorough", True)),
            ask=_said_then(record),
            **{"cache": "off", **more},
        )


def _said_then(record: Mapping[str, Any]) -> AskUser | None:
    """Answers what the user answered then, question by question; None where nothing was asked."""
    answers = {entry["question"]: str(entry["answer"]) for entry in record["planner"].get("clarified", ())}
    return (lambda question, choices: answers.get(question)) if answers else None


def _plan_again(folder: Path, record: Mapping[str, Any], setup: Setup, team: Method) -> PlanResult:
    if not isinstance(team, Team):
        raise ConfigError(
            f"{folder}: method {team.method!r} plans in a world only, and the world of this run cannot be made again: it is called "
            f"{setup.scene!r}; valid: a task of {', '.join(registry.WORLDS)}"
        )
    if setup.plan is not None:
        raise ConfigError(f"{folder}: this run was given its plan {setup.plan}: there is nothing to plan again")
    with reading(f"{folder}: the record"):
        observation = stored_observation(folder, record)
        instruction = stored_instruction(folder, record)
    if setup.entry == "ground":
        objects = [target.words for target in setup.targets if target.kind == "object"]
        areas = [target.words for target in setup.targets if target.kind == "area"]
        return team.ground(observation, objects, areas)
    return team.plan(
        observation,
        instruction,
        vocabulary=Vocabulary(setup.vocabulary),
        limits=same_limits(setup),
        until=setup.until,  # type: ignore[arg-type]  # Team checks it
        keep_out=setup.keep_out,
        facts=setup.facts,
    )


@contextlib.contextmanager
def _world_again(folder: Path, record: Mapping[str, Any], setup: Setup) -> Iterator[World]:
    """The simulator of a recorded trial, set up again as it was at its start."""
    name = setup.scene.rpartition("#")[0]
    with reading(f"{folder}: the record"):
        wanted = stored_instruction(folder, record)
    with names_no_code(f"{folder}: the scene of this record"):
        world = registry.make_world(name, setup.seed or 0)
        if world.instruction.text != wanted.text:
            world.close()
            world = registry.make_world(name, setup.seed or 0, wanted)
    # Regions that the user kept out belong to the run, not to the simulator.
    getattr(world, "inner", world).limits = same_limits(setup)
    try:
        yield world
    finally:
        world.close()


def _trial_again(folder: Path, record: Mapping[str, Any], setup: Setup, method: Method, world: World) -> TrialResult:
    return rollout(
        method,
        world,
        plan=None if setup.plan is None else recorded_plan(folder, record, setup.plan),
        replans=setup.replans,
        reobserve=setup.reobserve,
        seed=setup.seed,
        scene=setup.scene,
        scored=setup.scored,
    )


def _write_words(place: Path, words: Mapping[str, str]) -> None:
    """The words of that time, so that a later release asks as the record's did; files it no longer has are left out."""
    known = Prompts.default().files()
    for name, text in words.items():
        if name in known:
            write_public(place / name, text)
