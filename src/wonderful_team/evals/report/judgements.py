"""How right a method's judgement of its own actions was: the confusion matrix against the simulator's truth."""

from __future__ import annotations

from wonderful_team.core.intervals import Rate
from wonderful_team.evals.summary import Summary
from wonderful_team.evals.trials import JUDGED

HEAD = (
    "method · model", "judgements", "done, rightly", "done, wrongly", "not done, rightly", "not done, wrongly",
    "of what was not done, seen", "of what was done, doubted",
)  # fmt: skip


def lines(summary: Summary) -> list[tuple[str, ...]]:
    """A line for each condition that judged anything: counts, then two rates with n and 95 % interval.

    Judgements of one trial are not independent, so the intervals are somewhat narrow where trials are judged several times.
    """
    told = []
    for condition in summary.compared:
        results = summary.cell(condition).results
        count = {key: round(sum(result.facts.get(name, 0.0) for result in results)) for key, name in JUDGED.items()}
        if not any(count.values()):
            continue
        missed, alarms = count[True, False], count[False, True]
        seen = Rate(count[False, False], count[False, False] + missed)
        doubted = Rate(alarms, count[True, True] + alarms)
        told.append((condition.label, str(sum(count.values())), *map(str, count.values()), str(seen), str(doubted)))
    return told
