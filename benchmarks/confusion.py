"""Confusion matrices of members that judge."""

from __future__ import annotations

from dataclasses import dataclass

from wonderful_team.core.intervals import Rate


@dataclass(frozen=True)
class Confusion:
    """How a member that should object judged bad and good things.

    Attributes:
        caught, missed: Bad things that it objected to, and that it let pass.
        false_alarms, passed: Good things that it objected to, and that it let pass.
    """

    caught: int = 0
    missed: int = 0
    false_alarms: int = 0
    passed: int = 0

    def add(self, *, bad: bool, objected: bool) -> Confusion:
        """The matrix with one more judgement."""
        return Confusion(
            self.caught + (bad and objected),
            self.missed + (bad and not objected),
            self.false_alarms + (not bad and objected),
            self.passed + (not bad and not objected),
        )

    @property
    def catch_rate(self) -> Rate:
        return Rate(self.caught, self.caught + self.missed)

    @property
    def alarm_rate(self) -> Rate:
        return Rate(self.false_alarms, self.false_alarms + self.passed)

    def lines(self) -> list[str]:
        """The matrix for reading."""
        return [
            "               objected  let pass",
            f"  bad          {self.caught:8d}  {self.missed:8d}   caught {self.catch_rate}",
            f"  good         {self.false_alarms:8d}  {self.passed:8d}   false alarms {self.alarm_rate}",
        ]
