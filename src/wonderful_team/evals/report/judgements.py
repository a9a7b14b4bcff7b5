"""How right a method's judgement of its own actions was: the confusion matrix against the simulator's truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from wonderful_team.core.intervals import Rate
from wonderful_team.evals.summary import Summary
from wonderful_team.evals.trials import JUDGED, JUDGED_SUBGOAL, TrialRow

HEAD = (
    "method · model", "judgements", "done, rightly", "done, wrongly", "not done, rightly", "not done, wrongly",
    "truth not known", "of what was not done, seen", "of what was done, doubted",
)  # fmt: skip
AFTER_SUBGOAL = "after a subgoal"


def lines(summary: Summary) -> list[tuple[str, ...]]:
    """For each condition that judged anything a line of whole attempts, and one of single subgoals: counts, then two rates with n and
    95 % interval. What truth says nothing of stands beside and counts in no rate.

    Judgements of one trial are not independent, so the intervals are somewhat narrow where trials are judged several times.
    """
    told = []
    for condition in summary.compared:
        results = summary.cell(condition).results
        for names, label in ((JUDGED, condition.label), (JUDGED_SUBGOAL, f"{condition.label} · {AFTER_SUBGOAL}")):
            line = _line(label, results, names)
            told += [line] if line is not None else []
    return told


def _line(
    label: str,
    results: Sequence[TrialRow],
    names: Mapping[tuple[bool, bool], str] | Mapping[tuple[bool, bool | None], str],
) -> tuple[str, ...] | None:
    count = {key: round(sum(result.facts.get(name, 0.0) for result in results)) for key, name in names.items()}
    if not any(count.values()):
        return None
    known = [count[key] for key in JUDGED]
    unknown = sum(count.values()) - sum(known)
    missed, alarms = count[True, False], count[False, True]
    seen = Rate(count[False, False], count[False, False] + missed)
    doubted = Rate(alarms, count[True, True] + alarms)
    return (label, str(sum(count.values())), *map(str, known), str(unknown), str(seen), str(doubted))
