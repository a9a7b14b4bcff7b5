"""Shared rendering: pictures with captions, the task, plans, targets, notes and steps, as words and pictures."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from wonderful_team.contracts import ShownSlot, ShownTask
from wonderful_team.core.actions import STEPS
from wonderful_team.core.pictures import (
    Axes,
    BoxMark,
    Candidates,
    Grid,
    LineMark,
    Mark,
    PathMark,
    Picture,
    PointMark,
    RegionMark,
    Tiles,
    TurnMark,
)
from wonderful_team.core.values import NOTEBOOK, Note, Part, Subgoal, Target, Words
from wonderful_team.images.captions import axes_words, size_words
from wonderful_team.images.panels import fit, side_by_side

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
            if mark.prefix:
                return f"points {mark.prefix}1 to {mark.prefix}{count}" if count > 1 else f"one point {mark.prefix}1"
            return f"points numbered 1 to {count}" if count > 1 else "one point numbered 1"
        case PathMark():
            return _path_words(mark)
        case Tiles():
            return f"pictures numbered 1 to {len(mark.boxes)}"
        case Grid():
            return f"a grid of tiles {mark.names[0]} to {mark.names[-1]} (letters from left to right, numbers from bottom to top)"
        case TurnMark():
            return (
                "an arc with the degrees of a turn"
                + (f" labelled {mark.label}" if mark.label else "")
                + ", and the box of the thing as it is turned then"
            )
        case LineMark():
            return "a line where the box's edge lies"
        case RegionMark():
            return "a region that nothing may enter" + (f" labelled {mark.label}" if mark.label else "")


def _path_words(mark: PathMark) -> str:
    if len(mark.points) == 1:
        return "a dot where a thing is held" + (f" labelled {mark.label}" if mark.label else "")
    strip = " with the strip that the tool sweeps" if mark.width else ""
    return (f"a path labelled {mark.label}" if mark.label else "a path with an arrow at its end") + strip


def caption(picture: Picture, about: str = "") -> str:
    """The line that announces a picture: name, size, what it is, what is drawn on it."""
    line = f'Picture "{picture.name}" ({size_words(picture.size_px)})' + (f", {about}" if about else "")
    marks = list(dict.fromkeys(mark_words(mark) for mark in picture.marks))
    padded = not picture.panels and picture.frame.valid.as_tuple != picture.frame.whole_box.as_tuple
    line += "; what is striped grey lies outside the view" if padded else ""
    return line + (f"; drawn on it: {', '.join(marks)}" if marks else "") + ":"


def picture_parts(picture: Picture, about: str = "") -> list[Part]:
    """A caption and the picture."""
    return [Words(caption(picture, about), "caption", picture, about), picture]


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
        announced, shown = picture_parts(view, first if number == 0 else "another view, for understanding only")
        assert isinstance(announced, Words)
        parts += [replace(announced, about=f"{title[:1].lower()}{title[1:]}, {announced.about}"), shown]
    return parts


def slot_about(slot: ShownSlot) -> str:
    """What a slot's pictures are, in words."""
    place = f", number {slot.index}" if slot.index is not None else ""
    return f"{{{slot.name}}}: {_SLOT_KINDS[slot.kind]}{place}"


def slot_parts(slots: Sequence[ShownSlot]) -> list[Part]:
    """The pictures of slots, each announced; what belongs together stands side by side in one picture."""
    return [part for group in slot_groups(slots) for part in _group_parts(group)]


def slot_groups(slots: Sequence[ShownSlot]) -> list[tuple[ShownSlot, ...]]:
    """Which slots share a picture: single things one after the other as long as it stays small enough, and a thing before
    and after.
    """
    groups: list[tuple[ShownSlot, ...]] = []
    left = list(slots)
    while left:
        group: tuple[ShownSlot, ...] = (left.pop(0),)
        end = next((other for other in left if _is_pair(group[0], other)), None)
        if end is not None:
            left.remove(end)
            group = (*group, end)
        elif _is_single(group[0]):
            while following := next((other for other in left if _is_single(other)), None):
                if not fit(tuple((f"{{{slot.name}}}", slot.pictures) for slot in (*group, following))):
                    break
                left.remove(following)
                group = (*group, following)
        groups.append(group)
    return groups


def _is_single(slot: ShownSlot) -> bool:
    """Whether a slot shows one thing, cut out."""
    return slot.kind == "object" and bool(slot.pictures) and all(map(_is_cut, slot.pictures))


def _is_pair(slot: ShownSlot, other: ShownSlot) -> bool:
    """Whether two slots show one thing before and after, in the same window."""
    ends = (slot.kind, other.kind, slot.index) == ("before", "after", other.index)
    if not ends or not slot.pictures or not other.pictures or slot.pictures[0].marks or other.pictures[0].marks:
        return False
    first, second = slot.pictures[0].frame, other.pictures[0].frame
    return first.size_px == second.size_px and bool((first.T_view_picture == second.T_view_picture).all())


def _group_parts(group: tuple[ShownSlot, ...]) -> list[Part]:
    """One group of slots, in one picture where that is possible."""
    first = group[0]
    if _is_single(first):
        return _side_by_side(tuple((slot, slot.pictures) for slot in group))
    if len(group) > 1:
        parts = _side_by_side(tuple((slot, slot.pictures[:1]) for slot in group))
        return parts + [
            part for slot in group for item in slot.pictures[1:] for part in picture_parts(item, slot_about(slot))
        ]
    return [part for picture in first.pictures for part in picture_parts(picture, slot_about(first))]


def _side_by_side(shown: tuple[tuple[ShownSlot, tuple[Picture, ...]], ...]) -> list[Part]:
    """Pictures of slots in one, and what stands where in it."""
    named = tuple((f"{{{slot.name}}}", pictures) for slot, pictures in shown)
    names = [name for name, _ in named]
    name = ", ".join(names) if len(names) <= 2 else f"{names[0]} to {names[-1]}"  # noqa: PLR2004  a pair is named in full
    sheet = side_by_side(named, name)
    if len({slot_about(slot).partition(": ")[2] for slot, _ in shown}) == 1:
        about = f"{'each ' if len(names) > 1 else ''}over its name, {', '.join(names)}: {slot_about(shown[0][0]).partition(': ')[2]}"
    else:
        about = f"each over its name, {'; '.join(slot_about(slot) for slot, _ in shown)}"
    sizes = tuple(dict.fromkeys(_cut_words(slot, pictures) for slot, pictures in shown))
    if len(sizes) == 1:
        about += sizes[0]
    else:
        about += "; " + "; ".join(f"{{{slot.name}}}{_cut_words(slot, pictures)}" for slot, pictures in shown)
    cameras = tuple(dict.fromkeys(_cameras(slot, pictures) for slot, pictures in shown))
    views = f"; of each the {cameras[0]}" if len(cameras) == 1 and cameras[0] else ""
    if len(cameras) > 1:
        views = "; " + "; ".join(f"{{{slot.name}}}: {_cameras(slot, held)}" for slot, held in shown)
    return picture_parts(sheet, about + views)


def _cameras(slot: ShownSlot, pictures: Sequence[Picture]) -> str:
    """The cameras of a thing's pictures, from left to right; empty for a single one."""
    names = [f"{picture.name.removeprefix(f'{{{slot.name}}} ')} view" for picture in pictures]
    return f"{', '.join(names[:-1])} (left) and {names[-1]} (right)" if len(names) > 1 else ""


def _is_cut(picture: Picture) -> bool:
    return bool(picture.frame.T_view_picture[:2, 2].any())


def _cut_words(slot: ShownSlot, pictures: Sequence[Picture]) -> str:
    """How large what was cut out is shown, compared with the main view where one camera took both; empty for whole pictures."""
    if not any(map(_is_cut, pictures)):
        return ""
    if slot.times is None:
        return (
            f", enlarged {pictures[0].frame.scale:.2g} times" if round(pictures[0].frame.scale, 1) != 1 else ", cut out"
        )
    return (
        f", {slot.times:.2g} times as large as in the main view"
        if round(slot.times, 1) != 1
        else ", as large as in the main view"
    )


def example_parts(slots: Sequence[ShownSlot]) -> list[Part]:
    """Example pictures of a target."""
    return [*words("Example pictures:"), *slot_parts(slots)] if slots else []


def instruction_parts(task: ShownTask) -> list[Part]:
    """The instruction between its tags, each slot's pictures where its name first stands."""
    tag = safe_tag("instruction", task.instruction)
    named = sorted(task.slots, key=lambda slot: _first_named(task.instruction, slot.name))
    unshown = {group[0].name: group for group in slot_groups(named)}
    parts: list[Part] = []
    text = f"<{tag}>\n"
    for piece in re.split(r"(\{[^{}]*\})", task.instruction):
        text += piece
        group = unshown.pop(piece[1:-1], None) if piece.startswith("{") else None
        if group is not None:
            parts += [Words(text), *_group_parts(group)]
            text = ""
    # Pictures that the words never name still belong to the instruction.
    if unshown:
        parts += [*words(text), *(part for group in unshown.values() for part in _group_parts(group))]
        text = ""
    return [*parts, Words(f"{text}\n</{tag}>")]


def _first_named(instruction: str, name: str) -> int:
    at = instruction.find(f"{{{name}}}")
    return at if at >= 0 else len(instruction)


def task_parts(task: ShownTask, title: str = "The scene now") -> list[Part]:
    """The instruction with its pictures, the views, what is known of the robot, what the user said and what was done."""
    return [
        *words("The user's instruction:"),
        *instruction_parts(task),
        *view_parts(title, task.views),
        *listed("What is known of the robot and its place", task.facts),
        *listed("What the user said beside the instruction", task.said),
        *listed(
            "Already carried out, as planned; the views are newer. A plan holds only what is left to do", task.done
        ),
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
    extras.append(f"points for: {', '.join(target.roles)}" if target.roles else "no points: only its outline is needed")
    return f"{target.id} ({target.kind}): {named}; {'; '.join(extras)}"


def target_parts(targets: Sequence[Target], title: str = "Targets") -> list[Part]:
    return listed(title, [target_words(target) for target in targets], "none listed yet")


def ability_parts(step_kinds: Sequence[str]) -> list[Part]:
    """What the robot can do, one line per kind of step."""
    return listed(
        "What the robot can do, and nothing else", [f"{kind}: {STEPS[kind].words.does}" for kind in step_kinds]
    )


def rule_parts(step_kinds: Sequence[str], use: Literal["planned", "written"]) -> list[Part]:
    """What has to be known of this robot's kinds of step to plan for them, or to write them."""
    rules = {kind: getattr(STEPS[kind].words, use) for kind in step_kinds}
    title = {"planned": "Plans for these", "written": "How these are written"}[use]
    return listed(title, [f"{kind}: {rule}" for kind, rule in rules.items() if rule])


def function_parts(lines: Sequence[str]) -> list[Part]:
    """The helper functions of earlier steps, for whoever writes a plan."""
    return listed(
        "Helper functions that were accepted earlier in this task; where such a path is needed again, `function` says what is to be "
        'computed and by which of them, as in "a circle round T2, by path_1"',
        lines,
    )


def note_parts(notes: Sequence[Note]) -> list[Part]:
    """The role's notebook and the system memory, in order.

    A line of a notebook is a sentence; its key is the name of a question, which the role does not know.
    """
    lines = [note.text if note.source == NOTEBOOK else f"{note.key}: {note.text}" for note in notes]
    return listed("Notes kept from earlier in this task", lines)
