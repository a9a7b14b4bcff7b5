"""What a report says of members left out: what each adds, and where failures move, as words and as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from wonderful_team.evals.ablation import Ablation, Effect, ends_of, ends_seen
from wonderful_team.evals.pairing import Pair
from wonderful_team.evals.report.paired import paired_figures
from wonderful_team.evals.summary import Summary

EFFECT_HEAD = ("member", "with", "without", "adds [points]", "95 %", "exact p", "pairs", "only with", "only without")


def effect_lines(ablation: Ablation) -> list[tuple[str, ...]]:
    """What each member adds, in the order of EFFECT_HEAD."""
    lines = []
    for one in ablation.effects:
        lines.append((one.label, one.pair.first.method, one.pair.second.method, *paired_figures(one.pair)))
    return lines


def task_effects(ablation: Ablation) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """What each member adds, task by task: points and pairs."""
    tasks = tuple(ablation.effects[0].by_task)
    head = ("member", "with", "without", *(task.removeprefix("tabletop/") for task in tasks))
    lines = []
    for one in ablation.effects:
        cells = (_points(one.by_task[task]) for task in tasks)
        lines.append((one.label, one.pair.first.method, one.pair.second.method, *cells))
    return head, lines


def _points(pair: Pair) -> str:
    return "no data" if pair.difference is None else f"{100 * pair.difference:+.0f} (n = {pair.n})"


def end_lines(ablation: Ablation) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """How the trials of each condition ended; in brackets the change against the most complete team."""
    columns = ends_seen(list(ablation.ends.values()))
    whole = ablation.ends[ablation.conditions[0]]
    lines = []
    for place, one in enumerate(ablation.conditions):
        mine = ablation.ends[one]
        cells = [str(mine[end]) + (f" ({mine[end] - whole[end]:+d})" if place else "") for end in columns]
        lines.append((one.method, *cells, str(sum(mine.values()))))
    return ("trials that ended as", *columns, "all"), lines


def moved_words(effect: Effect) -> str:
    """Where scenes went when the members were left out."""
    moves = [f"{before} → {after}: {count}" for (before, after), count in effect.moved.items()]
    return "; ".join([*moves, f"as before: {effect.kept}"])


MOVED_HEAD = ("left out", "from", "to", "scored scenes: how they ended with, and without")


def moved_lines(ablation: Ablation) -> list[tuple[str, ...]]:
    """Where the failures moved, in the order of MOVED_HEAD."""
    return [(one.label, one.pair.first.method, one.pair.second.method, moved_words(one)) for one in ablation.effects]


def effects_csv(found: Sequence[Ablation]) -> str:
    """A line for each effect, over all tasks ("all") and task by task."""
    head = (
        "team",
        "members",
        "with",
        "without",
        "task",
        "adds",
        "low",
        "high",
        "p",
        "pairs",
        "only_with",
        "only_without",
    )
    lines: list[tuple[object, ...]] = [head]
    for one in found:
        for effect in one.effects:
            for task, pair in (("all", effect.pair), *effect.by_task.items()):
                low, high = pair.interval or ("", "")
                figures = (
                    "" if pair.difference is None else pair.difference,
                    low,
                    high,
                    "" if pair.p is None else pair.p,
                )
                named = (one.base.label, " ".join(effect.members), pair.first.method, pair.second.method, task)
                lines.append((*named, *figures, pair.n, pair.only_first, pair.only_second))
    return _csv(lines)


def ends_csv(summary: Summary, found: Sequence[Ablation]) -> str:
    """How often the trials of each task and condition ended how: a line for each."""
    lines: list[tuple[object, ...]] = [("team", "method", "model", "task", "end", "trials")]
    for one in found:
        for condition in one.conditions:
            for task in summary.tasks:
                mine = ends_of(summary, condition, task)
                lines += [
                    (one.base.label, condition.method, condition.model, task, end, mine[end])
                    for end in ends_seen(list(one.ends.values()))
                ]
    return _csv(lines)


def _csv(lines: Sequence[Sequence[object]]) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(lines)
    return out.getvalue()
