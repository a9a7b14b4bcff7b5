"""The Python face: synchronous, safe in notebooks, recorded. `import wonderful_team as wt` offers what stands here."""

from __future__ import annotations

import contextlib
import inspect
import time
from collections.abc import Callable, Coroutine, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wonderful_team.api.method import Method
from wonderful_team.api.observation import Seen, seen
from wonderful_team.api.photos import unknown_robot
from wonderful_team.api.recording import tell, write_page_or_warn
from wonderful_team.api.results import PlanResult
from wonderful_team.core import values
from wonderful_team.core.actions import PICK_PLACE, VOCABULARIES, Vocabulary
from wonderful_team.core.deadline import limited, to_end
from wonderful_team.core.geometry import PlanarCamera
from wonderful_team.core.heap import Growth
from wonderful_team.core.interrupts import ends_on_signal, held
from wonderful_team.core.protocols import Decision, Policy, Situation, Subscriber
from wonderful_team.core.values import (
    NO_WORKSPACE,
    GateReport,
    Instruction,
    KeepOut,
    Limits,
    Plan,
    Target,
    Usage,
)
from wonderful_team.errors import ConfigError, UnknownNameError, WonderfulTeamError
from wonderful_team.planning import TeamPolicy as Planner
from wonderful_team.planning import Until
from wonderful_team.planning.ground_only import find
from wonderful_team.record.late import LateRecorder
from wonderful_team.record.recorder import Recorder
from wonderful_team.record.run_folders import find_run, new_run_folder
from wonderful_team.record.setup import setup_entry
from wonderful_team.record.stored_run import StoredRun, load_stored_run
from wonderful_team.runtime import check_gate
from wonderful_team.runtime.loop import Caller

_GROWTH = Growth(100_000_000, apart_s=0.0, circles=False)
"""Each plan needs about as much memory as the one before: what it had is given back once the process has grown."""


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
        facts: str | None = None,
    ) -> PlanResult:
        """Plan for what is seen; nothing moves.

        Args:
            observation: A photo (its path, its pixels, `Observation.from_files`) or `world.observe()`.
            instruction: What is wanted.
            vocabulary: Kinds of action that may be used: pick_place, push, arm, or a Vocabulary.
            limits: The workspace; default that of the photo's camera file or corners, if any.
            until: Stop early: draft, checked, grounded.
            keep_out: Regions nothing may enter.
            facts: What planners are told of the robot and its place, one fact a line: `world.facts`, or your own words on
                tool, reach, viewpoint, north and turns. Default: that nothing of it is known.

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
        told = unknown_robot(words) if facts is None else facts

        def make(recorder: Recorder) -> _Work:
            planner = self.policy(recorder)
            assert isinstance(planner, Planner)
            work = planner.make_plan(observation, wanted, words, bounds, until=until, keep_out=keep_out, facts=told)
            return _Work(work, lambda: planner.usage_by_role)

        setup = setup_entry("plan", words, bounds, until=until, keep_out=keep_out, facts=told)
        return self._recorded(observation, wanted, words, bounds, setup, make)

    def ground(
        self, observation: Seen, objects: str | Sequence[str] = (), areas: str | Sequence[str] = ()
    ) -> PlanResult:
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
            client = self.client(recorder)
            detector = self.make_detector() if self._config.grounding == "detector" else None
            work = find(client, self._config, observation, wanted, targets, detector)
            return _Work(work, lambda: client.budget.by_role)

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
    ) -> PlanResult:
        """Make a plan in a run folder of its own, pass it through the gate, and write its page."""
        started = time.monotonic()
        with limited(self.max_seconds), _recording(instruction.plain_text, self.out, self.command) as recorder:
            everyone = (recorder, *self.subscribers)
            told = {**self.configuration(), "task": instruction, "limits": limits, "setup": setup}
            tell(everyone, "run", str(setup["entry"]), {**told, "words": self.words()})
            tell(everyone, "observe", "start", observation)
            for name, text in _cautions(self.warnings, observation, limits):
                tell(everyone, "warning", name, text)
            with _failing(recorder, everyone), Caller() as caller:
                work = make(recorder)
                plan: Plan = caller.wait_for(work.plan)
                gate = to_end("the safety gate", plan_gate, plan, observation, vocabulary, limits)
                if gate is not None:
                    tell(everyone, "gate", "before motion", gate)
                status = plan.status if gate is None or gate.admitted else "refused"
                tell(everyone, "done", status, plan)
        spent, seconds = dict(work.usage_by_role()), time.monotonic() - started
        return PlanResult(
            plan, observation, gate, spent, seconds, recorder.folder, recorder.warnings, recorder.unwritten
        )


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


@contextlib.contextmanager
def _recording(text: str, out: str | Path | None, command: str | None) -> Iterator[Recorder]:
    """A run folder of its own, whose record and page are whole whatever ends the run: its end, an error, a signal."""
    with ends_on_signal(), contextlib.ExitStack() as closing:
        with held():
            recorder = Recorder(new_run_folder(text, out), command=command)
            closing.callback(_close, recorder)
        yield recorder


@contextlib.contextmanager
def _recording_unless_success(text: str, out: str | Path | None, command: str | None) -> Iterator[LateRecorder]:
    """The same for a run of which nothing is kept where it succeeds: its folder is then never made."""
    with ends_on_signal(), contextlib.ExitStack() as closing:
        with held():
            recorder = LateRecorder(lambda clock: Recorder(new_run_folder(text, out), command=command, clock=clock))
            closing.callback(_close, recorder)
        yield recorder


def _close(recorder: Recorder | LateRecorder) -> None:
    """The record and the page, whole: a signal that comes meanwhile is raised afterwards."""
    with held():
        recorder.close()
        written = recorder.recorder if isinstance(recorder, LateRecorder) else recorder
        if written is not None:
            write_page_or_warn(written)
            written.at_hand.forget()
            _GROWTH.give_back()


@contextlib.contextmanager
def _failing(recorder: Recorder | LateRecorder, everyone: Sequence[Subscriber]) -> Iterator[None]:
    """An error that ends a run is told, and knows the run's folder."""
    try:
        yield
    except WonderfulTeamError as error:
        if not recorder.ended:
            tell_failure(everyone, error)
        if isinstance(recorder, LateRecorder):
            recorder.write()
        error.folder = recorder.folder
        raise


def tell_failure(subscribers: Sequence[Subscriber], error: WonderfulTeamError) -> None:
    """End a run that an error ended, with the traceback of the user's own code where there is one."""
    if error.trace:
        tell(subscribers, "crash", type(error).__name__, error)
    tell(subscribers, "done", "error", error)
