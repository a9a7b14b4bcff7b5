"""A run folder as one value: what was asked, planned, done and how it ended."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from wonderful_team.core.values import Instruction, Observation, Plan
from wonderful_team.errors import reading
from wonderful_team.record.record_schema import read_record
from wonderful_team.record.stored import stored_instruction, stored_observation, stored_plan


@dataclass(frozen=True, eq=False)
class StoredRun:
    """A recorded run, read from its folder.

    Attributes:
        folder: The run folder.
        record: All of record.json; `docs/records.md` says what it holds.
    """

    folder: Path
    record: Mapping[str, Any] = field(repr=False)

    @property
    def state(self) -> str:
        """Running | finished | interrupted."""
        return str(self.record["state"])

    @property
    def outcome(self) -> str:
        """How it ended: a plan's status, or success | failure | error | unscored; the state while there is no outcome."""
        return str(self._ending.get("outcome") or self.state)

    @property
    def stage(self) -> str | None:
        """Where it failed."""
        stage = self._ending.get("stage")
        return None if stage is None else str(stage)

    @property
    def reason(self) -> str:
        """Why it ended so, in a sentence."""
        return str(self._ending.get("reason") or "")

    @property
    def method(self) -> str:
        return str(self.record["configuration"].get("method", ""))

    @property
    def model(self) -> str:
        return str(self.record["configuration"].get("model", ""))

    @property
    def warnings(self) -> tuple[str, ...]:
        return tuple(self.record["planner"]["warnings"])

    @property
    def requests(self) -> tuple[Mapping[str, Any], ...]:
        """Every request with its answer, as record.json holds them."""
        return tuple(self.record["planner"]["requests"])

    @property
    def page(self) -> Path:
        """The run's page."""
        return self.folder / "page.html"

    @cached_property
    def instruction(self) -> Instruction:
        """What was wanted, with its pictures."""
        with reading(f"{self.folder}: the record"):
            return stored_instruction(self.folder, self.record)

    @cached_property
    def observations(self) -> tuple[Observation, ...]:
        """Everything that was seen, with depth and cameras."""
        with reading(f"{self.folder}: the record"):
            numbers = range(len(self.record["planner"]["observations"]))
            return tuple(stored_observation(self.folder, self.record, number) for number in numbers)

    @cached_property
    def plans(self) -> tuple[Plan, ...]:
        """Every plan that was made; the last is the one that counts."""
        with reading(f"{self.folder}: the record"):
            numbers = range(len(self.record["planner"]["plans"]))
            return tuple(stored_plan(self.folder, self.record, number) for number in numbers)

    @property
    def _ending(self) -> Mapping[str, Any]:
        ending: Mapping[str, Any] = self.record["outcome"] or {}
        return ending


def load_stored_run(folder: Path) -> StoredRun:
    """Read a run folder.

    Raises:
        ConfigError: It holds no record that can be read.
    """
    return StoredRun(folder, read_record(folder))
