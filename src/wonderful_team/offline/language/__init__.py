"""The language of the offline model: a vocabulary and a grammar, and their refusals."""

from wonderful_team.offline.language.commands import Command, Destination, Understood
from wonderful_team.offline.language.reading import describe, try_describe, try_understand, understand
from wonderful_team.offline.language.vocabulary import known_words
from wonderful_team.offline.language.wording import render, worded

__all__ = [
    "Command",
    "Destination",
    "Understood",
    "describe",
    "known_words",
    "render",
    "try_describe",
    "try_understand",
    "understand",
    "worded",
]
