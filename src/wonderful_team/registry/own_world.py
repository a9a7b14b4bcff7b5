"""A world of the user's own, or with an instruction or regions of the user's own, made whole."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

from wonderful_team.core.actions import Action, Vocabulary
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Filmed, facts_of, offers
from wonderful_team.core.values import Instruction, KeepOut, Limits, Observation, StepReport


@dataclass(frozen=True, eq=False)
class OwnWorld:
    """A user's world made whole: an instruction from outside, and what it left out (`stop`, `close`) as no-ops.

    Replacing the instruction also drops the scorer: it judges the instruction that the world came with.
    """

    inner: Any
    instruction: Instruction
    keep_out: tuple[KeepOut, ...] = ()

    @property
    def vocabulary(self) -> Vocabulary:
        return cast(Vocabulary, self.inner.vocabulary)

    @property
    def limits(self) -> Limits:
        limits = cast(Limits, self.inner.limits)
        return replace(limits, keep_out=(*limits.keep_out, *self.keep_out))

    @property
    def facts(self) -> str:
        return facts_of(self.inner)

    @property
    def horizon(self) -> int | None:
        return getattr(self.inner, "horizon", None)

    @property
    def privileged(self) -> Any:
        own = getattr(self.inner, "instruction", None)
        return getattr(self.inner, "privileged", None) if self.instruction is own else None

    def observe(self) -> Observation:
        return cast(Observation, self.inner.observe())

    def execute(self, action: Action) -> StepReport:
        return cast(StepReport, self.inner.execute(action))

    def film(self, each: Callable[[Mapping[str, Array]], None] | None, every_s: float = 0.1) -> None:
        if offers(self.inner, Filmed):
            self.inner.film(each, every_s)

    def stop(self) -> None:
        if hasattr(self.inner, "stop"):
            self.inner.stop()

    def close(self) -> None:
        if hasattr(self.inner, "close"):
            self.inner.close()
