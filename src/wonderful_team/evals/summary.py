"""From the rows of a store to the figures of a report: cells, stages, costs, warnings. Nothing here is estimated."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from wonderful_team.evals.controls import CONTROLS, ORACLE, control_faults
from wonderful_team.evals.pairing import Pair, pair
from wonderful_team.evals.plan import OFFLINE
from wonderful_team.evals.statistics import Rate
from wonderful_team.evals.trials import DEVELOPMENT_BELOW, Condition, Row, TrialResult

TOO_MANY_ERRORS = 0.02
"""Share of errors in a cell from which its rate deserves a warning."""


@dataclass(frozen=True)
class Cell:
    """Some trials of one condition: what a line of a table says.

    Attributes:
        missing: Trials that have not ended.
        retried: Attempts that were thrown away (errors tried again, trials cut by a study's cap).
    """

    condition: Condition
    results: tuple[TrialResult, ...]
    seeds: tuple[int, ...]
    missing: int = 0
    retried: int = 0

    def count(self, outcome: str) -> int:
        return sum(result.outcome == outcome for result in self.results)

    @property
    def rate(self) -> Rate:
        """Successes of the scored trials: errors and unscored ones do not count."""
        return Rate(self.count("success"), self.count("success") + self.count("failure"))

    @property
    def error_share(self) -> float:
        return self.count("error") / len(self.results) if self.results else 0.0

    @property
    def usd(self) -> float | None:
        """Money of all trials; None where any price is unknown."""
        total = 0.0
        for result in self.results:
            if result.usd is None:
                return None
            total += result.usd
        return total

    @property
    def usd_per_trial(self) -> float | None:
        return self.usd / len(self.results) if self.results and self.usd is not None else None

    @property
    def usd_per_success(self) -> float | None:
        """Money over successes; None without a success or with an unknown price."""
        return self.usd / self.count("success") if self.usd is not None and self.count("success") else None

    def mean(self, name: str) -> float | None:
        """Mean of a figure of the results, such as calls, rounds, seconds, tokens; None without trials."""
        return sum(getattr(result, name) for result in self.results) / len(self.results) if self.results else None

    def fact(self, name: str) -> float | None:
        """Mean of a fact over the results that have it."""
        values = [result.facts[name] for result in self.results if name in result.facts]
        return sum(values) / len(values) if values else None

    @property
    def badges(self) -> tuple[str, ...]:
        """What a reader must know of where the answers came from."""
        seen = {word for result in self.results for word in result.provenance}
        model = self.condition.model
        names = {"offline", "simulated", "cached", "injected", "replayed", "scripted"} & seen
        names |= {"offline"} if model == OFFLINE and any(result.calls for result in self.results) else set()
        names |= {"simulated"} if model.startswith("simulated:") or self.condition.isolate else set()
        return tuple(sorted(name.upper() for name in names))

    @property
    def seed_range(self) -> str:
        """Seeds in words: "1000-1019" or a count where they have gaps."""
        found = sorted(set(self.seeds))
        if not found:
            return "none"
        whole = found == list(range(found[0], found[-1] + 1))
        return (
            f"{found[0]}-{found[-1]}"
            if whole and len(found) > 1
            else (str(found[0]) if whole else f"{len(found)} of {found[0]}-{found[-1]}")
        )


def cell(condition: Condition, rows: Iterable[Row]) -> Cell:
    """The cell of a condition over some rows."""
    mine = [row for row in rows if row.spec.condition == condition]
    ended = [row for row in mine if row.result is not None]
    return Cell(
        condition,
        tuple(row.result for row in ended if row.result is not None),
        tuple(row.spec.seed for row in mine),
        len(mine) - len(ended),
        sum(row.discarded for row in mine),
    )


@dataclass(frozen=True)
class Summary:
    """Everything a report says, computed from rows.

    Attributes:
        compared: Conditions that were asked for, in that order; `bounds`: the controls.
        requests: What the studies asked for.
    """

    rows: tuple[Row, ...]
    requests: tuple[Mapping[str, object], ...]
    compared: tuple[Condition, ...]
    bounds: tuple[Condition, ...]

    @property
    def tasks(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(row.spec.task for row in self.rows))

    def cell(self, condition: Condition, task: str | None = None) -> Cell:
        return cell(condition, self.rows_of(task))

    def rows_of(self, task: str | None) -> tuple[Row, ...]:
        return self.rows if task is None else tuple(row for row in self.rows if row.spec.task == task)

    def pairs(self, baseline: str | None = None) -> tuple[Pair, ...]:
        """Every two compared conditions of the same tier, or each against those of one method."""
        found = []
        for place, first in enumerate(self.compared):
            for second in self.compared[place + 1 :]:
                if first.perturb != second.perturb:
                    continue
                if baseline is None:
                    found.append(pair(first, second, self.rows))
                elif second.method == baseline and first.method != baseline:
                    found.append(pair(first, second, self.rows))
                elif first.method == baseline and second.method != baseline:
                    found.append(pair(second, first, self.rows))
        return tuple(found)

    def stages(self, condition: Condition) -> Counter[str]:
        """Failures of a condition by stage."""
        return Counter(
            row.result.stage or "unknown"
            for row in self.rows
            if row.spec.condition == condition and row.result is not None and row.result.outcome == "failure"
        )

    def headline(self, baseline: str | None = None) -> list[str]:
        """The answer, one sentence per comparison that was asked for."""
        pairs = [one for one in self.pairs(baseline) if not (one.first.isolate or one.second.isolate)]
        if pairs:
            return [one.sentence() for one in pairs[:3]]
        if self.compared:
            return [f"{one.label}: {self.cell(one).rate}." for one in self.compared[:3]]
        return [
            "Only controls were run: no method is compared." if self.bounds else "No data: the store holds no trial."
        ]

    def warnings(self) -> list[str]:
        """What a reader must know before any figure."""
        found: list[str] = []
        for condition in (*self.compared, *self.bounds):
            for task in self.tasks:
                one = self.cell(condition, task)
                if one.error_share > TOO_MANY_ERRORS:
                    found.append(
                        f"{condition.label}, {task}: {one.count('error')} of {len(one.results)} trials are errors "
                        f"({100 * one.error_share:.0f} %, more than {100 * TOO_MANY_ERRORS:.0f} %): not scored; --retry-errors runs them again"
                    )
            whole = self.cell(condition)
            if whole.missing:
                found.append(f"{condition.label}: {whole.missing} trials have not ended")
            if whole.badges and condition in self.compared:
                found.append(
                    f"{condition.label}: {', '.join(whole.badges)}: says nothing about a vision-language model"
                )
        development = sorted(
            {
                row.spec.seed
                for row in self.rows
                if row.spec.seed < DEVELOPMENT_BELOW and not row.spec.task.endswith(".json")
            }
        )
        if development:
            found.append(
                f"{len(development)} development seeds (below {DEVELOPMENT_BELOW}) are among the trials: {development[:10]}"
            )
        found += [f"{task}: {fault}" for task in self.tasks for fault in self._control_faults(task)]
        found += self._mixed_versions()
        if (
            self.compared
            and not any(one.method in (ORACLE,) for one in self.bounds)
            and not all(t.endswith(".json") for t in self.tasks)
        ):
            found.append("controls were refused: nothing here shows that the scorers can tell success from failure")
        return found

    def _control_faults(self, task: str) -> list[str]:
        counts = {}
        for condition in {*self.bounds, *self.compared}:
            if condition.method in CONTROLS:
                rate = self.cell(condition, task).rate
                counts[condition.method] = (rate.successes, rate.n)
        return control_faults(counts)

    def _mixed_versions(self) -> list[str]:
        found = []
        for condition in self.compared:
            versions = {
                tuple(sorted(result.versions.items())) for result in self.cell(condition).results if result.versions
            }
            if len(versions) > 1:
                found.append(
                    f"{condition.label}: its trials were made by {len(versions)} different versions of the code"
                )
        return found


def summarise(rows: Sequence[Row], requests: Sequence[Mapping[str, object]]) -> Summary:
    """Sort a store's rows into what was compared and what bounds it."""
    asked = {
        (method, model) for one in requests for method in _names(one, "methods") for model in _names(one, "models")
    }
    conditions = tuple(dict.fromkeys(row.spec.condition for row in rows))

    def compared(one: Condition) -> bool:
        if one.method in CONTROLS:
            return False
        return not asked or (one.method, one.model) in asked

    return Summary(
        tuple(rows),
        tuple(requests),
        tuple(one for one in conditions if compared(one)),
        tuple(one for one in conditions if not compared(one)),
    )


def merge(stores: Sequence[Sequence[Row]]) -> tuple[list[Row], list[str]]:
    """Rows of several stores as one; a trial that ended twice is kept once, and told when the outcomes differ."""
    kept: dict[str, Row] = {}
    warnings: list[str] = []
    for rows in stores:
        for row in rows:
            before = kept.get(row.spec.key)
            if before is None or before.result is None:
                kept[row.spec.key] = row
            elif row.result is not None and row.result.outcome != before.result.outcome:
                warnings.append(
                    f"{row.spec.scene}, {row.spec.condition.label}: {before.result.outcome} in one store and "
                    f"{row.result.outcome} in another; the first is kept"
                )
    return list(kept.values()), warnings


def _names(request: Mapping[str, object], key: str) -> list[str]:
    found = request.get(key, [])
    return [str(name) for name in found] if isinstance(found, list) else []
