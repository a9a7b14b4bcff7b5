"""Rows of a store's file and the values that they stand for."""

from __future__ import annotations

import json
import sqlite3
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any

from pydantic import TypeAdapter

from wonderful_team.core.caps import Caps
from wonderful_team.evals.schema import CONDITION, JSON, RESULT
from wonderful_team.evals.spending import Costs
from wonderful_team.evals.trials import Condition, TrialRow, TrialSpec

_RESULT = TypeAdapter(TrialRow)
"""What is read out of the file is of the type that it was written with."""


class Claim:
    """A trial that this process may run.

    Attributes:
        left: What the caps of the study leave for this trial; None per cap that is not set.
    """

    def __init__(self, trial: int, spec: TrialSpec, left: Caps) -> None:
        self.trial, self.spec, self.left = trial, spec, left


def costs_of(taken: sqlite3.Row) -> Costs:
    """The dearest of each unit; unknown where nothing was taken yet."""
    return (taken[1], taken[2], taken[3]) if taken[0] else (None, None, None)


def spec_values(spec: TrialSpec) -> tuple[Any, ...]:
    return (spec.key, spec.task, spec.seed, spec.repeat, *spec.condition.values)


@lru_cache(maxsize=4096)
def _condition(*values: Any) -> Condition:
    return Condition(*values)


def spec_of(row: sqlite3.Row) -> TrialSpec:
    return TrialSpec(
        sys.intern(row["task"]), row["seed"], _condition(*(row[name] for name in CONDITION)), row["repeat"]
    )


class StoredMapping(Mapping[str, Any]):
    """A mapping that is kept as its JSON text and read when it is asked: a tenth of the memory, for studies of many trials."""

    __slots__ = ("_text",)

    def __init__(self, text: str) -> None:
        self._text = text

    def __getitem__(self, key: str) -> Any:
        return self._read()[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._read())

    def __len__(self) -> int:
        return len(self._read())

    def _read(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(self._text)
        return found


def result_of(row: sqlite3.Row) -> TrialRow:
    """The result of a trial; what many trials say alike is held once."""
    values = {name: json.loads(row[name]) if name in JSON else row[name] for name in RESULT}
    read = _RESULT.validate_python(values)
    return replace(
        read,
        outcome=sys.intern(read.outcome),  # type: ignore[arg-type]
        reason=sys.intern(read.reason),
        instruction=sys.intern(read.instruction),
        provenance=_alike(read.provenance),
        versions=_stored(row["versions"]),
        by_role=StoredMapping(row["by_role"]),
        facts=_stored(row["facts"]),
    )


@lru_cache(maxsize=4096)
def _alike(provenance: tuple[str, ...]) -> tuple[str, ...]:
    return provenance


@lru_cache(maxsize=4096)
def _stored(text: str) -> Mapping[str, Any]:
    return MappingProxyType(json.loads(text))
