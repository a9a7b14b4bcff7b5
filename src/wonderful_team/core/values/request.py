"""What is asked of a model, what comes back, and what it costs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal, TypeAlias

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values.plan import Provenance

NOTEBOOK = "notebook"
"""Source of a note that a role made of its own answer."""


@dataclass(frozen=True)
class Usage:
    """What calls cost. `usd` is None when any price is unknown."""

    calls: int = 0
    tokens_in: int = 0
    tokens_cached: int = 0
    tokens_thinking: int = 0
    tokens_out: int = 0
    pictures: int = 0
    seconds: float = 0.0
    usd: float | None = 0.0

    def __add__(self, other: Usage) -> Usage:
        return Usage(
            self.calls + other.calls,
            self.tokens_in + other.tokens_in,
            self.tokens_cached + other.tokens_cached,
            self.tokens_thinking + other.tokens_thinking,
            self.tokens_out + other.tokens_out,
            self.pictures + other.pictures,
            self.seconds + other.seconds,
            None if self.usd is None or other.usd is None else self.usd + other.usd,
        )

    @property
    def tokens(self) -> int:
        return self.tokens_in + self.tokens_thinking + self.tokens_out


@dataclass(frozen=True)
class Note:
    """One entry of a role's notebook (`source` is then NOTEBOOK) or of the system memory."""

    key: str
    text: str
    source: str = ""


@dataclass(frozen=True, eq=False)
class Words:
    """A part of a request: text.

    Attributes:
        says: caption (it announces `picture`, its size and its tick labels), positions (it says how to give positions in
            `picture`) or tolerance (how exact the box on `picture` has to be): a provider may write these in its model's own
            unit. "" for all other text.
        about: Of a caption: what the picture is, in words.
    """

    text: str
    says: Literal["", "caption", "positions", "tolerance"] = ""
    picture: Picture | None = None
    about: str = ""


Part: TypeAlias = Words | Picture


@dataclass(frozen=True, eq=False)
class SentPicture:
    """One picture as it went out: the bytes of its file, PNG or JPEG.

    Attributes:
        size_px: Its width and height, which may differ from those of the picture it shows.
        rgb: What the file was made of, shape (H, W, 3), uint8, where that is at hand.
    """

    file: bytes
    size_px: tuple[int, int]
    rgb: Array | None = field(default=None, repr=False)

    @property
    def media_type(self) -> str:
        return "image/jpeg" if self.file.startswith(b"\xff\xd8") else "image/png"


@dataclass(frozen=True, eq=False)
class Request:
    """One question on its way to a model.

    Attributes:
        id: Deterministic: stage, target and count, never a clock or a race.
        stage: plan | ground | act | memory | replan | other.
        role: Which agent asks.
        question: The contract's input; holds nothing that the parts do not show.
        parts: Words and pictures in the order they are shown.
        system: The role's standing words (the same prefix for every request of the role).
        output: Type of a right answer (a pydantic model).
        sample: Number of this independent sample, from 0.
        attempt: Number of the try after an invalid answer, from 0.
        feedback: The validation text that the last attempt earned.
    """

    id: str
    stage: str
    role: str
    question: Any
    parts: tuple[Part, ...]
    output: type[Any]
    system: str = ""
    notes: tuple[Note, ...] = ()
    sample: int = 0
    attempt: int = 0
    feedback: str = ""
    previous: Any = None

    chat: ClassVar[Callable[..., list[dict[str, Any]]] | None] = None

    def messages(self, pictures: Literal["data_url", "png"] = "data_url") -> list[dict[str, Any]]:
        """The request as chat messages, for a client of a model of one's own.

        A system message, and a user message whose content is a list of parts in the order they are shown:
        {"type": "text", "text": ...} and {"type": "image_url", "image_url": {"url": "data:image/png;base64,..."}}. The last
        text asks for one JSON object and holds its schema. After an answer that did not fit, that answer and what is wrong
        with it follow.

        Args:
            pictures: data_url, or png: {"type": "image", "media_type": "image/png", "data": the PNG bytes}.
        """
        # Drawing lies above these types: the side that sends requests hands it in when it is loaded.
        assert Request.chat is not None, "requests come from a team or a client, which load the drawing"
        return Request.chat(self, pictures)

    @property
    def contract(self) -> str:
        """Name of the kind of question."""
        return type(self.question).__name__

    @property
    def pictures(self) -> tuple[Picture, ...]:
        return tuple(part for part in self.parts if isinstance(part, Picture))


@dataclass(frozen=True, eq=False)
class Answer:
    """What came back: the validated value and what it cost.

    Attributes:
        value: An instance of the request's output type.
        repairs: What was clamped or repaired, in words.
        notices: What the user should know of the service, once, in words.
        checked: What validating the value against its question gave, where that was done on the way to the client.
    """

    value: Any
    usage: Usage = Usage()
    model_id: str = ""
    raw: str = ""
    tries: int = 1
    provenance: Provenance = "model"
    repairs: tuple[str, ...] = ()
    notices: tuple[str, ...] = ()
    checked: Any = field(default=None, repr=False)
