"""What stands behind a server: a function of what was heard to a reply.

The offline brain answers with the real offline model. Vision needs the typed question, which no wire carries: a AgentSession
keeps the requests that are under way, and the brain finds the one that it was sent by its words and pictures.
"""

from __future__ import annotations

import json
import re
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import cv2
import numpy as np

from tests.servers.heard import Heard, Reply
from tests.servers.speech import Seat, Speech, say
from wonderful_team.core.values import Answer, Request, Words
from wonderful_team.images.grain import is_photo
from wonderful_team.models.client import as_answer, validate_answer

Brain: TypeAlias = Callable[[Heard], "Reply | str"]
SAME_SHARE = 0.5
"""Least share of a sent picture's pixels that are the clean picture's: marks cover the rest."""

JPEG_LEVELS, RESIZED_LEVELS = 24, 40
"""How far a pixel may be off in a photo that came as JPEG, and in a picture that was resized [0 to 255]."""


class Unmatched(Exception):  # noqa: N818
    """What came over the wire is none of the requests under way."""


@dataclass
class AgentSession:
    """Requests on their way to a model."""

    _open: list[Request] = field(default_factory=list)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def put(self, request: Request) -> None:
        with self._lock:
            self._open.append(request)

    def take(self, request: Request) -> None:
        with self._lock:
            self._open = [other for other in self._open if other is not request]

    def find(self, heard: Heard) -> Request:
        """The request that was sent.

        Raises:
            Unmatched: None of them, or its words or pictures did not all arrive, in order.
        """
        with self._lock:
            under_way = list(self._open)
        problems = []
        for request in under_way:
            problem = self.problem(heard, request)
            if not problem:
                return request
            problems.append(f"{request.id}: {problem}")
        raise Unmatched("; ".join(problems) or "nothing is under way")

    def problem(self, heard: Heard, request: Request) -> str:
        """Why what was heard is not this request; "" when it is."""
        if request.system and request.system.strip() not in heard.system:
            return "its system words did not arrive"
        at, words = 0, heard.words
        for part in request.parts:
            # Captions and the words on positions are written anew, in the model's own unit.
            if isinstance(part, Words) and not part.says:
                found = words.find(part.text.strip(), at)
                if found < 0:
                    return f"words are missing or out of order: {part.text[:60]!r}"
                at = found + len(part.text.strip())
        if request.feedback and request.feedback not in words[at:]:
            return "the feedback on the last attempt did not arrive"
        try:
            for index in range(len(request.pictures)):
                _check_picture(heard, request, index)
        except Unmatched as error:
            return str(error)
        return ""


def seat_of(heard: Heard, request: Request, index: int) -> Seat:
    """Where picture number `index` of a request was received: alone, or on a sheet whose words say where.

    Raises:
        Unmatched: It was not.
    """
    picture = request.pictures[index]
    if len(heard.pictures) == len(request.pictures):
        height, width = heard.pictures[index].shape[:2]
        return Seat(picture.size_px, (width, height))
    if len(heard.pictures) != 1:
        raise Unmatched(f"{len(heard.pictures)} of {len(request.pictures)} pictures arrived")
    place = re.search(rf'"{re.escape(picture.name)}": x (\d+) to (\d+), y (\d+) to (\d+)', heard.words)
    if place is None:
        raise Unmatched(f"the words do not say where on the sheet {picture.name!r} is")
    x0, x1, y0, y1 = map(float, place.groups())
    height, width = heard.pictures[0].shape[:2]
    return Seat(picture.size_px, (width, height), (x0, y0), (x1 - x0, y1 - y0))


def _check_picture(heard: Heard, request: Request, index: int) -> None:
    seat, picture = seat_of(heard, request, index), request.pictures[index]
    got = heard.pictures[index if len(heard.pictures) == len(request.pictures) else 0]
    width, height = (round(side) for side in seat.size or seat.received)
    x0, y0 = (round(value) for value in seat.origin)
    got = got[y0 : y0 + height, x0 : x0 + width]
    sent = picture.rgb
    if got.shape != sent.shape:
        got = cv2.resize(got, picture.size_px, interpolation=cv2.INTER_LINEAR)
    distance = np.abs(got[::3, ::3].astype(np.int16) - sent[::3, ::3]).max(axis=2)
    unscaled = (width, height) == picture.size_px
    near = RESIZED_LEVELS if not unscaled else JPEG_LEVELS if is_photo(sent) else 0
    same = float(np.mean(distance <= near))
    if same < SAME_SHARE:
        raise Unmatched(f"picture {picture.name!r} is another one: {same:.0%} of its pixels agree")


class Tapped:
    """A model whose requests are laid on a desk while they are under way."""

    def __init__(self, model: Any, desk: AgentSession) -> None:
        self._model = model
        self._desk = desk

    def __getattr__(self, name: str) -> Any:
        return getattr(self._model, name)

    async def answer(self, request: Request) -> Answer:
        self._desk.put(request)
        try:
            return as_answer(await self._model.answer(request), self._model)
        finally:
            self._desk.take(request)


def typed_brain(desk: AgentSession, answer: Callable[[Request], Any], speech: Speech) -> Brain:
    """A brain that answers the typed request, and says it in its own convention and the request's schema."""

    def brain(heard: Heard) -> Reply:
        request = desk.find(heard)
        return Reply(_spoken(request, answer(request), heard, speech))

    return brain


def _spoken(request: Request, result: Any, heard: Heard, speech: Speech) -> str:
    value, _ = validate_answer(request, result.value if isinstance(result, Answer) else result)
    view = getattr(request.question, "view", None)
    places = [index for index, picture in enumerate(request.pictures) if picture is view]
    seat = Seat((1, 1), (1, 1))
    if request.pictures:
        seat = seat_of(heard, request, places[0] if places else 0)
    return json.dumps(say(value.model_dump(mode="json"), heard.schema, speech, seat))


def offline_brain(desk: AgentSession, speech: Speech) -> Brain:
    """The real offline model behind the server."""
    from wonderful_team.offline import OfflineModel

    return typed_brain(desk, OfflineModel().answer, speech)


def scripted_brain(*texts: str) -> Brain:
    """Says these texts in turn; the last one for ever."""
    left = list(texts)

    def brain(heard: Heard) -> Reply:
        return Reply(left.pop(0) if len(left) > 1 else left[0])

    return brain
