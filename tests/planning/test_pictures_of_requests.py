"""What holds for the pictures of every request that a trial sends: names, repeats, units, sizes, and how many there are."""

from __future__ import annotations

from collections import Counter
from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.simulated.tables import make_world
from wonderful_team.core.geometry import Frame
from wonderful_team.core.pictures import Axes, Picture
from wonderful_team.core.values import Request, Words
from wonderful_team.images.captions import size_words
from wonderful_team.models.conventions import PIXELS
from wonderful_team.models.wire import compose
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.runtime import rollout
from wonderful_team.simulated import SimulatedModel
from wonderful_team.simulated.profiles import PROFILES

TRIALS = (
    ("visual_manipulation", "lean"),
    ("visual_manipulation", "paper"),
    ("novel_adj", "lean"),
    ("rearrange", "lean"),
    ("twist", "lean"),
    ("follow_order", "lean"),
    ("sweep_without_touching", "lean"),
    ("pick_in_order_then_restore", "lean"),
)
MOST_BYTES = 1_000_000
"""Of one picture of the tabletop; vendors take 5 MB and more."""
MOST_SHARE = {"novel_adj": 0.45, "twist": 0.45, "follow_order": 0.8, "rearrange": 1.0}
"""Pictures sent at most, as a share of one for every view of the scene and of the instruction in every request of a plan."""


class Tap:
    """Keeps every request."""

    def __init__(self, model: Any) -> None:
        self.model, self.name = model, model.name
        self.requests: list[Request] = []

    def estimate(self, request: Request) -> Any:
        return self.model.estimate(request)

    async def answer(self, request: Request) -> Any:
        self.requests.append(request)
        return await self.model.answer(request)


@cache
def sent(task: str, mode: str) -> tuple[tuple[Request, ...], int]:
    """Every request of one trial with tick labels on whole views, and how many views the task has."""
    world = make_world(task, seed=500)
    try:
        # An answerer that errs sees the questions that a right one is not asked.
        profile = "perfect" if mode == "lean" else "coarse"
        tap = Tap(SimulatedModel(world.privileged, world.instruction, PROFILES[profile]))
        team = TeamPolicy({"*": tap}, TeamConfig(mode=mode, axes=True))  # type: ignore[arg-type]
        rollout(team, world, scorer=world.privileged, seed=500, max_age_s=None)
        views = 2 + sum(len(slot.views) for slot in world.instruction.slots.values())
        return tuple(request for request in tap.requests if request.pictures), views
    finally:
        world.close()


EVERY = pytest.mark.parametrize(("task", "mode"), TRIALS)


@EVERY
def test_no_two_pictures_of_a_request_share_a_name(task: str, mode: str) -> None:
    for request in sent(task, mode)[0]:
        twice = [name for name, count in Counter(picture.name for picture in request.pictures).items() if count > 1]
        assert not twice, (request.id, twice)


@EVERY
def test_no_request_shows_the_same_twice(task: str, mode: str) -> None:
    for request in sent(task, mode)[0]:
        drawn = [piece for piece in compose(request, PIXELS).pieces if isinstance(piece, bytes)]
        assert len(set(drawn)) == len(drawn), request.id
        unmarked = [picture.hash for picture in request.pictures if not picture.marks]
        marked = {picture.hash for picture in request.pictures if picture.marks}
        assert len(set(unmarked)) == len(unmarked), request.id
        assert not marked & set(unmarked), request.id


@EVERY
def test_positions_are_stated_in_the_unit_that_is_asked_for_and_in_no_other(task: str, mode: str) -> None:
    for request in sent(task, mode)[0]:
        asked = [part.picture for part in request.parts if isinstance(part, Words) and part.says == "positions"]
        assert len(asked) <= 1
        named = [axes_frame(picture, mark) for picture in request.pictures for mark in picture.mark(Axes)]
        for frame in named[1:]:
            assert same_unit(frame, named[0]), request.id
        if asked and named:
            assert asked[0] is not None
            assert same_unit(asked[0].frame, named[0]), request.id


def axes_frame(picture: Picture, mark: Any) -> Frame:
    """The frame whose pixels a picture's tick labels name."""
    return mark.reference or picture.frame


def same_unit(one: Frame, other: Frame) -> bool:
    return one.size_px == other.size_px and np.allclose(one.T_view_picture, other.T_view_picture)


@EVERY
def test_every_picture_is_announced_with_its_size_and_is_no_larger_than_servers_take(task: str, mode: str) -> None:
    for request in sent(task, mode)[0]:
        for before, part in zip(request.parts, request.parts[1:], strict=False):
            if isinstance(part, Picture):
                assert isinstance(before, Words)
                assert f'Picture "{part.name}" ({size_words(part.size_px)})' in before.text
                assert max(part.size_px) <= 1568
        pieces = compose(request, PIXELS).pieces
        assert max(len(piece) for piece in pieces if isinstance(piece, bytes)) < MOST_BYTES


@EVERY
def test_whole_views_with_marks_are_large(task: str, mode: str) -> None:
    for request in sent(task, mode)[0]:
        for picture in request.pictures:
            whole = picture.frame.view_id == "top" and not picture.frame.T_view_picture[:2, 2].any()
            # The small whole view beside a crop only tells which of several things is meant.
            if picture.name.startswith("whole view with the box"):
                continue
            if whole and picture.marks and picture.size_px[0] > 2 * picture.size_px[1] - 2:
                assert max(picture.size_px) >= 1280, (request.id, picture.name)


@pytest.mark.parametrize(("task", "share"), MOST_SHARE.items())
def test_fewer_pictures_are_sent_than_there_are_views(task: str, share: float) -> None:
    requests, views = sent(task, "lean")
    plans = [request for request in requests if request.contract in ("DraftPlan", "ReviewPlan", "ReviewSteps")]
    assert plans
    for request in plans:
        assert len(request.pictures) <= share * (views + (request.contract == "ReviewSteps"))
