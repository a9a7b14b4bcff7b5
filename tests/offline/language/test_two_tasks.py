"""Two tasks in one instruction, surfaces of other simulators in words, and nothing that words say passed over."""

from __future__ import annotations

import re

import pytest

from tests.offline.language.combined import OTHER_WORDS
from tests.offline.language.scenes import StandIn, told
from tests.offline.language.wordings import Wording, filled, gist
from wonderful_team.core.values import SlotKind
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.language import Command, describe, understand
from wonderful_team.offline.language.instruction import read_instruction

KINDS: dict[str, SlotKind] = {"s": "scene", "f": "frame", "b": "before", "a": "after"}
"""Kinds of pictures by the first letter of names such as {f0}."""


def _read(text: str) -> list[str]:
    found = [re.fullmatch(r"([sfba])(\d)", name) for name in re.findall(r"\{([^{}]+)\}", text)]
    names = re.findall(r"\{([^{}]+)\}", text)
    kinds = [
        (name, KINDS[hit[1]], int(hit[2])) if hit is not None else (name, "object", None)
        for name, hit in zip(names, found, strict=True)
    ]
    return [_told(command) for command in read_instruction(text, StandIn(tuple(dict.fromkeys(kinds)))).commands]  # type: ignore[arg-type]


def _told(command: Command) -> str:
    to = command.to
    where = "" if to is None else " > " + " ".join(w for w in (to.how, to.what.text if to.what else "") if w)
    turn = f" {command.rotate_deg:g}" if command.kind == "rotate" else ""
    kept_off = f" off {command.off.text}" if command.off else ""
    return f"{command.kind} {command.thing.text.removeprefix('object shown in ')}{turn}{where}{kept_off}" + "".join(
        f" {{{name}}}" for name in command.pictures
    )


BOTH = {
    "Rearrange to {s0}, then put {x} into {y}.": ["arrange everything {s0}", "put {x} > in object shown in {y}"],
    "Rotate {x} 30 degrees and then rearrange to {s0}.": ["rotate {x} 30", "arrange everything {s0}"],
    "Rearrange the objects to {s0} and then to {s1}.": ["arrange everything {s0}", "arrange everything {s1}"],
    "Follow this motion for {x}: {f0} {f1} {f2}. Then rotate {y} 30 degrees.": ["follow {x} {f0} {f1} {f2}", "rotate {y} 30"],
    "Stack objects in this order {f0} {f1} {f2}, then put {x} into {y}.": [
        "follow everything {f0} {f1} {f2}",
        "put {x} > in object shown in {y}",
    ],
    "Sweep two {x} into {y} without touching {z}. Then rotate {w} 30 degrees.": [
        "push 2 objects shown in {x} > in object shown in {y} off object shown in {z}",
        "rotate {w} 30",
    ],
    "Rearrange to {s0}, then put everything back, then rotate {x} 30 degrees.": [
        "arrange everything {s0}",
        "restore everything",
        "rotate {x} 30",
    ],
    "This is a dax {x}. Rotate the dax 30 degrees, then put it into {y}.": ["rotate {x} 30", "put {x} > in object shown in {y}"],
    "Put {x} into {y}, rotate {z} 60 degrees and restore {x}.": [
        "put {x} > in object shown in {y}",
        "rotate {z} 60",
        "put {x} > origin",
    ],
    'From {b1} to {a1}: that is a "twist". Twist all red objects, then put {x} into {y}.': [
        "rotate all red objects 60",
        "put {x} > in object shown in {y}",
    ],
}  # fmt: skip


@pytest.mark.parametrize(("text", "wanted"), BOTH.items())
def test_both_tasks_are_read(text: str, wanted: list[str]) -> None:
    assert _read(text) == wanted


@pytest.mark.parametrize(("table", "text"), [(name, text) for name, texts in OTHER_WORDS.items() for text in texts])
def test_tables_with_two_tasks_in_other_words(table: str, text: str) -> None:
    scene = told(table, 0)
    own, other = (gist(scene.read(filled(words, scene.words))) for words in (scene.instruction, text))
    assert sorted(map(repr, own)) == sorted(map(repr, other))


SURFACES = ("brick", "tiles", "wooden", "granite", "plastic", "polka dot", "checkerboard", "tiger", "magma", "rainbow", "red and yellow stripe",
            "dark red and yellow stripe", "green and purple polka dot", "dark green and purple polka dot", "blue swirl", "dark blue swirl",
            "red paisley", "yellow paisley", "olive", "cyan", "dark cyan", "dark pink")  # fmt: skip


@pytest.mark.parametrize(("one", "other"), list(zip(SURFACES, (*SURFACES[3:], *SURFACES[:3]), strict=True)))
def test_surfaces_are_told_apart_in_both_places(one: str, other: str) -> None:
    assert describe(f"{one} object") != describe(f"{other} object")
    for text in (
        f"Put the {one} object in {{scene}} into the {other} object.",
        f"In {{scene}} there is a {one} object. Put it into the {other} object.",
    ):
        (command,) = understand(text).commands
        assert command.to is not None
        assert (command.thing, command.to.what) == (describe(f"{one} object"), describe(f"{other} object"))


def test_the_same_colour_as_another_thing_is_not_ones_own() -> None:
    (command,) = understand("Put all blocks into the bowl of the same colour as the star.").commands
    assert _told(command) == "put all blocks > in bowl with the same colour as the star"
    (command,) = understand("Put each block into the bowl of the same colour as that block.").commands
    assert command.to is not None
    assert (command.to.how, command.to.aspect) == ("matching", "colour")


@pytest.mark.parametrize(
    ("text", "lost"),
    [
        ("Objects looking like {x} in colour go into {y}.", "colour"),
        ("Put all blocks into the bowl that shares its colour with the star.", "aspect"),
        ("Put {x} into {y} or {z}.", "or"),
    ],
)
def test_nothing_said_is_passed_over(text: str, lost: str) -> None:
    with pytest.raises(NotUnderstoodError, match=f"I do not know: [^.]*.*{lost}"):
        understand(text)


def test_wordings_may_presume_words_of_the_scene() -> None:
    wording = Wording("rotate", "Turn {dragged_obj} by a quarter of a turn.", (("angle", "90"),))
    assert wording.suits({"angle": "90"})
    assert not wording.suits({"angle": "60"})
