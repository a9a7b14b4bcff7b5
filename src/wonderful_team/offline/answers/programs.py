"""DescribePictures, WriteProgram and JudgeFromBoxes: a text-only planner by the grammar alone.

Nothing is seen here but the instruction's pictures, one by one, when they are to be described. So of the instruction's clauses only those
are written as programs that name one thing and carry it into or onto another, back to where it was, or turn it; every other is refused by name.
"""

from __future__ import annotations

import math
import re

from wonderful_team.contracts import (
    DescribePictures,
    FoundBox,
    JudgeFromBoxes,
    PictureWords,
    Program,
    ProgramMove,
    Reference,
    SlotDescription,
    TaskVerdict,
    WriteProgram,
    program_for,
)
from wonderful_team.errors import NotFoundError, NotUnderstoodError
from wonderful_team.offline.answers.listing import shown_words
from wonderful_team.offline.description import Description
from wonderful_team.offline.language import Command, render, understand

REACHED_SHARE = 0.75
"""A thing is in or on another when its middle is nearer to the other's than this share of half the other's length."""
ANGLE_DEG = 12.0
"""A turn is done when the angle of the box is off by less than this; a box looks the same after half a turn."""


def answer_describe_pictures(question: DescribePictures) -> PictureWords:
    """What is seen in each picture, in words that the classical detector reads."""
    return PictureWords(
        pictures=[SlotDescription(picture=slot.name, words=shown_words(slot)) for slot in question.slots]
    )


def answer_write_program(question: WriteProgram) -> Program:
    """The instruction's clauses as moves, and these as a program.

    Raises:
        NotUnderstoodError: A clause that needs eyes, or words that mean nothing.
        NotFoundError: The detector found nothing of a thing, or the last program failed: it would be written again.
    """
    if question.rounds:
        said = question.rounds[-1].said
        missing = re.search(r"^0 found: (.+) \[\]$", said, re.MULTILINE)
        if missing or said.startswith("error: "):
            why = f"finds no {missing.group(1)}" if missing else said.removeprefix("error: ").splitlines()[0]
            raise NotFoundError(f"the detector {why}" if missing else f"the last program failed: {why}")
    words = {one.slot: one.words for one in question.slot_words}
    pictured = not question.has("execute_trajectory")
    moves = [_move(command, words, pictured) for command in understand(question.instruction).commands]
    return program_for(question, moves, f"{len(moves)} clauses were read.")


def _move(command: Command, words: dict[str, str], pictured: bool) -> ProgramMove:
    thing = Reference(_query(command.thing, words, pictured))
    if command.kind == "rotate":
        return ProgramMove(thing, None, command.rotate_deg)
    to = command.to
    if command.kind == "put" and to is not None and not command.conditional:
        if to.how in ("in", "on") and to.what is not None:
            return ProgramMove(thing, Reference(_query(to.what, words, pictured)))
        if to.how == "origin":
            return ProgramMove(
                thing, thing if to.what is None else Reference(_query(to.what, words, pictured)), origin=True
            )
    where = command.kind if to is None or command.kind != "put" else f"{command.kind}, {to.how}"
    raise NotUnderstoodError(
        f"model 'offline' writes programs for things that are put into or onto others, put back, or turned; not for this: {where} "
        f"({render(command.thing)})"
    )


def _query(description: Description, words: dict[str, str], pictured: bool) -> str:
    """What a detector is asked for."""
    if description.quantity != "one" or description.placed is not None:
        raise NotUnderstoodError(f"model 'offline' sees no table here, and cannot count: {description.text!r}")
    said = render(description)
    if description.like is None and "{" not in said:
        return said
    if description.like is None or description.like_only or description.related or description.superlative:
        raise NotUnderstoodError(f"model 'offline' sees no table here, and cannot compare: {description.text!r}")
    if pictured:
        return f"{{{description.like}}}"
    if description.like not in words:
        raise NotUnderstoodError(f"nobody says what {{{description.like}}} shows")
    return words[description.like]


def answer_judge_from_boxes(question: JudgeFromBoxes) -> TaskVerdict:
    """Each clause by the boxes of its things, the surest of a name."""
    words = {one.slot: one.words for one in question.slot_words}
    commands = understand(question.instruction).commands
    last = {}
    for command in commands:
        last[_query(command.thing, words, False), command.kind] = command
    wrong = [said for (name, _), command in last.items() if (said := _undone(name, command, words, question))]
    summary = "; ".join(wrong)
    return TaskVerdict(reasoning=summary or "every clause fits the boxes", completed=not wrong, summary=summary)


def _undone(name: str, command: Command, words: dict[str, str], question: JudgeFromBoxes) -> str:
    """What is wrong with one clause; "" where it fits."""
    move = _move(command, words, False)
    before, after = _first(name, question.before), _first(name, question.after)
    if after is None:
        return f"{name} is not found any more"
    if move.place is None:
        if before is None:
            return f"{name} was not found before"
        off = (after.angle_deg - before.angle_deg - move.clockwise_deg + 90) % 180 - 90
        return f"{name} is off by {abs(off):.0f} degrees" if abs(off) > ANGLE_DEG else ""
    goal = _first(move.place.query, question.before if move.origin else question.after)
    if goal is None:
        return f"{move.place.query} is not found any more"
    away = math.hypot(after.x - goal.x, after.y - goal.y)
    return f"{name} lies {away:.0f} pixels from {goal.name}" if away > REACHED_SHARE * goal.length / 2 else ""


def _first(name: str, boxes: tuple[FoundBox, ...]) -> FoundBox | None:
    return next((one for one in boxes if one.name == name), None)
