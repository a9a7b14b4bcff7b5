"""Requests and answers in a model's own terms: schema, numbers, pictures and words, both ways."""

from wonderful_team.models.wire.coding import ENCODINGS, Encoding
from wonderful_team.models.wire.composing import Composed, compose
from wonderful_team.models.wire.form import Form
from wonderful_team.models.wire.reading import Reading, encodable, read_json
from wonderful_team.models.wire.showing import Shown, paste, show, ticks_of
from wonderful_team.models.wire.unreadable import Unreadable
from wonderful_team.models.wire.weight import UNLIMITED, Weight, media_type

__all__ = [
    "Composed",
    "ENCODINGS",
    "Encoding",
    "Form",
    "Reading",
    "Shown",
    "UNLIMITED",
    "Unreadable",
    "Weight",
    "compose",
    "encodable",
    "media_type",
    "paste",
    "read_json",
    "show",
    "ticks_of",
]
