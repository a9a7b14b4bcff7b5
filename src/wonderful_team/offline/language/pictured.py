"""Units of an instruction whose goal a picture shows: a table as it should be, a sequence of frames, and the way back.

A unit (a sentence, or what stands between two "then") is read by the kinds of its pictures and by a closed list of words
that serve such a purpose; any other word makes it unreadable here, so that nothing it says is passed over.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace

from wonderful_team.offline.description import Description
from wonderful_team.offline.language.commands import Command
from wonderful_team.offline.language.shows import Shows

SLOT = re.compile(r"\{([^{}]+)\}")
_ARRANGING = frozenset(
    """rearrange arrange arranged rearranged arrangement rearrangement set up setup setting scene picture image photo make match matches matching look looks
    like as in to this that the these those it its they them is are so objects object things thing items item blocks pieces everything all each every table
    tabletop layout configuration scenario state goal target reproduce recreate rebuild copy imitate bring put place move get change changes adjust reorganise
    reorganize organise organize order reorder same way shown show shows seen depicted depicted displayed given from of into on at for with and until
    what you see here how please now just by according moving transform turn desired following wanted similar identical exactly
    positions position locations location places placing arranging rearranging pattern form such accordingly corresponding corresponds one a an
    should must be have has workspace here's there current present go goes where belong belongs stand lie lies stands i want we need can could would you
    will laid out appear appears appearing tidy final end result finished their stood standing agree agrees agreeing equal equals let first kindly things
    again d objective aim task sort out scene's do doing version snapshot reference""".split()
)
_ARRANGE_CUES = frozenset(
    """rearrange arrange rearranged arranged make match set put place bring move get change adjust reorganise reorganize organise organize reorder reproduce recreate
    rebuild copy imitate transform turn tidy sort goal target should must want need until belong belongs let aim objective final desired wanted go""".split()
)
"""A unit that shows a table asks for it only with one of these words; else it only says where something is seen."""
_FOLLOWING = frozenset(
    """follow following imitate imitating repeat repeating copy copying reproduce replicate replay mimic perform do doing done execute make carry out this that these
    the motion motions movement movements trajectory path route way steps step sequence series order frames frame pictures picture images image shown show shows
    demonstrated demonstration demo seen as in of for with and then to by object objects thing things item items block blocks it them its they from on at a an is
    are was one ones after another other others next finally first second third last stack stacked stacking stacks pile piled build building tower up same like how
    move moves moving moved travel travels go goes going come comes along through exactly please now what you see watch look here given illustrated depicted video
    each all every put placing place bring let so such demonstrates tell tells should shall must which where happens top likewise similarly objects' has have be
    into thus been will can i want recorded displayed there again i'd upon onto over take taking carry lead guide bring places position positions""".split()
)
_BACK = frozenset(
    """restore restored restoring undo undone revert reverted reset return returned returning back go goes going bring brought put place placed move moved take taken get
    set original originally initial initially former formerly old previous previously starting start started own first before beginning home again to its it them
    their they the all of everything each every object objects thing things item items one ones place places position positions location locations spot spots where
    was were had been came stood lay from into in at as how state arrangement configuration layout setup table scene way looked look and then finally afterwards
    way please at end i want that this is should must change changes make let things' once so done having used be stand lie are container containers last""".split()
)
_BACK_CUES = frozenset(
    """restore restored restoring undo undone revert reverted reset return returned returning back original originally initial initially former formerly previous
    previously old starting before""".split()
)
_AGAIN = frozenset(
    "do the same this that it like so likewise please follow so exactly now them just as shown there in way".split()
)
"""A unit of these words alone says once more what the unit before said."""
_TOWARDS = frozenset("to into as in like the this".split())
"""Words that lead from one picture of the table to the next: "to {one} and then to {other}"."""
_LIKE_SHOWN = frozenset("same likewise similarly accordingly picture image shown there that like".split())
"""Words of a unit that point to what was shown before."""
_FEWEST = 2
EVERYTHING = Description(noun="thing", text="everything", quantity="all")


@dataclass(frozen=True)
class Unit:
    """A piece of an instruction.

    Attributes:
        text: Its words.
        then: Whether "then" or the end of a sentence stands before it.
        mark: What ended the piece before it, to put plain pieces together again.
    """

    text: str
    then: bool
    mark: str = ""


_SPLIT = re.compile(
    r"(?P<stop>\s*[.;!?]+(?=\s|$)\s*)|(?P<then>\s*,?\s*\b(?:and\s+)?(?:then|after that|afterwards?|after which|finally|subsequently|thereafter|next|lastly|at last|in the end)\b,?\s+(?:and\s+)?)"
    r"|(?P<and>\s*,?\s+\band\s+(?=(?:please\s+)?(?:rotate|turn|spin|put|place|move|restore|return|bring|rearrange|arrange|stack|follow|set|make|undo|reset|push|sweep)\b))",
    re.IGNORECASE,
)


def units_of(text: str) -> list[Unit]:
    """A text cut at the ends of sentences, at "then" and at "and" before a verb."""
    units: list[Unit] = []
    at, then, mark = 0, False, ""
    for found in _SPLIT.finditer(text):
        piece = text[at : found.start()].strip(" ,")
        if piece:
            units.append(Unit(piece, then, mark))
            then, mark = False, ""
        then |= found.lastgroup != "and"
        mark += found.group(0)
        at = found.end()
    piece = text[at:].strip(" ,.;!?")
    if piece:
        units.append(Unit(piece, then, mark))
    return units


def read_pictured(
    text: str, shows: Shows, read: Callable[[str], tuple[Command, ...]], describe: Callable[[str], Description | None]
) -> tuple[Command, ...] | None:
    """Commands of an instruction in which a picture shows a goal; None where words alone say it.

    Args:
        text: The instruction.
        shows: Its pictures.
        read: Reads what words alone say, or raises.
        describe: Reads a noun phrase.
    """
    frames, scenes = set(shows.names("frame")), set(shows.names("scene"))
    units = _with_scenes_together(_with_frames_together(units_of(text), frames), scenes)
    commands: list[Command] = []
    plain: list[Unit] = []
    pictured = False

    def finish() -> None:
        nonlocal plain
        if plain:
            told = read(_joined(plain))
            commands.extend(_after(told, bool(commands) and plain[0].then))
        plain = []

    for unit in units:
        again = bool(commands) and not plain and commands[-1].kind == "arrange"
        command = _following(unit, frames, shows, describe) or _arranging(unit, scenes, again)
        if command is None and _goes_back(unit) and pictured:
            finish()
            commands.append(Command("restore", EVERYTHING, after_last=True))
        elif command is None and pictured and not plain and not SLOT.search(unit.text) and _words(unit.text) <= _AGAIN:
            continue
        elif command is None:
            plain.append(unit)
        else:
            finish()
            pictured = True
            commands.extend(_after((command,), bool(commands)))
    if not pictured:
        return None
    finish()
    return tuple(commands)


def without_mentions(text: str, shows: Shows) -> str:
    """The text without units that only say that a picture shows the table, where others say what to do."""
    scenes = set(shows.names("scene"))
    units = _with_scenes_together(units_of(text), scenes)
    kept = [unit for unit in units if not _only_mentions(unit, scenes)]
    return _joined(kept) if kept and len(kept) < len(units) else text


def _only_mentions(unit: Unit, scenes: set[str]) -> bool:
    names, words = set(SLOT.findall(unit.text)), _words(unit.text)
    if not names or not names <= scenes or words <= _TOWARDS:
        return False
    return words <= _ARRANGING and not words & _ARRANGE_CUES


def _after(commands: tuple[Command, ...], then: bool) -> tuple[Command, ...]:
    return (replace(commands[0], after_last=True), *commands[1:]) if then and commands else commands


def _joined(units: list[Unit]) -> str:
    return units[0].text + "".join((unit.mark or ". ") + unit.text for unit in units[1:])


def _with_frames_together(units: list[Unit], frames: set[str]) -> list[Unit]:
    """Units with the frames of one sequence are one: "first {a}, then {b}, then {c}"."""
    at = [k for k, unit in enumerate(units) if set(SLOT.findall(unit.text)) & frames]
    if not at:
        return units
    before, middle, after = units[: at[0]], units[at[0] : at[-1] + 1], units[at[-1] + 1 :]
    if before and not any(_words(unit.text) for unit in middle) and _words(before[-1].text) <= _FOLLOWING:
        # "Copy this motion with {a}: {f0} {f1}", in two sentences.
        before, middle = before[:-1], [before[-1], *middle]
    if after and _words(after[0].text) <= _FOLLOWING and _words(after[0].text) & _LIKE_SHOWN:
        # "Watch {f0} {f1} and move {a} likewise."
        middle, after = [*middle, after[0]], after[1:]
    return [*before, Unit(_joined(middle), middle[0].then, middle[0].mark), *after]


def _with_scenes_together(units: list[Unit], scenes: set[str]) -> list[Unit]:
    """A unit that only names a picture of the table is one with the next, which says what to do with it."""
    out: list[Unit] = []
    for unit in units:
        before = out[-1] if out else None
        names = set(SLOT.findall(before.text)) if before is not None else set()
        words = _words(unit.text)
        points = words <= _ARRANGING and words & _ARRANGE_CUES and words & _LIKE_SHOWN
        alone = before is not None and names and names <= scenes and _words(before.text) <= _ARRANGING
        if before is not None and alone and points and not SLOT.search(unit.text):
            out[-1] = Unit(_joined([before, unit]), before.then, before.mark)
        else:
            out.append(unit)
    return out


def _words(text: str) -> set[str]:
    return set(re.findall(r"[a-z']+", SLOT.sub(" ", text).lower()))


def _arranging(unit: Unit, scenes: set[str], again: bool) -> Command | None:
    """A picture of the table as it should be; after another one, "then to {scene}" is enough."""
    names = SLOT.findall(unit.text)
    words = _words(unit.text)
    if not names or not set(names) <= scenes or not words <= _ARRANGING:
        return None
    if not words & _ARRANGE_CUES and not (again and words <= _TOWARDS):
        return None
    return Command("arrange", EVERYTHING, pictures=tuple(dict.fromkeys(names)))


def _following(
    unit: Unit, frames: set[str], shows: Shows, describe: Callable[[str], Description | None]
) -> Command | None:
    """A sequence of frames, and the thing that it is about when the words name one."""
    names = SLOT.findall(unit.text)
    shown = set(names) & frames
    others = [name for name in dict.fromkeys(names) if name not in frames]
    if len(shown) < _FEWEST or len(others) > 1 or not set(others) <= set(shows.names("object")):
        return None
    ordered = tuple(name for name in shows.names("frame") if name in shown)
    words = _words(unit.text)
    if others:
        what = describe(f"object shown in {{{others[0]}}}")
        return Command("follow", what, pictures=ordered) if what is not None and words <= _FOLLOWING else None
    return Command("follow", EVERYTHING, pictures=ordered) if words <= _FOLLOWING else None


def _goes_back(unit: Unit) -> bool:
    """Whether a unit asks for everything to be as it was."""
    words = _words(unit.text)
    return not SLOT.search(unit.text) and bool(words) and words <= _BACK and bool(words & _BACK_CUES)


def unknown_in_pictured(text: str, shows: Shows) -> list[str]:
    """Words of units with pictures of a table or frames that serve no purpose known here."""
    out: list[str] = []
    for unit in units_of(text):
        kinds = set(SLOT.findall(unit.text))
        if kinds & set(shows.names("frame")):
            out += sorted(_words(unit.text) - _FOLLOWING)
        elif kinds & set(shows.names("scene")) and kinds <= set(shows.names("scene")):
            out += sorted(_words(unit.text) - _ARRANGING)
    return list(dict.fromkeys(out))
