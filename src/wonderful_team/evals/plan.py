"""What a study asks for: suites x methods x models x seeds x repeats, as a list of trials."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from wonderful_team.errors import ConfigError
from wonderful_team.evals.names import CONTROLS, NO_MODEL
from wonderful_team.evals.photos import is_photo
from wonderful_team.evals.suites import Suite, default_seeds
from wonderful_team.evals.toy import is_toy
from wonderful_team.evals.trials import Condition, TrialSpec

OFFLINE = "offline"
ISOLATES = ("planning", "grounding")
WHOLE = "whole"
"""What a user calls a study that isolates nothing."""


@dataclass(frozen=True)
class StudyPlan:
    """What is to be run.

    Attributes:
        suites: Tasks with their protocols.
        methods, models: Names; every method runs with every model.
        seeds: For every task; None for each suite's own.
        repeats: How often each scene is run.
        controls: Names of the controls that run too, `offline` among them.
        isolate: "" (whole), planning, grounding: one or several.
        perturb: "" (as it is) or KIND=LEVEL: one or several, each a condition of its own.
        replans: None for each suite's own protocol.
        reobserve: Looks of every condition that asks a model; see Condition.
        how: What else was asked for of models, words and caps: part of every condition that asks a model.
        shard: (I, N): only the I-th of N parts, counted from 1; a scene's trials stay together.

    Raises:
        ConfigError: A value out of range.
    """

    suites: tuple[Suite, ...]
    methods: tuple[str, ...] = ("team",)
    models: tuple[str, ...] = (OFFLINE,)
    seeds: tuple[int, ...] | None = None
    repeats: int = 1
    controls: tuple[str, ...] = (*CONTROLS, OFFLINE)
    isolate: tuple[str, ...] = ("",)
    perturb: tuple[str, ...] = ("",)
    replans: int | None = None
    shard: tuple[int, int] = (1, 1)
    how: str = ""
    reobserve: int = 0
    note: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.reobserve < 0:
            raise ConfigError(f"reobserve must be 0 or more, got {self.reobserve}")
        if self.repeats < 1:
            raise ConfigError(f"repeats must be at least 1, got {self.repeats}")
        for isolate in self.isolate:
            if isolate and isolate not in ISOLATES:
                raise ConfigError(f"isolate {isolate!r}: valid are {', '.join((WHOLE, *ISOLATES))}")
        part, parts = self.shard
        if not 1 <= part <= parts:
            raise ConfigError(f"shard {part}/{parts}: valid is I/N with I from 1 to N")
        for name, words in (("method", self.methods), ("model", self.models)):
            if not words or len(set(words)) < len(words):
                raise ConfigError(f"{name}s {', '.join(words) or '(none)'}: name at least one, none twice")

    def conditions(self, suite: Suite) -> tuple[Condition, ...]:
        """What is compared on a suite; controls last."""
        replans = suite.protocol.replans if self.replans is None else self.replans
        bounds = [] if of_pictures(suite) else [name for name in self.controls if name in CONTROLS]
        asked = []
        for perturb in self.perturb:
            asked += [self._condition(*names, perturb, replans) for names in self._named()]
        for perturb in self.perturb:
            asked += [Condition(name, NO_MODEL, "", perturb, 0) for name in bounds]
            if OFFLINE in self.controls and not suite.methods:
                asked.append(Condition("team", OFFLINE, "", perturb, replans, self.how, self.reobserve))
        return tuple(dict.fromkeys(asked))

    def _named(self) -> list[tuple[str, str, str]]:
        return [(method, model, part) for method in self.methods for model in self.models for part in self.isolate]

    def _condition(self, method: str, model: str, isolate: str, perturb: str, replans: int) -> Condition:
        if method in CONTROLS:
            return Condition(method, NO_MODEL, "", perturb, 0)
        return Condition(method, model, isolate, perturb, replans, self.how, self.reobserve)

    def trials(self) -> Iterator[TrialSpec]:
        """Every trial of this shard, seed by seed, so that a study cut short is balanced."""
        seen: set[str] = set()
        for repeat in range(self.repeats):
            for place in range(max(len(self.seeds_of(suite)) for suite in self.suites)):
                for suite in self.suites:
                    seeds = self.seeds_of(suite)
                    for task in suite.tasks if place < len(seeds) else ():
                        if not self._mine(task, seeds[place], repeat):
                            continue
                        for condition in self.conditions(suite):
                            spec = TrialSpec(task, seeds[place], condition, repeat)
                            if _is_repeatable(condition) and repeat or spec.key in seen:
                                continue
                            seen.add(spec.key)
                            yield spec

    def seeds_of(self, suite: Suite) -> tuple[int, ...]:
        if of_photos(suite):
            # A photo is one scene: its number takes the place of a seed.
            return tuple(range(int(self.note.get(f"photos:{suite.name}", 1))))
        return self.seeds if self.seeds is not None else default_seeds(suite.protocol)

    def _mine(self, task: str, seed: int, repeat: int) -> bool:
        part, parts = self.shard
        digest = hashlib.sha256(f"{task}#{seed}#{repeat}".encode()).digest()
        return int.from_bytes(digest[:8], "big") % parts == part - 1

    @property
    def name(self) -> str:
        """Hash of what is asked for: the same request goes on where it stopped."""
        return hashlib.sha256(json.dumps([spec.key for spec in self.trials()]).encode()).hexdigest()[:12]

    def request(self) -> dict[str, Any]:
        """What the store remembers of it."""
        return {
            "suites": [suite.name for suite in self.suites],
            "notes": [f"{suite.name}: {suite.note}" for suite in self.suites if suite.note],
            "protocols": sorted({suite.protocol.name for suite in self.suites}),
            "command": "",
            "methods": list(self.methods),
            "models": list(self.models),
            "seeds": None if self.seeds is None else list(self.seeds),
            "repeats": self.repeats,
            "controls": list(self.controls),
            "isolate": list(self.isolate),
            "perturb": list(self.perturb),
            "how": self.how,
            "shard": list(self.shard),
            **{key: value for key, value in self.note.items() if not key.startswith("photos:")},
        }


def of_photos(suite: Suite) -> bool:
    """Whether a suite is photos with boxes: scenes without a simulator."""
    return is_photo(suite.name)


def of_pictures(suite: Suite) -> bool:
    """Whether nothing acts in a suite: photos, and questions about the toy table."""
    return of_photos(suite) or all(is_toy(task) for task in suite.tasks)


def _is_repeatable(condition: Condition) -> bool:
    """Controls are deterministic: repeating one tells nothing."""
    return condition.method in CONTROLS


def read_shard(words: str) -> tuple[int, int]:
    """(I, N) from "I/N".

    Raises:
        ConfigError: Another form.
    """
    part, slash, parts = words.partition("/")
    if not (slash and part.isdigit() and parts.isdigit() and 1 <= int(part) <= int(parts)):
        raise ConfigError(f"shard {words!r}: valid is I/N with I from 1 to N, as in 1/4")
    return int(part), int(parts)


def split_names(words: Sequence[str]) -> tuple[str, ...]:
    """Names from repeated options that may hold several with commas."""
    return tuple(name.strip() for word in words for name in word.split(",") if name.strip())
