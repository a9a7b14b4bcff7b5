"""A plan in words: subgoals, targets and steps, written from the moves that truth asks for.

Written anew for every question, from the same truth: whoever asks about a target by its words gets the same thing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from wonderful_team.contracts import MoveDraft, SubgoalDraft, TargetDraft
from wonderful_team.core.values import PointRole, Subgoal, Target
from wonderful_team.simulated.plan import Move, Put, Shove, Spot, Trace

Key = tuple[str, str, tuple[str, ...]]
"""What a target is known by: its words, where it is, and the pictures that it is like."""
ROOM_M = 0.02
"""How much longer and wider a place is than what the thing that goes there covers [m]."""
ROOM_FOR_PUSHED_M = 0.05
"""Side of the area that a thing is pushed to [m]."""


@dataclass(frozen=True)
class Meaning:
    """What a target means.

    Attributes:
        thing: Name of the thing; None for an area.
        at_m: Middle of the area; None for a thing.
        sides_m: Sides of the area, along x and y [m].
        on: What the area is a part of, such as an open box; None for the table.
        slots: Pictures of the instruction that must be seen to know it.
    """

    thing: str | None = None
    at_m: tuple[float, float] | None = None
    sides_m: tuple[float, float] = (0.1, 0.1)
    on: str | None = None
    slots: tuple[str, ...] = ()


@dataclass(frozen=True)
class Names:
    """What things are called.

    Attributes:
        words: Unique words for every thing.
        shown: The picture of the instruction that shows a thing alone, by the thing's name.
    """

    words: Mapping[str, str]
    shown: Mapping[str, str] = field(default_factory=dict)

    def of(self, name: str) -> str:
        return self.words[name]


@dataclass
class Written:
    """A plan as this model writes it, and what its targets mean.

    Attributes:
        steps: As `StepList` takes them, targets by their own ids.
        paths: What the helper function of a subgoal has to lead over, by the subgoal's text.
    """

    subgoals: list[SubgoalDraft] = field(default_factory=list)
    targets: list[TargetDraft] = field(default_factory=list)
    steps: list[dict[str, Any]] = field(default_factory=list)
    meanings: dict[str, Meaning] = field(default_factory=dict)
    paths: dict[str, Trace] = field(default_factory=dict)

    def target(self, kind: str, words: str, meaning: Meaning, role: PointRole | None, where: str = "") -> str:
        """The id of a target, written when it is first needed."""
        like = meaning.slots
        for draft in self.targets:
            if (draft.words, draft.where, tuple(draft.like)) == (words, where, like):
                break
        else:
            draft = TargetDraft.model_validate(
                {"id": f"T{len(self.targets) + 1}", "kind": kind, "words": words, "part": None, "where": where,
                 "like": list(like), "alike": "both", "use": []}
            )  # fmt: skip
            self.targets.append(draft)
            self.meanings[draft.id] = meaning
        if role is not None and role not in draft.use:
            position = self.targets.index(draft)
            self.targets[position] = draft.model_copy(update={"use": [*draft.use, role]})
        return draft.id

    def meant_by(self, target: Target) -> Meaning | None:
        """What one of this plan's targets means, by its words; None for another's words."""
        for draft in self.targets:
            if key_of(draft.to_target()) == key_of(target):
                return self.meanings[draft.id]
        return None

    def is_plan(self, subgoals: Sequence[Subgoal]) -> bool:
        """Whether these are this plan's subgoals."""
        return [subgoal.text for subgoal in subgoals] == [draft.text for draft in self.subgoals]


def key_of(target: Target) -> Key:
    """What a target is known by."""
    return target.words, target.where, tuple(target.like)


def write(moves: Sequence[Move], words: Names) -> Written:
    """A plan for these moves.

    Args:
        moves: In order.
        words: What things are called.
    """
    plan = Written()
    spots = 0
    for number, move in enumerate(moves, start=1):
        subgoal = f"G{number}"
        function = None
        if isinstance(move, Shove):
            text, targets, step = _push(plan, move, words, number)
        elif isinstance(move, Trace):
            text, targets, function = _trace(plan, move, words)
            step = {"kind": "follow", "function": subgoal, "contact": "surface"}
            plan.paths[text] = move
        else:
            spots += move.to.how == "spot"
            text, targets, step = _put(plan, move, words, spots)
            if not move.plain:
                text, function = _handled(plan, move, text, words, step, subgoal)
        after = [f"G{number - 1}"] if number > 1 else []
        plain = isinstance(move, Put) and move.plain
        moved = None if not plain else {name: step[name] for name in MoveDraft.model_fields}
        plan.subgoals.append(
            SubgoalDraft.model_validate(
                {"id": subgoal, "text": text, "after": after, "targets": targets, "function": function, "move": moved}
            )
        )
        plan.steps.append({"subgoal": subgoal, **step})
    return plan


def _put(plan: Written, move: Put, words: Names, spots: int) -> tuple[str, list[str], dict[str, Any]]:
    name = words.of(move.thing)
    thing = plan.target("object", name, Meaning(move.thing), "pick")
    turned = f", turned {move.rotate_deg:g} degrees clockwise" if move.rotate_deg else ""
    if move.to.how in ("self", "origin"):
        place = {"target": thing, "how": "origin", "side": None}
        text = f"turn the {name} by {move.rotate_deg:g} degrees clockwise"
        if move.to.how == "origin":
            text, turned = f"put the {name} back to where it stood{turned}", ""
        targets = [thing]
    else:
        there, said = _place(plan, move, words, spots)
        place = {"target": there, "how": "at", "side": None}
        text, targets = f"put the {name} {said}{turned}", [thing, there]
    return text, targets, {"kind": "pick_place", "pick": thing, "place": place, "rotate_deg": move.rotate_deg}


def _handled(
    plan: Written, move: Put, text: str, words: Names, step: dict[str, Any], subgoal: str
) -> tuple[str, str | None]:
    """Words for a move of a thing that is turned in place or moved about in the air as well, and what its function is to compute."""
    name, function = words.of(move.thing), None
    step |= {"tight": move.tight, "twist_deg": move.twist_deg}
    if move.twist_deg:
        way = "clockwise" if move.twist_deg > 0 else "anticlockwise"
        text = f"turn the {name} by {abs(move.twist_deg):g} degrees {way} where it is, then {text}"
    if move.path_m:
        text = f"lift the {name}, move it along a path of {len(move.path_m)} points in the air, then {text}"
        function = f"the {len(move.path_m)} points of the path in the air over the {name}, with how far up each is"
        step["function"] = subgoal
        flat = tuple((x, y) for x, y, _ in move.path_m)
        plan.paths[text] = Trace(move.thing, flat, tuple(up for _, _, up in move.path_m))
    return text, function


def _place(plan: Written, move: Put, words: Names, spots: int) -> tuple[str, str]:
    """The target that something is put at, and words for going there."""
    to, name = move.to, words.of(move.thing)
    if to.how == "thing" and to.thing is not None:
        return plan.target(
            "object", words.of(to.thing), Meaning(to.thing), "place"
        ), f"into or onto the {words.of(to.thing)}"
    sides = (move.covers_m[0] + ROOM_M, move.covers_m[1] + ROOM_M)
    if to.how == "slot" and to.slot is not None:
        meaning = Meaning(at_m=to.at_m, sides_m=sides, slots=(to.slot,))
        said = f"to its place in {{{to.slot}}}"
        return plan.target("area", f"place of the {name} in {{{to.slot}}}", meaning, "place"), said
    meaning = Meaning(at_m=to.at_m, sides_m=sides, on=to.thing)
    if to.how == "start":
        return plan.target("area", f"place where the {name} stood at the very start", meaning, "place"), (
            "back to where it stood at the very start"
        )
    return _free(plan, to, words, meaning, name, spots)


def _free(plan: Written, to: Spot, words: Names, meaning: Meaning, name: str, spots: int) -> tuple[str, str]:
    where = f"on the {words.of(to.thing)}" if to.thing is not None else ""
    # The same words must not mean two places.
    where += f"; move {spots}" if spots > 1 else ""
    said = "free area" if spots == 1 else f"free area for the {name}"
    lies = f" in or on the {words.of(to.thing)}" if to.thing is not None else ""
    return plan.target("area", said, meaning, "place", where), f"to a free area{lies}"


def _trace(plan: Written, move: Trace, words: Names) -> tuple[str, list[str], str]:
    """A subgoal that needs a path: its words, its target, and what the function is to compute."""
    name = words.of(move.thing)
    there = plan.target("object", name, Meaning(move.thing), "place")
    text = f"lead the tool over the {name} along a path of {len(move.path_m)} points"
    return text, [there], f"the {len(move.path_m)} points of the path on the {name}, from its box"


def _push(plan: Written, move: Shove, words: Names, number: int) -> tuple[str, list[str], dict[str, Any]]:
    name = words.of(move.thing)
    thing = plan.target("object", name, Meaning(move.thing), "pick")
    parts, slots = [], list[str]()
    for said, other in (("inside", move.into), *(("clear of", one) for one in move.clear_of)):
        if other is not None:
            shown = words.shown.get(other)
            parts.append(
                f"{said} the {words.of(other)}" if shown is None else f"{said} the object shown in {{{shown}}}"
            )
            slots += [] if shown is None else [shown]
    earlier = sum(draft.words.endswith(f"for the {name}") for draft in plan.targets)
    parts += [f"push {earlier + 1}"] if earlier else []
    meaning = Meaning(at_m=move.to_m, sides_m=(ROOM_FOR_PUSHED_M, ROOM_FOR_PUSHED_M), slots=tuple(slots))
    there = plan.target("area", f"free area for the {name}", meaning, "place", "; ".join(parts))
    step = {
        "kind": "push",
        "start": {"target": thing, "how": "at", "side": None},
        "end": {"target": there, "how": "at", "side": None},
    }
    into = f" into the {words.of(move.into)}" if move.into is not None else " to a free area on the way"
    return f"push the {name}{into}, push {number}", [thing, there], step
