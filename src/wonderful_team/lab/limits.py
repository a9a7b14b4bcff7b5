"""What a service can do: pictures per request, schemas, thinking. Each is found by trying it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from wonderful_team.agents import build_request
from wonderful_team.contracts import ReadScene
from wonderful_team.core.protocols import Model
from wonderful_team.core.values import Answer, Request, Words
from wonderful_team.errors import BudgetReached, RequestRejectedError, WonderfulTeamError
from wonderful_team.lab.asking import Bench, Loose, look
from wonderful_team.lab.fit import WILD
from wonderful_team.lab.marks import marked_scene
from wonderful_team.models.profiles import Profile, Schemas, Thinking

SMALL = (448, 336)
"""Size of the pictures of these trials: they cost little."""
LEAST_RIGHT = 0.6
"""Least share of the marks that must be pointed at for an answer to count as right."""
TRIES = 3
"""How often so many pictures are tried before wrong answers count as a limit."""
UNCONSTRAINED = "This one time, begin your reply with the word READY on a line of its own, before anything else. Only then give the answer."
"""What a service that enforces schemas cannot do, and most models without one will."""


async def picture_limit(
    bench: Bench, profile: Profile, most: int, seed: int, tell: Callable[[str], None]
) -> tuple[int, bool]:
    """The largest number of pictures in one request that was answered rightly, and whether it is the limit.

    The picture that the answer is about stands first in one trial and last in another, so that a service that drops
    pictures without a word is noticed.
    """
    best = 1
    while best < most:
        count = min(best * 2, most)
        right, told = await _holds(bench, profile, count, seed)
        tell(_told(profile, count, right))
        if right:
            best = count
            continue
        return await _between(bench, profile, best, count, told, seed, tell), True
    return best, False


async def _between(
    bench: Bench, profile: Profile, good: int, bad: int, told: int | None, seed: int, tell: Callable[[str], None]
) -> int:
    """The largest number from `good` up to below `bad` that holds; what the service told is tried first."""
    while bad - good > 1:
        middle = told if told is not None and good < told < bad else (good + bad) // 2
        right, told = await _holds(bench, profile, middle, seed)
        tell(_told(profile, middle, right))
        if right:
            good, told = middle, None
        else:
            bad = middle
    return good


async def _holds(bench: Bench, profile: Profile, count: int, seed: int) -> tuple[bool, int | None]:
    """Whether a request with so many pictures is answered rightly, and the limit that the service told, if it did.

    A model that errs now and then points wrongly now and then: that alone is no limit, so what was answered and wrong is tried
    with other pictures before it counts.
    """
    told: int | None = None
    for attempt in range(TRIES):
        right, told, refused = await _once(bench, profile, count, seed + 100 * attempt)
        if right or refused:
            return right, told
    return False, told


async def _once(bench: Bench, profile: Profile, count: int, seed: int) -> tuple[bool, int | None, bool]:
    """Whether it is answered rightly, the limit that the service told, and whether it was refused or not answered at all."""
    scene = marked_scene(seed + count, SMALL, background="plain", absent=2, name="the one to answer")
    also = [
        marked_scene(seed + 50 + k, SMALL, background="plain", absent=7, name=f"another {k + 1}").picture
        for k in range(count - 1)
    ]
    for last in (True, False):
        # A fresh model each time: providers remember what a service refused.
        model = bench.model(replace(profile, max_pictures=None) if bench.provider else None)
        try:
            seen = await look(bench, model, scene, labelled=profile.axes, also=also, last=last)
        except BudgetReached:
            raise
        except RequestRejectedError:
            return False, None, True
        told = getattr(model, "picture_limit", None)
        if isinstance(told, int) and told < count:
            return False, told, True
        if not profile.native_points:
            # Where it points says nothing then; that it points at all says that the request was taken.
            if not seen.answered:
                return False, None, True
            continue
        limit = WILD * float(np.hypot(*scene.picture.size_px))
        if np.mean(np.nan_to_num(seen.errors_px, nan=np.inf) <= limit) < LEAST_RIGHT:
            return False, None, False
    return True, None, False


def _told(profile: Profile, count: int, right: bool) -> str:
    """How a trial went; where a model points says nothing of one that no convention fits."""
    how = "answered rightly" if profile.native_points else "answered"
    return f"{count} pictures in one request: {how if right else f'not {how}'}"


async def schema_kept(bench: Bench, profile: Profile, seed: int) -> Schemas:
    """Whether the service holds answers to their schema, even when the words ask for more than it allows."""
    model = bench.model(profile)
    request = build_request(_question(seed), id="probe/schema", stage="other")
    asked = replace(request, question=Loose(_question(seed)), parts=(*request.parts, Words(UNCONSTRAINED)))
    try:
        answer: Answer | None = await bench.ask(model, asked)
    except BudgetReached:
        raise
    except WonderfulTeamError:
        answer = None
    if getattr(model, "schemas_refused", False):
        return "refused"
    raw = [answer.raw] if answer is not None else []
    if any(not _is_json(text) for text in raw + [other.raw for other in bench.answers if other.raw]):
        return "ignored"
    return "enforced" if raw else "unknown"


async def thinking_kind(bench: Bench, profile: Profile, seed: int) -> Thinking:
    """Whether it thinks when nothing is said about it, and whether it can be told not to."""
    if not bench.answers:
        return "unknown"
    if not any(_thought(answer) for answer in bench.answers):
        return "never"
    try:
        model: Model = bench.model(profile, "off")
        answer = await bench.ask(model, replace(_request(seed), question=Loose(_question(seed))))
    except BudgetReached:
        raise
    except RequestRejectedError:
        return "always"
    except WonderfulTeamError:
        return "unknown"
    return "always" if _thought(answer) or getattr(model, "thinking_refused", False) else "switchable"


def _question(seed: int) -> ReadScene:
    scene = marked_scene(seed + 40, SMALL, background="plain", absent=5)
    return ReadScene(scene.targets(), (), scene.picture)


def _request(seed: int) -> Request:
    return build_request(_question(seed), id="probe/thinking", stage="other")


def _thought(answer: Answer) -> bool:
    return answer.usage.tokens_thinking > 0 or any("thinking" in repair for repair in answer.repairs)


def _is_json(text: str) -> bool:
    try:
        return isinstance(json.loads(text), dict)
    except ValueError:
        return False
