"""What the page of a study says, part by part: figures become words, links and thumbnails; the template only lays them out."""

from __future__ import annotations

import os
import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

from markupsafe import Markup

from wonderful_team.core.text import counted
from wonderful_team.errors import MissingExtraError
from wonderful_team.evals.ablation import Ablation, ablations, ends_of
from wonderful_team.evals.again import command_again
from wonderful_team.evals.pairing import Pair
from wonderful_team.evals.paper import published
from wonderful_team.evals.report import ablation, judgements, tables
from wonderful_team.evals.report.plots import cost_plot, ends_plot, rate_plot, task_plot
from wonderful_team.evals.summary import Summary
from wonderful_team.evals.trials import Condition, Row
from wonderful_team.images.thumbnail import run_thumbnail

EXAMPLES = 3
GALLERY = 24
LONGEST_REASON = 90
"""Characters of a reason below a picture."""
MOST_OPEN = 12
"""So many pairs are written out one below the other; more are folded up."""
MOST_LINES = 40
"""So many lines of what was measured beside success; more are folded up."""


def page_content(summary: Summary, warnings: Sequence[str], baseline: str | None, page: Path) -> dict[str, Any]:
    """Everything that the template names but stores and files."""
    head, lines = tables.task_table(summary)
    every = summary.pairs(baseline)
    pairs = [one for one in every if one.n] or every
    return {
        "summary": summary,
        "runs_words": runs_words(summary),
        "answer": summary.headline(baseline),
        "warnings": warnings,
        "head": tables.HEAD,
        "compared": [tables.cell_words(summary.cell(one)) for one in summary.main],
        "bounds": [tables.cell_words(summary.cell(one)) for one in summary.main_bounds],
        "plots": _plots(summary),
        "ends_plot": _ends_plot(summary.main, {one: ends_of(summary, one) for one in summary.main}),
        "effect_head": ablation.EFFECT_HEAD,
        "moved_head": ablation.MOVED_HEAD,
        "ablations": [_ablation(one) for one in ablations(summary)],
        "task_head": head,
        "task_lines": lines,
        "paper": published(),
        "with_paper": any(name.startswith("paper (") for name in head),
        "pair_head": tables.PAIR_HEAD,
        "pair_task_head": tables.PAIR_TASK_HEAD[2:],
        "pairs": _pairs(summary, pairs, page),
        "apart": len(every) - len(pairs),
        "most_open": MOST_OPEN,
        "most_lines": MOST_LINES,
        "stages": _stage_table(summary),
        "failures": [_failures(one, summary, page) for one in summary.compared],
        "variant_head": tables.VARIANT_HEAD,
        "variants": [
            (whole.label, [tables.variant_words(summary.cell(one), against) for one, against in members])
            for whole, members in summary.variants()
        ],
        "facts": tables.fact_tables(summary),
        "judged_title": tables.JUDGEMENTS,
        "judged_head": judgements.HEAD,
        "judged": judgements.lines(summary),
        "gallery": _gallery(summary, page),
        "versions": sorted({f"{k} {v}" for row in summary.rows if row.result for k, v in row.result.versions.items()}),
    }


def runs_words(summary: Summary) -> str:
    """How often each task was really run by each method and model: seeds times repeats."""
    runs: dict[tuple[str, Condition], set[tuple[int, int]]] = {}
    for row in summary.rows:
        if row.spec.condition in summary.compared:
            runs.setdefault((row.spec.task, row.spec.condition), set()).add((row.spec.seed, row.spec.repeat))
    counts = sorted({len(found) for found in runs.values()})
    if not counts:
        return "no trial of a method"
    span = counted(counts[0], "run") if len(counts) == 1 else f"{counts[0]} to {counted(counts[-1], 'run')}"
    return f"{span} a task for each method and model"


def _plots(summary: Summary) -> dict[str, Any]:
    if not any(summary.cell(one).rate.n for one in (*summary.compared, *summary.bounds)):
        return {"missing": "no scored trial: nothing to plot"}
    try:
        # Made by matplotlib from our own figures: labels are escaped by it.
        made = {"rates": rate_plot(summary), "costs": cost_plot(summary), "tasks": task_plot(summary)}
        return {name: Markup(text) for name, text in made.items() if text}  # noqa: S704
    except MissingExtraError as error:
        return {"missing": str(error)}


def _ends_plot(conditions: Sequence[Condition], ends: Mapping[Condition, Counter[str]]) -> Markup | str:
    try:
        return Markup(ends_plot(conditions, ends))  # noqa: S704  matplotlib escapes labels
    except MissingExtraError:
        return ""


def _ablation(found: Ablation) -> dict[str, Any]:
    """What each member adds, and where failures move."""
    end_head, end_lines = ablation.end_lines(found)
    task_head, task_lines = ablation.task_effects(found)
    return {
        "label": found.base.label,
        "effects": ablation.effect_lines(found),
        "plot": _ends_plot(found.conditions, found.ends),
        "on": "all that was run, as no scene is common to all of them"
        if found.shared is None
        else f"the {counted(found.shared, 'scene')} that all of them ended",
        "end_head": end_head,
        "end_lines": end_lines,
        "moved": ablation.moved_lines(found),
        "task_head": task_head,
        "task_lines": task_lines,
    }


def _stage_table(summary: Summary) -> dict[str, Any]:
    """How often each compared condition failed at each stage."""
    counts = {one: summary.stages(one) for one in summary.compared}
    names = sorted({stage for one in counts.values() for stage in one}, key=_place)
    lines = [(one.label, [found.get(name, 0) for name in names], sum(found.values())) for one, found in counts.items()]
    return {"names": names, "lines": lines}


_ORDER = (
    "draft",
    "plan",
    "checked",
    "grounding",
    "crash",
    "wrong object",
    "actions",
    "gate",
    "execution",
    "replan",
    "budget",
)


def _place(stage: str) -> tuple[int, str]:
    """Stages in the order in which a trial passes them; others after."""
    return (_ORDER.index(stage) if stage in _ORDER else len(_ORDER), stage)


def _pairs(summary: Summary, pairs: Sequence[Pair], page: Path) -> list[dict[str, Any]]:
    # For all pairs at once: there is one for every two conditions, and each may name every trial.
    pages = {
        (row.spec.condition, row.spec.task, row.spec.seed, row.spec.repeat): link(row.result.page, page)
        for row in summary.rows
        if row.result is not None and row.result.page
    }
    return [_pair(one, summary, pages) for one in pairs]


def _pair(one: Pair, summary: Summary, pages: Mapping[tuple[Condition, str, int, int], str]) -> dict[str, Any]:
    listed = [
        {
            "scene": f"{task}#{seed}" + (f" repeat {repeat}" if repeat else ""),
            "won": (one.first if won == "first" else one.second).label,
            "pages": [
                (side.label, pages[side, task, seed, repeat])
                for side in (one.first, one.second)
                if (side, task, seed, repeat) in pages
            ],
        }
        for (task, seed, repeat), won in one.discordant
    ]
    return {
        "pair": one,
        "words": tables.pair_words(one),
        "tasks": [line[2:] for line in tables.pair_tasks(summary, one)],
        "discordant": listed,
    }


def _failures(one: Condition, summary: Summary, page: Path) -> dict[str, Any]:
    stages = []
    for stage, count in summary.stages(one).most_common():
        examples = [
            {
                "scene": row.spec.scene,
                "reason": row.result.reason,
                "page": link(row.result.page, page),
                "again": _again(row),
            }
            for row in summary.rows
            if row.spec.condition == one
            and row.result is not None
            and row.result.outcome == "failure"
            and (row.result.stage or "unknown") == stage
        ]
        stages.append({"stage": stage, "count": count, "examples": examples[:EXAMPLES]})
    errors = [
        {"scene": row.spec.scene, "reason": row.result.reason, "page": link(row.result.page, page)}
        for row in summary.rows
        if row.spec.condition == one and row.result is not None and row.result.outcome == "error"
    ]
    return {"label": one.label, "stages": stages, "errors": errors[:EXAMPLES], "error_count": len(errors)}


def _again(row: Row) -> str:
    """How to get a record that was not kept; "" where it was."""
    return "" if row.result is not None and row.result.page else command_again(row.spec)


def _gallery(summary: Summary, page: Path) -> list[dict[str, Any]]:
    """Trials with a page: of every condition and outcome in turn, so that none crowds out the others."""
    groups: dict[tuple[Condition, str], list[Row]] = {}
    for row in summary.rows:
        if row.result is not None and row.result.page:
            groups.setdefault((row.spec.condition, row.result.outcome), []).append(row)
    turns = [row for turn in zip_longest(*groups.values()) for row in turn if row is not None]
    return [
        {
            "page": link(row.result.page, page),
            "picture": run_thumbnail(Path(row.result.page).parent),
            "scene": row.spec.scene,
            "label": row.spec.condition.label,
            "outcome": row.result.outcome,
            "stage": f"at {row.result.stage}" if row.result.stage else "",
            "reason": textwrap.shorten(row.result.reason, LONGEST_REASON, placeholder=" …"),
        }
        for row in turns[:GALLERY]
        if row.result is not None
    ]


def link(target: str, page: Path) -> str:
    """A link from the page's folder; "" for nothing."""
    if not target:
        return ""
    relative = Path(os.path.relpath(Path(target).absolute(), page.parent.absolute())).as_posix()
    # A store of unknown origin may name a page "javascript:…".
    return f"./{relative}" if ":" in relative.partition("/")[0] else relative
