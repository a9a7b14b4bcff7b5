"""What is run and what came of it: one trial as asked for, its result, and the condition it belongs to."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal, Protocol, TypeAlias, get_args

from wonderful_team.core.caps import Caps
from wonderful_team.errors import ConfigError

VALID_SUBGOAL = "at least one valid subgoal"
JUDGED = {
    (True, True): "judged done, rightly",
    (True, False): "judged done, wrongly",
    (False, False): "judged not done, rightly",
    (False, True): "judged not done, wrongly",
}
"""Facts that count a trial's judgements of what it did: what was said, whether it was so, and the fact's name."""
JUDGED_SUBGOAL: dict[tuple[bool, bool | None], str] = {
    (True, True): "subgoal judged done, rightly",
    (True, False): "subgoal judged done, wrongly",
    (False, False): "subgoal judged not done, rightly",
    (False, True): "subgoal judged not done, wrongly",
    (True, None): "subgoal judged done, truth not known",
    (False, None): "subgoal judged not done, truth not known",
}
"""The same of judgements on single subgoals, made while others were still to run; None where the simulator's truth says nothing of it."""
"""Fact of a trial: after some action a goal of the task held that did not hold before (the paper's Appendix A)."""
OUTCOMES = ("success", "failure", "error", "unscored")
Outcome: TypeAlias = Literal["success", "failure", "error", "unscored"]
Recorded: TypeAlias = Literal["full", "failures", "none"]
RECORDED: tuple[Recorded, ...] = get_args(Recorded)
"""Which trials of a study keep their run folder."""
PRIVILEGED = "PRIVILEGED"
"""Marks what was told what no planner may see."""
DEVELOPMENT_BELOW = 1000
"""Seeds below this one are for development and docs; suites start here (INTERFACE)."""


@dataclass(frozen=True, order=True, slots=True)
class Condition:
    """What is compared: everything of a trial but its scene.

    Attributes:
        method, model: Names; the model of a control that asks none is "-".
        isolate: "" | planning (grounding from truth) | grounding (plan from the oracle).
        perturb: "" or KIND=LEVEL: a harder tier, scored separately.
        replans: How often it may plan again after its first attempt.
        how: What else was asked for of models, words and caps, such as "thinking high"; "" for nothing.
        reobserve: How often it may run only the first push of a plan, look, and plan the rest anew.
    """

    method: str
    model: str
    isolate: str = ""
    perturb: str = ""
    replans: int = 0
    how: str = ""
    reobserve: int = 0

    @property
    def values(self) -> tuple[Any, ...]:
        """Its fields, in their order."""
        return tuple(getattr(self, name) for name in CONDITION)

    @property
    def label(self) -> str:
        """For tables: method · model, and what is special about it."""
        words = [self.method] + ([self.model] if self.model != "-" else [])
        words += [f"{PRIVILEGED}: told the simulator's truth"] if "privileged" in self.method.split(":") else []
        words += [f"{self.isolate} alone"] if self.isolate else []
        words += [self.perturb] if self.perturb else []
        words += [f"{self.replans} replans"] if self.replans else []
        words += [f"reobserve {self.reobserve}"] if self.reobserve else []
        words += [self.how] if self.how else []
        return " · ".join(words)


CONDITION = tuple(item.name for item in fields(Condition))
"""Names of the fields of a condition, in their order."""


@dataclass(frozen=True, slots=True)
class TrialSpec:
    """One trial to run. Two specs with the same fields are the same trial and run once."""

    task: str
    seed: int
    condition: Condition
    repeat: int = 0

    @property
    def key(self) -> str:
        """Identity in the store; stores made before `how` and `reobserve` existed keep theirs."""
        *values, how, reobserve = self.condition.values
        later = [how, reobserve] if reobserve else [how] if how else []
        return json.dumps([self.task, self.seed, self.repeat, *values, *later])

    @property
    def scene(self) -> str:
        """How records name the scene."""
        return f"{self.task}#{self.seed}"


@dataclass(frozen=True, slots=True)
class TrialRow:
    """What came of one trial.

    Attributes:
        outcome: success | failure | error (ours or the provider's) | unscored.
        stage: Where it failed; None on success.
        usd: Money; None where any price is unknown.
        seconds: Wall clock of the whole trial [s].
        rounds: Waiting rounds: longest chain of requests that were sent one after another's answer.
        page: Path of the trial's page, or "".
        versions: Package, commit and hashes of own files: what produced it.
        facts: Figures of the trial beyond its outcome, such as the overlap of boxes with photos.
    """

    outcome: Outcome
    stage: str | None = None
    reason: str = ""
    calls: int = 0
    tokens: int = 0
    pictures: int = 0
    usd: float | None = 0.0
    seconds: float = 0.0
    rounds: int = 0
    provenance: tuple[str, ...] = ()
    by_role: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    page: str = ""
    instruction: str = ""
    versions: Mapping[str, str] = field(default_factory=dict)
    facts: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.outcome not in OUTCOMES:
            raise ValueError(f"outcome {self.outcome!r}: valid are {', '.join(OUTCOMES)}")


@dataclass(frozen=True, slots=True)
class Row:
    """A trial of a store: what was asked for and, once it ended, what came of it."""

    spec: TrialSpec
    result: TrialRow | None
    discarded: int = 0


class Limiter(Protocol):
    """Bounds how many model calls are in flight over all workers of a study."""

    async def acquire(self) -> None: ...

    async def release(self) -> None: ...


@dataclass(frozen=True)
class RunSettings:
    """How trials are run; nothing here decides which trial it is.

    Attributes:
        caps: Of one trial.
        concurrency: Most model calls at once within one trial.
        record: Which trials keep their run folder: full (every one) | failures (those that did not succeed) | none.
        out: Where run folders go.
        prompts: Folder with own words for the team's roles.
        limiter: Shared by all workers.
        extra: Settings of the top that evals passes through unread.
        named_code: The FILE.py:NAME that the caller named; a trial out of a store may name no other. None: trials come from
            the caller itself.
    """

    caps: Caps = Caps()
    concurrency: int = 8
    record: Recorded = "none"
    out: Path | None = None
    prompts: Path | None = None
    limiter: Limiter | None = None
    extra: Mapping[str, Any] = field(default_factory=dict)
    named_code: frozenset[str] | None = None

    def __post_init__(self) -> None:
        if self.record not in RECORDED:
            raise ConfigError(f"record {self.record!r}: valid are {', '.join(RECORDED)}")


TrialRunner: TypeAlias = Callable[[TrialSpec, RunSettings], TrialRow]
"""Handed in by `api`: turns names into methods, models and worlds, and runs one trial.

It must be importable by name (a module-level function), because worker processes import it."""
