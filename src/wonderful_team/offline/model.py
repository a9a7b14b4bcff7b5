"""The offline model: answers each question from the pixels, marks and words that it shows, and nothing else."""

from __future__ import annotations

import os
import threading

from wonderful_team.core.caps import Estimate
from wonderful_team.core.pictures import with_pictures
from wonderful_team.core.values import Answer, Request, Usage
from wonderful_team.errors import ModelOutputError, UnsupportedQuestion
from wonderful_team.offline.answers import ANSWERS, SAMPLED
from wonderful_team.offline.vision import NotSeen, in_plain_light

MODEL_ID = "offline"
_turns = threading.BoundedSemaphore(max(2, min(8, os.cpu_count() or 2)))
"""As many look at pictures at once as there are processors: more would only hold more memory."""


class OfflineModel:
    """Classical vision and a grammar: no key, no weights, no network, no memory between requests.

    It reads `request.question` (everything in it is shown) and the pictures it holds. Text inside pictures is data:
    prices and numbers are read where the instruction ranks things by price, and nothing else ever is.
    """

    name = MODEL_ID

    def estimate(self, request: Request) -> Estimate:
        """What a request may cost: nothing, answered or not."""
        return Estimate(0, 0, 0.0, 0.0)

    def answer(self, request: Request) -> Answer:
        """Answer one request.

        Raises:
            NotUnderstoodError: The words hold something it does not know; says which.
            UnsupportedQuestion: A kind of question that classical vision cannot answer.
        """
        kind = type(request.question)
        if kind not in ANSWERS:
            raise UnsupportedQuestion(
                self.name, request.contract, "classical vision has no answer to questions of this kind"
            )
        try:
            with _turns:
                question = with_pictures(request.question, in_plain_light)
                value = ANSWERS[kind](question, request.sample) if kind in SAMPLED else ANSWERS[kind](question)
        except NotSeen as error:
            raise ModelOutputError(f"model 'offline' could not answer {request.contract}: {error}") from error
        value, repairs = request.question.validate(value)
        usage = Usage(calls=1, pictures=len(request.pictures), usd=0.0)
        return Answer(value, usage, MODEL_ID, value.model_dump_json(), 1, "offline", repairs)
