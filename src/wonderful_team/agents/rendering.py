"""Shared rendering: pictures with captions, the task, plans, targets, notes and steps, as words and pictures."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from wonderful_team.contracts import ShownSlot, ShownTask
from wonderful_team.core.actions import STEPS
from wonderful_team.core.pictures import (
    Axes,
    BoxMark,
    Candidates,
    LineMark,
    Mark,
    PathMark,
    Picture,
    PointMark,
    Tiles,
    TurnMark,
)
from wonderful_team.core.values import Note, Part, Subgoal, Target, Words
from wonderful_team.images.captions import axes_words, size_words

_BOX_STYLES = {
    "target": "the box",
    "before": "the box before",
    "after": "the box after",
    "keep_out": "a region that nothing may enter",
    "workspace": "the robot's workspace",
}
_LIKE = {
    "both": "looks like {}",
    "shape": "has the shape of {}; its surface does not count",
    "surface": "has the surface (colour and pattern) of {}; its shape does not count",
    "place": "defined by {}",
}
_SLOT_KINDS = {
    "object": "one thing alone",
    "scene": "a whole scene",
    "frame": "one frame of a sequence",
    "before": "how it was before, of a pair",
    "after": "how it was after, of a pair",
}


def words(*lines: str) -> list[Part]:
    """One part of text; empty lines at its ends are dropped."""
    text = "\n".join(lines).strip("\n")
    return [Words(text)] if text else []


def listed(title: str, lines: Sequence[str], empty: str = "") -> list[Part]:
    """A titled list, one line each; `empty` is said instead when there is nothing to list."""
    if lines:
        return words(f"{title}:", *(f"- {line}" for line in lines))
    return words(f"{title}: {empty}") if empty else []


def fenced(tag: str, text: str) -> str:
    """Text between <tag> and </tag>; the tag is numbered when the text itself contains it."""
    tag = safe_tag(tag, text)
    return f"<{tag}>\n{text}\n</{tag}>"


def safe_tag(tag: str, text: str) -> str:
    """The tag, or the tag with a number, such that the text cannot close it."""
    number, free = 1, tag
    while f"</{free}" in text.lower() or f"<{free}" in text.lower():
        number += 1
        free = f"{tag}-{number}"
    return free


def mark_words(mark: Mark) -> str:
    """What a mark is, in a few words."""
    match mark:
        case Axes():
            return axes_words(mark)
        case BoxMark():
            return _BOX_STYLES[mark.style] + (f" labelled {mark.label}" if mark.label else "")
        case PointMark():
            return f"a point labelled {mark.label}" if mark.label else "a point"
        case Candidates():
            count = len(mark.points)
            return f"points numbered 1 to {count}" if count > 1 else "one point numbered 1"
        case PathMark():
            strip = " with the strip that the tool sweeps" if mark.width else ""
            return (f"a path labelled {mark.label}" if mark.label else "a path with an arrow at its end") + strip
        case Tiles():
            return f"pictures numbered 1 to {len(mark.boxes)}"
        case TurnMark():
            return (
                "an arc with the degrees of a turn"
                + (f" labelled {mark.label}" if mark.label else "")
                + (", and the outline of the thing after it")
            )
        case LineMark():
            return "a line where the box's edge lies"


def caption(picture: Picture, about: str = "") -> str:
    """The line that announces a picture: name, size, what it is, what is drawn on it."""
    line = f'Picture "{picture.name}" ({size_words(picture.size_px)})' + (f", {about}" if about else "")
    marks = list(dict.fromkeys(mark_words(mark) for mark in picture.marks))
    return line + (f"; drawn on it: {', '.join(marks)}" if marks else "") + ":"


def picture_parts(picture: Picture, about: str = "") -> list[Part]:
    """A caption and the picture."""
    return [Words(caption(picture, about), "caption", picture), picture]


def answer_in(picture: Picture) -> list[Part]:
    """The line that says which picture the answer's positions refer to."""
    width, height = picture.size_px
    text = f'Answer with positions in picture "{picture.name}": x from 0 to {width}, y from 0 to {height}.'
    return [Words(text, "positions", picture)]


def amounts_in(picture: Picture) -> list[Part]:
    """The line that says in which picture's unit the answer's amounts are meant."""
    width, height = picture.size_px
    return words(f'Answer with amounts in picture "{picture.name}", which spans {width} across and {height} down.')


def view_parts(title: str, views: Sequence[Picture], first: str = "the main view") -> list[Part]:
    """Views of a scene; the first one is the main view."""
    parts = words(f"{title}:") if views else []
    for number, view in enumerate(views):
        parts += picture_parts(view, first if number == 0 else "another view, for understanding only")
    return parts


def slot_about(slot: ShownSlot) -> str:
    """What a slot's pictures are, in words."""
    place = f", number {slot.index}" if slot.index is not None else ""
    return f"{{{slot.name}}}: {_SLOT_KINDS[slot.kind]}{place}"


def slot_parts(slots: Iterable[ShownSlot]) -> list[Part]:
    """The pictures of slots, each announced."""
    parts: list[Part] = []
    for slot in slots:
        for picture in slot.pictures:
            parts += picture_parts(picture, slot_about(slot))
    return parts


def example_parts(slots: Sequence[ShownSlot]) -> list[Part]:
    """Example pictures of a target."""
    return [*words("Example pictures:"), *slot_parts(slots)] if slots else []


def instruction_parts(task: ShownTask) -> list[Part]:
    """The instruction between its tags, each slot's pictures where its name first stands."""
    tag = safe_tag("instruction", task.instruction)
    unshown = {slot.name: slot for slot in task.slots}
    parts: list[Part] = []
    text = f"<{tag}>\n"
    for piece in re.split(r"(\{[^{}]*\})", task.instruction):
        text += piece
        slot = unshown.pop(piece[1:-1], None) if piece.startswith("{") else None
        if slot is not None:
            parts += [Words(text), *slot_parts([slot])]
            text = ""
    # Pictures that the words never name still belong to the instruction.
    if unshown:
        parts += [*words(text), *slot_parts(unshown.values())]
        text = ""
    return [*parts, Words(f"{text}\n</{tag}>")]


def task_parts(task: ShownTask, title: str = "The scene now") -> list[Part]:
    """The instruction with its pictures, then the views, then what is known of the robot."""
    return [
        *words("The user's instruction:"),
        *instruction_parts(task),
        *view_parts(title, task.views),
        *listed("What is known of the robot and its place", task.facts),
    ]


def subgoal_words(subgoal: Subgoal) -> str:
    """One subgoal in one line."""
    extras = []
    if subgoal.after:
        extras.append(f"after {', '.join(subgoal.after)}")
    if subgoal.targets:
        extras.append(f"needs {', '.join(subgoal.targets)}")
    if subgoal.function is not None:
        extras.append(f"helper function: {subgoal.function}")
    return f"{subgoal.id}: {subgoal.text}" + (f" ({'; '.join(extras)})" if extras else "")


def subgoal_parts(subgoals: Sequence[Subgoal], title: str = "The plan") -> list[Part]:
    return listed(title, [subgoal_words(subgoal) for subgoal in subgoals], "no subgoal: it is taken to be fulfilled")


def target_words(target: Target) -> str:
    """One target in one line."""
    named = target.words + (f" [part: {target.part}]" if target.part else "")
    extras = [f"where: {target.where}"] if target.where else []
    if target.like:
        pictures = ", ".join(f"{{{name}}}" for name in target.like)
        extras.append(_LIKE[target.alike if target.kind == "object" else "place"].format(pictures))
    extras.append(f"points for: {', '.join(target.roles)}")
    return f"{target.id} ({target.kind}): {named}; {'; '.join(extras)}"


def target_parts(targets: Sequence[Target], title: str = "Targets") -> list[Part]:
    return listed(title, [target_words(target) for target in targets], "none listed yet")


def ability_parts(step_kinds: Sequence[str]) -> list[Part]:
    """What the robot can do, one line per kind of step."""
    return listed(
        "What the robot can do, and nothing else", [f"{kind}: {STEPS[kind].words.does}" for kind in step_kinds]
    )


def note_parts(notes: Sequence[Note]) -> list[Part]:
    """The role's notebook and the system memory, in order."""
    lines = [f"{note.key}: {note.text}" + (f" (from {note.source})" if note.source else "") for note in notes]
    return listed("Notes kept from earlier in this task", lines)
