"""What a study would take: calls, tokens, money, hours, and which gaps its number of trials can show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from wonderful_team.core.text import counted
from wonderful_team.evals.names import CONTROLS
from wonderful_team.evals.pairing import visible_gap
from wonderful_team.evals.plan import StudyPlan
from wonderful_team.evals.trials import Condition, Row, TrialRow

DISCORDANT = 0.3
"""Share of pairs in which just one method succeeds that the reckoning of visible gaps assumes."""


@dataclass(frozen=True)
class Line:
    """One condition: how many of its trials are missing, and means per trial; None where nothing is known.

    Attributes:
        measured: On how many trials the means rest.
        source: Where they come from, in words.
        least, most: Calls and tokens of the cheapest and of the dearest of these trials; None where nothing was measured.
    """

    condition: Condition
    trials: int
    measured: int
    source: str
    calls: float | None
    tokens: float | None
    usd: float | None
    seconds: float | None
    least: tuple[int, int] | None = None
    most: tuple[int, int] | None = None

    def total(self, name: str) -> float | None:
        mean = getattr(self, name)
        return None if mean is None else mean * self.trials


@dataclass(frozen=True)
class Estimate:
    """What is missing of a study and what it would take.

    Attributes:
        workers: Trials that run at the same time.
        pairs: Scenes per condition: what two methods would be compared on.
    """

    lines: tuple[Line, ...]
    workers: int
    pairs: int
    ended: int

    def total(self, name: str) -> float | None:
        """Sum over all conditions; None when any is unknown."""
        totals = [line.total(name) for line in self.lines if line.trials]
        return None if any(one is None for one in totals) else sum(one for one in totals if one is not None)

    def bounds(self, name: str) -> tuple[int, int] | None:
        """What calls or tokens come to if every trial were as cheap, or as dear, as the cheapest or dearest seen."""
        place = ("calls", "tokens").index(name)
        wanted = [line for line in self.lines if line.trials]
        if not all(line.least and line.most for line in wanted):
            return None
        low = sum(line.least[place] * line.trials for line in wanted if line.least)
        return low, sum(line.most[place] * line.trials for line in wanted if line.most)

    @property
    def hours(self) -> float | None:
        seconds = self.total("seconds")
        return None if seconds is None else seconds / self.workers / 3600

    @property
    def gap(self) -> float | None:
        """The smallest gap that this many pairs show."""
        return visible_gap(self.pairs, DISCORDANT)

    def text(self) -> str:
        """For reading."""
        width = max([len(line.condition.label) for line in self.lines] + [9])
        rows = [f"{'condition':<{width}}  missing   calls  tokens     USD       s  per trial, from"]
        for line in self.lines:
            figures = "  ".join(
                f"{_number(getattr(line, name), digits):>6}"
                for name, digits in (("calls", 1), ("tokens", 0), ("usd", 4), ("seconds", 1))
            )
            rows.append(f"{line.condition.label:<{width}}  {line.trials:>7}  {figures}  {line.source}")
        hours = (
            "unknown"
            if self.hours is None
            else f"{self.hours:.2f} h"
            if self.hours >= 0.1
            else f"{60 * self.hours:.1f} min"
        )
        rows.append(
            f"in all: {counted(sum(line.trials for line in self.lines), 'trial')} ({self.ended} have ended), "
            f"{self._with_bounds('calls')}, {self._with_bounds('tokens')}, "
            f"{_number(self.total('usd'), 2)} USD, {hours} with {self.workers} at a time"
        )
        rows.append(self.sentence())
        return "\n".join(rows)

    def _with_bounds(self, name: str) -> str:
        bounds = self.bounds(name)
        wide = "" if bounds is None or bounds[0] == bounds[1] else f" ({bounds[0]:,} to {bounds[1]:,})"
        return f"{_number(self.total(name), 0)} {name}{wide}"

    def sentence(self) -> str:
        """What this number of trials can show."""
        if self.gap is None:
            return f"with {self.pairs} scenes per method no gap can be shown (exact paired test, 5 %, power 80 %)"
        return (
            f"with {self.pairs} scenes per method you can see gaps of about {100 * self.gap:.0f} points "
            f"(paired test, 5 % two-sided, power 80 %, if the methods disagree on {100 * max(DISCORDANT, self.gap):.0f} % of scenes)"
        )

    def to_json(self) -> dict[str, Any]:
        """For machines."""
        lines = [
            {
                "condition": line.condition.label,
                "missing": line.trials,
                "measured_on": line.measured,
                "source": line.source,
                **{f"{name}_per_trial": getattr(line, name) for name in ("calls", "tokens", "usd", "seconds")},
            }
            for line in self.lines
        ]
        totals = {name: self.total(name) for name in ("calls", "tokens", "usd", "seconds")}
        bounds = {name: self.bounds(name) for name in ("calls", "tokens")}
        return {
            "conditions": lines,
            "total": totals,
            "bounds": bounds,
            "hours": self.hours,
            "pairs": self.pairs,
            "visible_gap": self.gap,
        }


def estimate(
    plan: StudyPlan, rows: Sequence[Row], pilots: Mapping[Condition, Sequence[TrialRow]], workers: int
) -> Estimate:
    """Reckon what is missing of a plan.

    Args:
        plan: What is asked for.
        rows: Trials of the store that the study would go on in.
        pilots: Results of pilot trials, per condition.
        workers: Trials at the same time.
    """
    ended = {row.spec.key for row in rows if row.result is not None}
    missing: dict[Condition, int] = {}
    scenes: dict[Condition, int] = {}
    for spec in plan.trials():
        missing[spec.condition] = missing.get(spec.condition, 0) + (spec.key not in ended)
        scenes[spec.condition] = scenes.get(spec.condition, 0) + 1
    lines = tuple(_line(one, number, rows, pilots.get(one, ())) for one, number in missing.items())
    asked = [number for one, number in scenes.items() if one.method not in CONTROLS]
    return Estimate(lines, workers, min(asked, default=0), len(ended))


def _line(condition: Condition, trials: int, rows: Sequence[Row], pilots: Sequence[TrialRow]) -> Line:
    own = [row.result for row in rows if row.result is not None and row.spec.condition == condition]
    results, source = [*own, *pilots], f"{len(own)} recorded and {len(pilots)} pilot trials"
    calls = tokens = usd = seconds = least = most = None
    if results:
        n = len(results)
        calls, tokens = sum(r.calls for r in results) / n, sum(r.tokens for r in results) / n
        seconds = sum(r.seconds for r in results) / n
        priced = [r.usd for r in results if r.usd is not None]
        usd = sum(priced) / n if len(priced) == n else None
        least = (min(r.calls for r in results), min(r.tokens for r in results))
        most = (max(r.calls for r in results), max(r.tokens for r in results))
    else:
        alike = [r.result for r in rows if r.result is not None and r.spec.condition.method == condition.method]
        source = "nothing recorded: --pilot N runs some (it may cost money)"
        if alike:
            calls = sum(r.calls for r in alike) / len(alike)
            source = f"calls from {len(alike)} trials of the same method with another model; the rest unknown"
    return Line(condition, trials, len(results), source, calls, tokens, usd, seconds, least, most)


def _number(value: float | None, digits: int) -> str:
    return "unknown" if value is None else f"{value:,.{digits}f}"
