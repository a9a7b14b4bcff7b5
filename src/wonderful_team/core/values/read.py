"""A plan that was read beforehand, with what it was made from: its picture, its page, and when."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from wonderful_team.core.values.content import file_hash
from wonderful_team.core.values.observation import Observation
from wonderful_team.core.values.plan import Plan


@dataclass(frozen=True, eq=False)
class ReadPlan:
    """A plan that was read: it runs as it is, or nothing moves.

    Attributes:
        plan: What was read.
        observation: The picture that it was made from; without it the scene must be the same pixel for pixel.
        page: The page that was read; None without one.
        same_clock: The picture's time was told by the clock of the world in which it is going to run. The clock of an
            earlier run says nothing of now: then the regions that the plan relies on decide, whatever the time.
    """

    plan: Plan
    observation: Observation | None = None
    page: Path | None = None
    same_clock: bool = True

    @property
    def page_hash(self) -> str:
        """SHA-256 of the page; "" without one."""
        return file_hash(self.page)
