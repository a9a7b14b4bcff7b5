"""What each member of the team is worth, and where failures move when it is left out: conditions that differ in members alone, paired."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from wonderful_team.evals.pairing import Pair, Scene
from wonderful_team.evals.summary import Summary
from wonderful_team.evals.trials import Condition, Row

MEMBERS = ("verification", "manager", "checker", "mover", "memory")
_WITH_MANAGER = ("checker", "mover")
"""Who works for the Manager: without it there is nobody to check boxes or to move them."""
SETTINGS: Mapping[str, frozenset[str]] = {
    "s1": frozenset({"verification"}),
    "s2": frozenset({"checker"}),
    "s3": frozenset({"verification", "checker"}),
    "s4": frozenset({"checker", "mover"}),
    "s5": frozenset({"verification", "checker", "mover"}),
    "s6": frozenset({"manager", "checker", "mover"}),
    "s7": frozenset({"verification", "manager", "checker", "mover"}),
    "s8": frozenset({"memory"}),
}
"""Whom the paper's settings leave out."""
BASES = ("team", "team:paper")
EACH = tuple(f"-{name}" for name in MEMBERS)
"""Each member left out alone."""

SUCCESS, NOT_SCORED = "success", "not scored"
FAMILIES: Mapping[str, frozenset[str]] = {
    "planning": frozenset({"draft", "plan", "checked", "actions", "gate", "replan", "clarification", "function"}),
    "grounding": frozenset({"grounding", "wrong object"}),
    "execution": frozenset({"execution", "world"}),
    "crash": frozenset({"crash", "code", "method"}),
}
"""The taxonomy of failures: what stages of a trial belong together. A crash is code that broke, the method's own or what a model wrote."""
ENDS = (SUCCESS, *FAMILIES)


def end_of(row: Row) -> str | None:
    """How a trial ended: success, a family of failures, its own stage where that belongs to none; None while it has not ended."""
    result = row.result
    if result is None:
        return None
    if result.outcome == "success":
        return SUCCESS
    if result.outcome != "failure":
        return NOT_SCORED
    stage = result.stage or "unknown"
    return next((family for family, stages in FAMILIES.items() if stage in stages), stage)


def ends_of(summary: Summary, condition: Condition, task: str | None = None) -> Counter[str]:
    """How often the trials of a condition ended how, of one task or of all."""
    rows = summary.by_condition.get(condition, [])
    ends = (end_of(row) for row in rows if task is None or row.spec.task == task)
    return Counter(end for end in ends if end is not None)


def ends_seen(counts: Sequence[Counter[str]]) -> tuple[str, ...]:
    """The columns of a table of ends: those of the taxonomy, then what else occurred, what was not scored last."""
    others = sorted({end for one in counts for end in one if one[end]} - {*ENDS, NOT_SCORED})
    last = (NOT_SCORED,) if any(one[NOT_SCORED] for one in counts) else ()
    return (*ENDS, *others, *last)


def left_out(method: str) -> tuple[str, frozenset[str]] | None:
    """The team that a name means, and whom it leaves out; None for any other method."""
    for base in reversed(BASES):
        if method == base:
            return base, frozenset()
        if not method.startswith(f"{base}:"):
            continue
        rest = method.removeprefix(f"{base}:")
        if rest in SETTINGS:
            return base, SETTINGS[rest]
        names = rest.split("-")[1:]
        if rest.startswith("-") and names and all(name in MEMBERS for name in names):
            return base, frozenset([*names, *(_WITH_MANAGER if "manager" in names else ())])
    return None


@dataclass(frozen=True)
class Effect:
    """A member, or several, beside the same team without.

    Attributes:
        members: Who makes the difference, in their order.
        pair: First with them, second without, on the scenes that both have scored.
        moved: How scenes ended with them, and without: counts of those that ended differently.
        kept: How many ended alike.
        by_task: The same pair, task by task.
    """

    members: tuple[str, ...]
    pair: Pair
    moved: Mapping[tuple[str, str], int]
    kept: int
    by_task: Mapping[str, Pair]

    @property
    def label(self) -> str:
        """Who it is about."""
        names = [name.capitalize() for name in self.members]
        return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


@dataclass(frozen=True)
class Ablation:
    """One team with one model: as it is, and with members left out.

    Attributes:
        base: What is compared, without its members.
        conditions: All of it, the most complete team first.
        effects: A line for each member of which a pair was run; then what several are worth together, where the whole team was run.
        ends: How the trials of each condition ended, on the scenes that all of them ended; on all of its own where there are none.
        shared: How many scenes these are; None for none.
    """

    base: Condition
    conditions: tuple[Condition, ...]
    effects: tuple[Effect, ...]
    ends: Mapping[Condition, Counter[str]]
    shared: int | None


def ablations(summary: Summary) -> list[Ablation]:
    """Every team of which at least two sets of members were run with the same model."""
    families: dict[Condition, dict[frozenset[str], Condition]] = {}
    for condition in summary.compared:
        read = left_out(condition.method)
        if read is not None:
            base, off = read
            families.setdefault(replace(condition, method=base), {}).setdefault(off, condition)
    return [_ablation(summary, base, by_off) for base, by_off in families.items() if len(by_off) > 1]


def _ablation(summary: Summary, base: Condition, by_off: Mapping[frozenset[str], Condition]) -> Ablation:
    ordered = sorted(by_off, key=lambda off: (len(off), [MEMBERS.index(name) for name in sorted(off, key=_place)]))
    single, several = [], []
    for more in ordered:
        for less in ordered:
            members = tuple(sorted(less - more, key=_place))
            if not more < less:
                continue
            if len(members) == 1:
                single.append(_effect(summary, members, by_off[more], by_off[less]))
            elif not more:
                several.append(_effect(summary, members, by_off[more], by_off[less]))
    single.sort(key=lambda one: _place(one.members[0]))
    conditions = tuple(by_off[off] for off in ordered)
    found = {one: _ends_by_scene(summary, one) for one in conditions}
    shared = set.intersection(*(set(ends) for ends in found.values()))
    ends = {
        one: Counter(found[one][scene] for scene in shared) if shared else ends_of(summary, one) for one in conditions
    }
    return Ablation(base, conditions, (*single, *several), ends, len(shared) or None)


def _place(member: str) -> int:
    return MEMBERS.index(member)


def _effect(summary: Summary, members: tuple[str, ...], with_: Condition, without: Condition) -> Effect:
    first, second = _scored(_ends_by_scene(summary, with_)), _scored(_ends_by_scene(summary, without))
    shared = first.keys() & second.keys()
    moved = Counter((first[scene], second[scene]) for scene in shared if first[scene] != second[scene])
    by_task = {task: summary.compare(with_, without, task) for task in summary.tasks}
    kept = sum(first[scene] == second[scene] for scene in shared)
    return Effect(members, summary.compare(with_, without), dict(moved.most_common()), kept, by_task)


def _scored(ends: Mapping[Scene, str]) -> dict[Scene, str]:
    return {scene: end for scene, end in ends.items() if end != NOT_SCORED}


def _ends_by_scene(summary: Summary, condition: Condition) -> dict[Scene, str]:
    """How the scenes of a condition ended."""
    found = {}
    for row in summary.by_condition.get(condition, []):
        end = end_of(row)
        if end is not None:
            found[row.spec.task, row.spec.seed, row.spec.repeat] = end
    return found
