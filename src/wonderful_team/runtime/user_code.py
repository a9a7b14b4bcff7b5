"""Code that is not ours at the edges of a rollout: whatever a world, a method or a scorer raises or returns becomes a named error of its owner.

A robot's motion that fails is the robot's fault, a camera's failure the world's, a method's exception the method's. Our own
methods are left alone: what they raise unexpectedly is a defect of ours and must not look like a result.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

from wonderful_team.core import deadline
from wonderful_team.core.actions import Action, Vocabulary
from wonderful_team.core.protocols import (
    Act,
    Checked,
    ChecksSubgoals,
    Decision,
    Done,
    GaveUp,
    Policy,
    Privileged,
    Score,
    Situation,
    World,
    facts_of,
)
from wonderful_team.core.values import (
    Instruction,
    Limits,
    Observation,
    Plan,
    PlannedAction,
    StepReport,
    Verdict,
    size_problem,
)
from wonderful_team.errors import (
    MethodCodeError,
    RobotFaultError,
    WonderfulTeamError,
    WorldUnavailableError,
    code_of,
)
from wonderful_team.runtime.loop import Caller

Kind = TypeVar("Kind")
_OURS = "wonderful_team."


def _checked(value: Any, kind: type[Kind] | tuple[type, ...], whose: str, error: type[WonderfulTeamError]) -> Kind:
    if not isinstance(value, kind):
        kinds = kind if isinstance(kind, tuple) else (kind,)
        valid = ", ".join(one.__name__ for one in kinds)
        raise error(f"{whose} is a {type(value).__name__}; valid: {valid}")
    return cast(Kind, value)


def _asked(
    whose: str, kind: type[Kind], error: type[WonderfulTeamError], function: Callable[..., Any], *args: Any
) -> Kind:
    """What somebody else's function returns, within the run's time; `error` is whose fault it is when it does not."""
    with code_of(whose, error):
        value = deadline.bounded(whose, function, *args)
    return _checked(value, kind, f"what {whose} returned", error)


class GuardedWorld:
    """A world whose failures are named: motion is the robot's, everything else the world's."""

    def __init__(self, inner: World) -> None:
        self.inner = inner
        self._name = type(getattr(inner, "inner", inner)).__name__

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)

    def _own(self, attribute: str, kind: type[Kind]) -> Kind:
        with code_of(f"{attribute} of world {self._name}", WorldUnavailableError):
            value = deadline.bounded(f"reading {attribute} of world {self._name}", getattr, self.inner, attribute)
        return _checked(value, kind, f"{attribute} of world {self._name}", WorldUnavailableError)

    @property
    def vocabulary(self) -> Vocabulary:
        return self._own("vocabulary", Vocabulary)

    @property
    def limits(self) -> Limits:
        return self._own("limits", Limits)

    @property
    def facts(self) -> str:
        with code_of(f"facts of world {self._name}", WorldUnavailableError):
            told = deadline.bounded(f"reading facts of world {self._name}", facts_of, self.inner)
        return _checked(told, str, f"facts of world {self._name}", WorldUnavailableError)

    @property
    def instruction(self) -> Instruction:
        return self._own("instruction", Instruction)

    @property
    def horizon(self) -> int | None:
        with code_of(f"horizon of world {self._name}", WorldUnavailableError):
            held = deadline.bounded(f"reading horizon of world {self._name}", getattr, self.inner, "horizon", None)
        return None if held is None else _checked(held, int, f"horizon of world {self._name}", WorldUnavailableError)

    def observe(self) -> Observation:
        """What is seen; a camera that fails is a failure of the world."""
        whose = f"observe() of world {self._name}"
        return _asked(whose, Observation, WorldUnavailableError, self.inner.observe)

    def execute(self, action: Action) -> StepReport:
        """What the robot did; motion that fails is the robot's fault."""
        whose = f"execute({action.kind}) of world {self._name}"
        return _asked(whose, StepReport, RobotFaultError, self.inner.execute, action)

    def stop(self) -> None:
        whose = f"stop() of world {self._name}"
        with code_of(whose, RobotFaultError):
            deadline.to_end(whose, self.inner.stop)

    def close(self) -> None:
        whose = f"close() of world {self._name}"
        with code_of(whose, WorldUnavailableError):
            deadline.to_end(whose, self.inner.close)


def decision_of(policy: Policy, situation: Situation, caller: Caller) -> Decision:
    """What a method decides, checked; what somebody else's method raises, or returns that is no decision, is its failure."""
    deadline.check("the run")
    if type(policy).__module__.startswith(_OURS):
        return cast(Decision, caller.wait_for(policy.decide(situation)))
    whose = f"decide() of method {policy.name!r}"
    with code_of(whose, MethodCodeError):
        decision = caller.wait_for(deadline.bounded(whose, policy.decide, situation), whose)
    whose = f"what decide() of method {policy.name!r} returned"
    settled: Decision = _checked(decision, (Act, Done, GaveUp), whose, MethodCodeError)
    if isinstance(settled, Act):
        _checked(settled.actions, (tuple, list), f"actions of {whose}", MethodCodeError)
        problem = size_problem(actions=len(settled.actions))
        if problem:
            raise MethodCodeError(f"{whose} has {problem}")
        for number, planned in enumerate(settled.actions, start=1):
            _checked(planned, PlannedAction, f"action {number} of {whose}", MethodCodeError)
    if not isinstance(settled, Done) and settled.plan is not None:
        _checked(settled.plan, Plan, f"the plan of {whose}", MethodCodeError)
    return settled


def checked_of(policy: ChecksSubgoals, situation: Situation, caller: Caller) -> Checked:
    """What a method says after a subgoal, checked like its decisions."""
    deadline.check("the run")
    if type(policy).__module__.startswith(_OURS):
        return cast(Checked, caller.wait_for(policy.check(situation)))
    whose = f"check() of method {getattr(policy, 'name', type(policy).__name__)!r}"
    with code_of(whose, MethodCodeError):
        checked = caller.wait_for(deadline.bounded(whose, policy.check, situation), whose)
    said: Checked = _checked(checked, Checked, f"what {whose} returned", MethodCodeError)
    _checked(said.stop, str, f"stop of what {whose} returned", MethodCodeError)
    for number, verdict in enumerate(
        _checked(said.verdicts, tuple, f"verdicts of what {whose} returned", MethodCodeError), 1
    ):
        _checked(verdict, Verdict, f"verdict {number} of what {whose} returned", MethodCodeError)
    return said


def score_of(scorer: Privileged) -> Score:
    """The scorer's word; one that breaks could not judge, which is the world's failure."""
    return _asked(f"score() of {type(scorer).__name__}", Score, WorldUnavailableError, scorer.score)


def close_world(world: World, warn: Callable[[str], None]) -> None:
    """Close a world; what its `close` raises is told, and the result in hand is kept."""
    try:
        GuardedWorld(world).close()
    except WonderfulTeamError as error:
        warn(f"warning: {error}")
