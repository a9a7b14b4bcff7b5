"""The instruction of a task read with its pictures: new words that pictures define, goals and sequences that they show.

What a picture is for follows from its kind (one thing, a whole table, a frame of a sequence, before or after) and from the
words beside it, never from the name of a task.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from wonderful_team.contracts import ShownSlot
from wonderful_team.contracts.shown import ShownTask
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.models.offline.answers.defining import define_words
from wonderful_team.models.offline.description import Description
from wonderful_team.models.offline.language import Command, Understood, try_describe, understand
from wonderful_team.models.offline.language.tokens import refusal

_SLOT = re.compile(r"\{([^{}]+)\}")
_ARRANGING = frozenset(
    """rearrange arrange arranged rearranged arrangement rearrangement set up setup scene picture image photo make match matches matching look looks
    like as in to this that the these those it its they them is are so objects object things thing items item blocks pieces everything all each every table
    tabletop layout configuration scenario state goal target reproduce recreate rebuild copy imitate restore bring put place move get change adjust reorganise
    reorganize organise organize order reorder same way shown show shows seen depicted depicted displayed given from of into on at for with and until
    what you see here how please now just by according moving transform turn desired following wanted similar identical exactly
    positions position locations location places placing arranging rearranging pattern form such accordingly corresponding corresponds one a an
    should must be have has workspace here's there current present go goes where belong belongs stand lie lies stands""".split()
)
_FOLLOWING = frozenset(
    """follow following imitate repeat copy reproduce replicate perform do execute make carry out this that these the motion motions movement movements
    trajectory path route way steps step sequence series order frames frame pictures picture images shown show shows demonstrated demonstration demo seen as in
    of for with and then to by object objects thing things item items blocks it them its from on at a an is are one after another next finally first
    second third stack stacked stacking pile build tower up same like how move moves moving moved along through exactly please now what you see here
    given illustrated depicted video each all put place bring let go goes so such way demonstrates tell tells""".split()
)
_BACK = (
    r"(?:restore|restored|undo|revert|reset)\b[^.;]*|(?:put|bring|move|take|return|place|get|set)\b[^.;{}]*\b(?:back|original|initial|where (?:it|"
    r"they|everything|all) (?:was|were|came|stood|had))\b[^.;{}]*|return\b[^.;{}]*|go back\b[^.;{}]*"
)
_TAIL = re.compile(
    rf"[,.;]?\s*(?:and\s+)?(?:then|afterwards?|finally|after that|subsequently|later|next|in the end|at last|thereafter)[,:]?\s+(?:please\s+)?(?P<back>{_BACK})\s*[.!]?\s*$",
    re.IGNORECASE,
)
_FEWEST = 2


def read_task(task: ShownTask) -> Understood:
    """What a task's instruction asks for, its pictures taken into account.

    Raises:
        NotUnderstoodError: A word is unknown, a new word is not shown clearly, or the words do not make an instruction.
    """
    slots = {slot.name: slot for slot in task.slots}
    text = define_words(task.instruction, slots)
    shown = _shown(text, slots)
    if shown is None:
        return understand(text)
    used = tuple(word for word in re.findall(r"\{[^{}]+\}|\w+", task.instruction))
    return Understood(task.instruction, shown, used)


def _shown(text: str, slots: Mapping[str, ShownSlot]) -> tuple[Command, ...] | None:
    """Commands of an instruction whose goal a picture shows; None where words alone say it."""
    tail = _TAIL.search(text)
    body = text[: tail.start()] if tail is not None else text
    names = [name for name in _SLOT.findall(body) if name in slots]
    frames = [name for name in names if slots[name].kind == "frame"]
    scenes = [name for name in names if slots[name].kind == "scene"]
    commands: tuple[Command, ...] | None
    if len(frames) >= _FEWEST:
        commands = _following(body, frames, slots)
    elif scenes:
        commands = _arranging(body, scenes, slots)
    else:
        return None
    if commands is None:
        return None
    if tail is not None:
        everything = Description(noun="thing", text="everything", quantity="all")
        commands = (*commands, Command("restore", everything, after_last=True))
    return commands


def _following(body: str, frames: list[str], slots: Mapping[str, ShownSlot]) -> tuple[Command, ...]:
    """A sequence of frames, and the thing that it is about when the words name one."""
    ordered = sorted(dict.fromkeys(frames), key=lambda name: (slots[name].index is None, slots[name].index or 0))
    rest = body
    for name in frames:
        rest = rest.replace(f"{{{name}}}", " ")
    thing = Description(noun="thing", text="everything", quantity="all")
    named = [name for name in _SLOT.findall(rest) if name in slots and slots[name].kind == "object"]
    if named:
        described = try_describe(f"object shown in {{{named[0]}}}")
        assert described is not None  # every word of it is known
        thing = described
        rest = rest.replace(f"{{{named[0]}}}", " ")
    unknown = [word for word in re.findall(r"[a-z]+", rest.lower()) if word not in _FOLLOWING]
    if unknown and not named:
        # Other words may describe the thing: "follow this motion with the red star".
        described = _thing_in(rest)
        if described is not None:
            thing, unknown = described, []
    if unknown:
        raise NotUnderstoodError(refusal([], unknown))
    return (Command("follow", thing, pictures=tuple(ordered)),)


def _thing_in(rest: str) -> Description | None:
    found = re.search(
        r"\b(?:for|with|of|to|by moving|moving|let|move)\s+(the [a-z -]+?)(?=\s*(?:[:.,;]|$|\bas\b|\balong\b|\bfollow))",
        rest.lower(),
    )
    described = try_describe(found.group(1)) if found is not None else None
    if described is None or found is None:
        return None
    others = rest.lower().replace(found.group(1), " ")
    return described if all(word in _FOLLOWING for word in re.findall(r"[a-z]+", others)) else None


def _arranging(body: str, scenes: list[str], slots: Mapping[str, ShownSlot]) -> tuple[Command, ...] | None:
    """A picture of the table as it should be; None where the picture only says where something is to be seen."""
    others = [name for name in _SLOT.findall(body) if name in slots and slots[name].kind != "scene"]
    sentences = [part for part in re.split(r"(?<=[.;!])\s+", body) if part.strip(" .;!")]
    commands: list[Command] = []
    found = False
    for sentence in sentences:
        shown = [name for name in scenes if f"{{{name}}}" in sentence]
        words = re.findall(r"[a-z']+", _SLOT.sub(" ", sentence).lower())
        if shown and not [name for name in others if f"{{{name}}}" in sentence]:
            if all(word in _ARRANGING for word in words):
                everything = Description(noun="thing", text="everything", quantity="all")
                commands.append(Command("arrange", everything, pictures=tuple(shown), after_last=bool(commands)))
                found = True
                continue
        read = understand(sentence).commands if found or len(sentences) > 1 else ()
        if not read:
            return None
        commands += [replace(command, after_last=command.after_last or found) for command in read]
    return tuple(commands) if found else None
