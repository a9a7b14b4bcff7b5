"""Rows of a store's file and the values that they stand for."""

from __future__ import annotations

import json
import sqlite3
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


def spec_of(row: sqlite3.Row) -> TrialSpec:
    condition = Condition(*(row[name] for name in CONDITION))
    return TrialSpec(row["task"], row["seed"], condition, row["repeat"])


def result_of(row: sqlite3.Row) -> TrialRow:
    values = {name: json.loads(row[name]) if name in JSON else row[name] for name in RESULT}
    return _RESULT.validate_python(values)
