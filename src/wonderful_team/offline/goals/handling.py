"""What is done to a thing where it is, in one picture: a figure drawn on it, its surface wiped, it is shaken, it is opened."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from wonderful_team.offline.description import ROOMY
from wonderful_team.offline.eyes import Eyes
from wonderful_team.offline.goals.aims import Aim, Aims, Named, seen_named
from wonderful_team.offline.goals.clearing import closed_by, is_of_one_piece, out_of_the_way
from wonderful_team.offline.language import Command
from wonderful_team.offline.language.vocabulary import TOOLS
from wonderful_team.offline.vision import Thing
from wonderful_team.offline.vision.kinds import part_on

IN_THE_WAY_M = 0.015
"""What stands so high on a surface is in the way of a tool that is led over it [m]."""
TURN_DEG, MORE_DEG, MOST_DEG = 270.0, 30.0, 360.0
"""How far a cap is turned where nothing says how far it has to be, how much farther than that (fingers slip), and at most [degrees]."""
_HELD = re.compile(
    r"\b(?:gripper|robot|hand|fingers?|arm) holds?\b|\bheld\b|\bin the (?:gripper|hand|fingers)\b", re.IGNORECASE
)
_DOES = {"draw": "draws", "wipe": "wipes"}


def handled_aims(command: Command, things: Sequence[Named], eyes: Eyes, result: Aims) -> list[Aim]:
    """One aim per thing; what the picture or the words on the robot do not allow is told as absent."""
    if command.kind == "open":
        return [aim for thing in things for aim in _opened(command, thing, eyes, result)]
    if command.kind == "shake":
        return [Aim("shake", thing, "origin", figure=command.figure) for thing in things]
    result.absent += _without_tool(command, eyes)
    for thing in things:
        result.absent += _covered(thing, eyes)
    return [Aim("trace", thing, figure=command.figure) for thing in things]


def held_tool(facts: Sequence[str]) -> str:
    """The tool that the fingers are said to hold, or ""."""
    names = "|".join(word for words in TOOLS.values() for word in words.split())
    for line in facts:
        found = re.search(rf"\b({names})\b", line, re.IGNORECASE)
        if found is not None and _HELD.search(line):
            return found.group(1).lower()
    return ""


def _without_tool(command: Command, eyes: Eyes) -> Iterator[str]:
    """Why there is nothing to lead over a thing: a path along a surface needs a tool for it in the fingers."""
    use = "wipe" if command.figure is not None and command.figure.name == "area" else "draw"
    held = held_tool(eyes.facts)
    fit = TOOLS[use].split()
    named = command.tool.name if command.tool is not None else ""
    if named and named not in fit:
        yield f"a {named} {_DOES[use]} nothing (what does: {', '.join(fit)})"
    elif held not in fit:
        has = f"the gripper holds a {held}" if held else "the gripper is not said to hold a tool"
        yield f"{has}, and nothing that {_DOES[use]} ({', '.join(fit)})"


def _covered(thing: Named, eyes: Eyes) -> Iterator[str]:
    """What stands on a surface that a tool would be led over."""
    surface = eyes.thing(thing.number)
    if surface is None:
        return
    for upper in eyes.scene.on(surface):
        if (upper.height_m or 0.0) > (surface.height_m or 0.0) + IN_THE_WAY_M:
            yield f"the {seen_named(eyes, upper).words} stands on the {thing.words}, in the way"


def _opened(command: Command, thing: Named, eyes: Eyes, result: Aims) -> list[Aim]:
    """A lid is put aside, a cap is screwed off."""
    seen = eyes.thing(thing.number)
    if seen is None:
        return []
    cap = thing if thing.description.noun == "cap" else _cap(seen, eyes)
    if cap is not None:
        turn = command.rotate_deg or turn_deg(eyes.facts)
        return [Aim("twist", cap, "in", Named(ROOMY), rotate_deg=-abs(turn))]
    lid = seen if thing.description.noun == "lid" else closed_by(seen, eyes)
    if lid is not None and part_on(lid, eyes.scene) is not None:
        return [out_of_the_way(lid, eyes, f"it closes the {thing.words}", "lid")]
    result.absent.append(f"nothing that closes the {thing.words} and could be taken off shows")
    return []


def _cap(bottle: Thing, eyes: Eyes) -> Named | None:
    """What is screwed on a bottle: it stands up from its middle, and is of another colour than the bottle."""
    part = part_on(bottle, eyes.scene)
    return None if part is None or is_of_one_piece(part, bottle) else seen_named(eyes, part, "cap")


def turn_deg(facts: Sequence[str]) -> float:
    """How far a cap is turned: a little more than what is known of it says, or most of the way round."""
    said = [
        float(found) for line in facts if re.search(r"\bcaps?\b", line) for found in re.findall(r"(\d+) degrees", line)
    ]
    return min(MOST_DEG, max(said) + MORE_DEG) if said else TURN_DEG
