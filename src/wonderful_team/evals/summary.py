"""From the rows of a store to the figures of a report: cells, stages, costs, warnings. Nothing here is estimated."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from wonderful_team.core.intervals import Rate
from wonderful_team.core.text import counted
from wonderful_team.evals.controls import CONTROLS, ORACLE, control_faults
from wonderful_team.evals.pairing import Pair, pair
from wonderful_team.evals.photos import is_photo
from wonderful_team.evals.plan import OFFLINE
from wonderful_team.evals.toy import is_toy
from wonderful_team.evals.trials import DEVELOPMENT_BELOW, Condition, Row, TrialRow

SENTENCES = 3
LISTED = 6
"""Conditions that a warning lists by name, where it is about all of them."""
TOO_MANY_ERRORS = 0.02
"""Share of errors in a cell from which its rate deserves a warning."""
NO_VLM = ("offline", "simulated", "scripted", "injected")
"""Where answers come from that no vision-language model gave."""


@dataclass(frozen=True)
class Cell:
    """Some trials of one condition: what a line of a table says.

    Attributes:
        missing: Trials that have not ended.
        retried: Attempts that were thrown away (errors tried again, trials cut by a study's cap).
    """

    condition: Condition
    results: tuple[TrialRow, ...]
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
        """Money of all trials whose cost is known; None where one that did not end as an error has no known price."""
        if any(result.usd is None and result.outcome != "error" for result in self.results):
            return None
        return sum(result.usd for result in self.results if result.usd is not None)

    @property
    def usd_per_trial(self) -> float | None:
        priced = sum(result.usd is not None for result in self.results)
        return self.usd / priced if priced and self.usd is not None else None

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
        # Models by role stand as "M, ROLE=N".
        models = [_model_of(part) for part in self.condition.model.split(", ")]
        names = {*NO_VLM, "cached", "replayed"} & seen
        names |= {"offline"} if OFFLINE in models and any(result.calls for result in self.results) else set()
        names |= (
            {"simulated"} if any(name.startswith("simulated:") for name in models) or self.condition.isolate else set()
        )
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


def _model_of(part: str) -> str:
    """The model of "M" or "ROLE=M"; a model's name may hold "=" after its first ":"."""
    role, separator, name = part.partition("=")
    return name if separator and ":" not in role else part


def cell(condition: Condition, mine: Sequence[Row]) -> Cell:
    """The cell of a condition over some of its rows."""
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

    @cached_property
    def tasks(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(row.spec.task for row in self.rows))

    def cell(self, condition: Condition, task: str | None = None) -> Cell:
        """The trials of a condition: of one task, of all variations of FOLDER/, or of all tasks."""
        mine = self.by_condition.get(condition, [])
        if task is None:
            return cell(condition, mine)
        if task.endswith("/"):
            return cell(condition, [row for row in mine if row.spec.task.startswith(task)])
        return cell(condition, [row for row in mine if row.spec.task == task])

    @cached_property
    def by_condition(self) -> Mapping[Condition, list[Row]]:
        """Rows by condition, in their order."""
        found: dict[Condition, list[Row]] = {}
        for row in self.rows:
            found.setdefault(row.spec.condition, []).append(row)
        return found

    def compare(self, first: Condition, second: Condition, task: str | None = None) -> Pair:
        """Two conditions on the scenes that both have scored, of one task or of all."""
        rows = [*self.by_condition.get(first, []), *self.by_condition.get(second, [])]
        return pair(first, second, rows if task is None else [row for row in rows if row.spec.task == task])

    @property
    def main(self) -> tuple[Condition, ...]:
        """What was compared on scenes as they are, nothing isolated; everything, where only such was run."""
        plain = tuple(one for one in self.compared if not (one.isolate or one.perturb))
        return plain or self.compared

    @property
    def main_bounds(self) -> tuple[Condition, ...]:
        """The controls that belong to `main`."""
        tiers = {one.perturb for one in self.main} or {one.perturb for one in self.bounds}
        return tuple(one for one in self.bounds if one.perturb in tiers)

    def variants(self) -> list[tuple[Condition, list[tuple[Condition, Pair | None]]]]:
        """What was isolated or perturbed, by the whole and plain condition it belongs to, and paired with that if it ran."""
        families: dict[Condition, list[Condition]] = {}
        conditions = (*self.compared, *self.bounds)
        for one in conditions:
            families.setdefault(replace(one, isolate="", perturb=""), []).append(one)
        found = []
        for whole, members in families.items():
            if members != [whole]:
                known = whole in members
                rest = [(one, self.compare(one, whole) if known else None) for one in members if one != whole]
                found.append((whole, [*([(whole, None)] if known else []), *rest]))
        return found

    def pairs(self, baseline: str | None = None) -> tuple[Pair, ...]:
        """Every two compared conditions of the same tier and part, or each against those of one method."""
        found = []
        for place, first in enumerate(self.compared):
            for second in self.compared[place + 1 :]:
                if (first.perturb, first.isolate) != (second.perturb, second.isolate):
                    continue
                if baseline is None:
                    found.append(self.compare(first, second))
                elif second.method == baseline and first.method != baseline:
                    found.append(self.compare(first, second))
                elif first.method == baseline and second.method != baseline:
                    found.append(self.compare(second, first))
        return tuple(found)

    def stages(self, condition: Condition) -> Counter[str]:
        """Failures of a condition by stage."""
        return Counter(
            row.result.stage or "unknown"
            for row in self.by_condition.get(condition, [])
            if row.result is not None and row.result.outcome == "failure"
        )

    def headline(self, baseline: str | None = None) -> list[str]:
        """The answer, one sentence per comparison that was asked for."""
        main = set(self.main)
        pairs = [one for one in self.pairs(baseline) if one.first in main]
        if len(pairs) > SENTENCES and baseline is None:
            tasks = {frozenset(row.spec.task for row in self.rows if row.spec.condition == one) for one in self.main}
            if len(tasks) > 1:
                lead = f"{len(self.main)} were run, not all on the same tasks: none of them is the best of all."
                most = sorted((one for one in pairs if one.n), key=lambda one: -one.n)
                return [lead, *(one.sentence() for one in most[:SENTENCES])]
            best = max(self.main, key=lambda one: self.cell(one).rate.share or 0.0)
            as_good = sum(self.cell(one).rate.share == self.cell(best).rate.share for one in self.main) - 1
            others = f", and {as_good} others succeed as often" if as_good else ""
            lead = f"Of {len(self.main)} compared, {best.label} succeeds most often: {self.cell(best).rate}{others}."
            against = [one.sentence() for one in pairs if best in (one.first, one.second)]
            return [lead, *against[:SENTENCES]]
        if pairs:
            return [one.sentence() for one in pairs[:SENTENCES]]
        if self.compared:
            return [f"{one.label}: {self.cell(one).rate}." for one in self.main[:SENTENCES]]
        return [
            "Only controls were run: no method is compared." if self.bounds else "No data: the store holds no trial."
        ]

    def warnings(self) -> list[str]:
        """What a reader must know before any figure."""
        found: list[str] = []
        for condition in (*self.compared, *self.bounds):
            found += self._errors(condition)
            whole = self.cell(condition)
            if whole.missing:
                found.append(f"{condition.label}: not ended yet: {counted(whole.missing, 'trial')}")
        found += _origins([self.cell(one) for one in self.compared])
        development = sorted(
            {row.spec.seed for row in self.rows if row.spec.seed < DEVELOPMENT_BELOW and not is_photo(row.spec.task)}
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
            and not all(is_photo(task) or is_toy(task) for task in self.tasks)
        ):
            found.append("controls were refused: nothing here shows that the scorers can tell success from failure")
        return found

    def _errors(self, condition: Condition) -> list[str]:
        """One line for all tasks of a condition whose trials were errors too often."""
        cells = ((task, self.cell(condition, task)) for task in self.tasks)
        many = [(task, one) for task, one in cells if one.error_share > TOO_MANY_ERRORS]
        if not many:
            return []
        listed = ", ".join(f"{task} {one.count('error')} of {len(one.results)}" for task, one in many)
        return [
            f"{condition.label}: more than {100 * TOO_MANY_ERRORS:.0f} % of the trials are errors in {listed}: "
            "not scored; --retry-errors runs them again"
        ]

    def _control_faults(self, task: str) -> list[str]:
        """What the controls say against a task, tier by tier: a tier may make a scene that nobody can solve."""
        counts: dict[str, dict[str, tuple[int, int]]] = {}
        for condition in self.bounds:
            if condition.method in CONTROLS:
                rate = self.cell(condition, task).rate
                counts.setdefault(condition.perturb, {})[condition.method] = (rate.successes, rate.n)
        return [f"{tier}: {text}" if tier else text for tier, mine in counts.items() for text in control_faults(mine)]

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


_SAYS = {
    "CACHED": "some answers were kept from earlier runs; their seconds and cost are not new",
    "REPLAYED": "some answers were read from records",
}


def _origins(cells: Sequence[Cell]) -> list[str]:
    """What a reader must know of where the answers of compared conditions came from, a line for each kind."""
    found: dict[str, list[str]] = {}
    for whole in cells:
        stand_ins = [badge for badge in whole.badges if badge.lower() in NO_VLM]
        if stand_ins:
            part = "some of the" if ", " in whole.condition.model or whole.condition.isolate else "the"
            text = f"{', '.join(stand_ins)}: {part} answers say nothing about a vision-language model"
            found.setdefault(text, []).append(whole.condition.label)
        for badge in whole.badges:
            if badge in _SAYS:
                found.setdefault(f"{badge}: {_SAYS[badge]}", []).append(whole.condition.label)
    every = len(cells)
    return [
        f"{text} ({'all that was compared' if len(labels) == every > LISTED else '; '.join(labels)})"
        for text, labels in found.items()
    ]


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
