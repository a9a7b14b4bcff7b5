"""A model is measured on pictures as large as the team sends them."""

from __future__ import annotations

import asyncio

from wonderful_team.contracts import JudgeBox, ReadScene
from wonderful_team.core.pictures import Axes
from wonderful_team.core.values import Answer, Request
from wonderful_team.images.cut import MARKED_SIDE_PX
from wonderful_team.lab.asking import Bench
from wonderful_team.lab.measure import measure_errors
from wonderful_team.lab.probe import CHECK_SIZES
from wonderful_team.models.budget import Budget
from wonderful_team.offline import OfflineModel


class Heard(OfflineModel):
    """Keeps what it is asked."""

    def __init__(self) -> None:
        super().__init__()
        self.requests: list[Request] = []

    def answer(self, request: Request) -> Answer:
        self.requests.append(request)
        return super().answer(request)


def test_errors_are_measured_on_views_as_the_team_sends_them() -> None:
    model = Heard()
    bench = Bench(lambda profile, thinking: model, False, Budget())
    asyncio.run(measure_errors(bench, model, 1, labelled=True))
    (found,) = [one.question for one in model.requests if isinstance(one.question, ReadScene)]
    assert max(found.view.size_px) >= MARKED_SIDE_PX
    judged = [one.question for one in model.requests if isinstance(one.question, JudgeBox)]
    assert judged
    for question in judged:
        (axes,) = [mark for mark in question.crop.marks if isinstance(mark, Axes)]
        assert axes.reference is not None
        assert max(axes.reference.size_px) >= MARKED_SIDE_PX


def test_the_convention_is_checked_on_main_views_and_on_a_crop() -> None:
    assert [max(size) for size in CHECK_SIZES] == [MARKED_SIDE_PX, MARKED_SIDE_PX, 560]
