"""An instruction read with its pictures: definitions first, then what pictures show, then what words alone say.

What a picture is for follows from its kind (one thing, a whole table, a frame of a sequence, before or after) and from the
words beside it.
"""

from __future__ import annotations

import re
from dataclasses import replace

from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.language.commands import Command, Understood
from wonderful_team.offline.language.definitions import define_words
from wonderful_team.offline.language.framing import NOTHING_ELSE
from wonderful_team.offline.language.pictured import read_pictured, unknown_in_pictured, without_mentions
from wonderful_team.offline.language.reading import try_describe, understand
from wonderful_team.offline.language.rewrites import in_order, written
from wonderful_team.offline.language.shown_turns import define_turns
from wonderful_team.offline.language.shows import Shows
from wonderful_team.offline.language.tokens import refusal


def read_instruction(text: str, shows: Shows) -> Understood:
    """What an instruction asks for, its pictures taken into account.

    Raises:
        NotUnderstoodError: A word is unknown, a new word is not shown clearly, or the words do not make an instruction.
    """
    said = written(text)
    bare = said.removeprefix(NOTHING_ELSE).lstrip(" :.,;")
    plain = without_mentions(define_words(define_turns(bare, shows, try_describe), shows), shows)

    told: list[Understood] = []

    def read(words: str) -> tuple[Command, ...]:
        told.append(understand(words))
        return told[-1].commands

    try:
        commands = read_pictured(in_order(plain), shows, read, try_describe) if shows.names("scene", "frame") else None
        if commands is None:
            understood = understand(plain)
            return replace(understood, nothing_else=understood.nothing_else or bare != said)
    except NotUnderstoodError as error:
        unknown = unknown_in_pictured(plain, shows)
        if unknown and not any(word in str(error) for word in unknown):
            raise NotUnderstoodError(refusal([], unknown)) from error
        raise
    used = tuple(re.findall(r"\{[^{}]+\}|\w+", text))
    spared = tuple(thing for part in told for thing in part.spared)
    return Understood(text, commands, used, bare != said or any(part.nothing_else for part in told), spared)
