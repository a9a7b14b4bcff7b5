"""DescribePictures, WriteProgram and JudgeFromBoxes: what a text-only planner is told and asked, answered from truth.

No picture comes with these questions. As for a plan from a list, the plan is the one that truth asks for now; where things are is
what a detector tells the program, of several that it finds of a name the one nearest to the truth; as often as the profile says, another thing is
named. What the detector does not find, this model cannot move.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from wonderful_team.contracts import (
    DescribePictures,
    JudgeFromBoxes,
    PictureWords,
    Program,
    ProgramMove,
    Reference,
    ShownTask,
    SlotDescription,
    TaskVerdict,
    WriteProgram,
    program_for,
)
from wonderful_team.contracts.shown import ShownSlot
from wonderful_team.errors import NotFoundError, NotUnderstoodError
from wonderful_team.simulated.context import Context
from wonderful_team.simulated.draft import Meaning, Written
from wonderful_team.simulated.listing import check_told, main_of, slot_words
from wonderful_team.simulated.places import place_of, point_of
from wonderful_team.simulated.plan import moves_of
from wonderful_team.simulated.seeing import Seen


def answer_describe_pictures(context: Context, question: DescribePictures) -> PictureWords:
    """What each picture really shows."""

    def said(slot: ShownSlot) -> SlotDescription:
        return SlotDescription(picture=slot.name, words=slot_words(context, slot))

    return PictureWords(pictures=[said(slot) for slot in question.slots])


def answer_write_program(context: Context, question: WriteProgram) -> Program:
    """The moves that truth asks for, as a program.

    Raises:
        NotUnderstoodError: What the plan needs of the instruction's pictures is not told.
        NotFoundError: The detector found nothing of a thing, or refuses its words.
    """
    check_found(question)
    context.check_words(ShownTask(question.instruction, ()))
    seen = main_of(context, question.picture, question.size_px)
    plan, _ = context.plans(seen)
    by_words = question.has("execute_trajectory")
    if by_words:
        check_told(context, question.slot_words)
    shown = None if by_words else context.shown(context.things(seen))
    moves = [_move(context, step, plan, seen, shown) for step in plan.steps]
    return program_for(question, moves, f"{len(moves)} moves lead from this table to what is asked.")


def check_found(question: WriteProgram) -> None:
    """Raises NotFoundError where the last program found nothing of a name, or failed: this model would write it again."""
    if not question.rounds:
        return
    said = question.rounds[-1].said
    missing = re.search(r"^0 found: (.+) \[\]$", said, re.MULTILINE)
    if missing:
        raise NotFoundError(f"the detector finds no {missing.group(1)}")
    if said.startswith("error: "):
        raise NotFoundError(f"the last program failed: {said.removeprefix('error: ').splitlines()[0]}")


def _move(
    context: Context, step: dict[str, object], plan: Written, seen: Seen, shown: Mapping[str, str] | None
) -> ProgramMove:
    """One step as a move; `shown` names the picture of the instruction that shows a thing, for programs that can look by it."""

    def reference(name: object) -> Reference:
        meaning = plan.meanings[str(name)]
        if shown is not None and meaning.thing is not None and meaning.thing in shown:
            return Reference(f"{{{shown[meaning.thing]}}}")
        if shown is not None and meaning.thing is None and meaning.slots and step["kind"] != "push":
            return Reference(shown_in=meaning.slots[0])
        return _reference(context, meaning, seen, nearest=shown is None)

    pushed = step["kind"] == "push"
    place = step["end"] if pushed else step["place"]
    thing = step["start"]["target"] if pushed else step["pick"]  # type: ignore[index]
    assert isinstance(place, dict)
    turn = step.get("rotate_deg", 0.0)
    assert isinstance(turn, float | int)
    return ProgramMove(
        reference(thing), reference(place["target"]), float(turn), pushed=pushed, origin=place["how"] == "origin"
    )


def _reference(context: Context, meaning: Meaning, seen: Seen, nearest: bool) -> Reference:
    if meaning.thing is not None:
        name = context.taken_for(meaning.thing, seen)
        thing = seen.thing(name)
        return Reference(name if thing is None else thing.words, near=seen.position(name) if nearest else None)
    place = place_of(meaning, seen)
    if place is None:
        raise NotUnderstoodError("a place lies outside of the view")
    return Reference(spot=point_of(place, "place", seen))


def answer_judge_from_boxes(context: Context, question: JudgeFromBoxes) -> TaskVerdict:
    """Completed when truth has nothing left to do and no box speaks against it."""
    context.check_words(ShownTask(question.instruction, ()))
    seen = main_of(context, question.picture, question.size_px)
    left = moves_of(context.truth.oracle(), context.truth, context.instruction)
    lost = _not_found(question, seen)
    completed = not lost and (context.truth.score().success is True or not left)
    if context.sampler is not None and context.sampler.draws(context.profile.overlooks, "boxes"):
        completed = not completed
    words = {name: thing.words for name, thing in context.truth.things().items()}
    open_ones = ", ".join(dict.fromkeys(words.get(move.thing, move.thing) for move in left)) or "the goal"
    missed = f"not found where it could be: {', '.join(lost)}" if lost else f"not where it should be: {open_ones}"
    summary = "" if completed else missed
    return TaskVerdict(reasoning=summary or "everything is where it should be", completed=completed, summary=summary)


def _not_found(question: JudgeFromBoxes, seen: Seen) -> list[str]:
    """Names of things that show, and whose boxes after the motions all lie elsewhere.

    A thing that has no box any more while others have one may be out of the detector's sight where it was put, as in a container;
    where nothing has one, nobody can say where anything is.
    """
    lost = []
    for name in dict.fromkeys(one.name for one in (*question.before, *question.after)):
        boxes = [seen.box(key) for key in seen.names if (thing := seen.thing(key)) is not None and thing.words == name]
        true = [box for box in boxes if box is not None]
        found = [(float(one.x), float(one.y)) for one in question.after if one.name == name]
        nowhere = not found and question.after
        if true and not nowhere and not any(box.contains(point) for box in true for point in found):
            lost.append(name)
    return lost
