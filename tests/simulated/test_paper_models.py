"""The error models of the paper's three models err as often and as far as the paper measured."""

from __future__ import annotations

import asyncio
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from wonderful_team.contracts import BoxMove, BoxPx, JudgeBox, MoveBox, PointPx
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Picture
from wonderful_team.core.values import Request, Target, View
from wonderful_team.errors import ConfigError
from wonderful_team.images import crop, whole
from wonderful_team.simulated.error_sampler import ErrorSampler, ring_distance
from wonderful_team.simulated.model import SimulatedModel
from wonderful_team.simulated.paper_models import FARTHEST_RADII, PAPER_MODELS, RADIUS
from wonderful_team.simulated.profile import Judgement, Profile

from .tables import set_table

SIDE_PX = 1000
RADIUS_PX = 50.0
TRIES = 4000


def toy_picture() -> Picture:
    return whole(View("toy", "toy", 0.0, np.zeros((SIDE_PX, SIDE_PX, 3), np.uint8)), "toy view")


def sampler(profile: Profile, number: int = 0) -> ErrorSampler:
    return ErrorSampler(profile, Request(f"toy/{number}", "ground", "any", None, (), BoxMove))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "within"),
    [("paper-gpt-4o", (33, 89, 97)), ("paper-gpt-4-turbo", (5, 46, 68)), ("paper-claude-3-opus", (4, 19, 58))],
)
def test_points_lie_within_1_3_and_4_radii_as_often_as_in_the_paper(name: str, within: tuple[int, ...]) -> None:
    picture, middle = toy_picture(), PointPx(x=SIDE_PX / 2, y=SIDE_PX / 2)
    errs = sampler(PAPER_MODELS[name])
    points = np.array([errs.point(middle, picture, str(number)).as_tuple for number in range(TRIES)])
    off_px = np.hypot(*(points - SIDE_PX / 2).T)
    for radii, percent in zip((1, 3, 4), within, strict=True):
        assert 100 * np.mean(off_px <= radii * RADIUS_PX) == pytest.approx(percent, abs=3.0)
    assert off_px.max() <= FARTHEST_RADII * RADIUS_PX + 1e-6
    assert np.abs((points - SIDE_PX / 2).mean(0)).max() < 0.2 * off_px.mean(), "in every direction alike"


def test_errors_within_a_ring_are_even_over_its_area() -> None:
    radial = ((1.0, 0.5), (3.0, 1.0))
    shares = (np.arange(1000) + 0.5) / 1000
    distances = np.array([ring_distance(radial, share) for share in shares])
    assert np.mean(distances <= 0.5**0.5) == pytest.approx(0.25, abs=0.002)
    assert np.mean(distances <= 5.0**0.5) == pytest.approx(0.75, abs=0.002)


@pytest.mark.parametrize("name", sorted(PAPER_MODELS))
def test_boxes_are_judged_by_the_matrix_of_the_paper(name: str) -> None:
    """Whole questions: a box that is right, off, beside and on another thing, asked about many times."""
    profile, asked = PAPER_MODELS[name], 150
    with set_table("visual_manipulation", 500) as table:
        target, other = table.targets()
        model = SimulatedModel(
            table.world.privileged, table.world.instruction, replace(profile, missed=0, wrong_thing=0, imagined=0)
        )
        view = table.scene.view
        right = table.given_box(target)
        elsewhere = table.given_box(other)
        shown = {"tight": right, "off": right.shifted(0.3 * right.width, 0.0), "elsewhere": elsewhere}
        for state, box in shown.items():
            picture = crop(view, box, "crop")
            marked = picture.marked(BoxMark(picture.frame.box_to_picture(box)))
            said: Counter[str] = Counter()
            for number in range(asked):
                question = JudgeBox(target, marked)
                request = Request(f"{number}/judge", "ground", "checker", question, (marked,), question.output())
                said[asyncio.run(model.answer(request)).value.decision] += 1
            rates = getattr(profile.judgement, state)
            for word, rate in zip(("accept", "revise", "reject"), rates, strict=True):
                assert said[word] / asked == pytest.approx(rate, abs=0.12), (state, word, said)


def test_a_correction_errs_by_a_share_of_itself() -> None:
    move = BoxMove.model_validate(
        {
            "reasoning": "", "action": "move", "right_px": 40.0, "down_px": 0.0, "grow_left_px": 0.0,
            "grow_top_px": 0.0, "grow_right_px": 0.0, "grow_bottom_px": 0.0, "cut_edges": [],
        }
    )  # fmt: skip
    profile = PAPER_MODELS["paper-gpt-4o"]
    request = asked_to_move(Box(400, 400, 600, 600))
    moved = [ErrorSampler(replace(profile, seed=seed), request).perturb(move, request) for seed in range(500)]
    right = np.array([one.right_px for one in moved])
    assert right.mean() == pytest.approx(40.0, abs=2.0)
    assert right.std() == pytest.approx(profile.correction * 40.0, rel=0.15)
    assert all(one.down_px == 0.0 for one in moved)


def asked_to_move(box: Box) -> Request:
    """A request about a box on the toy table."""
    shown = toy_picture().marked(BoxMark(box))
    question = MoveBox(Target("T1", "object", "red circle"), shown, ())
    return Request("x", "ground", "mover", question, (shown,), BoxMove)


@pytest.mark.parametrize("action", ["move", "resize"])
def test_a_correction_never_leaves_the_picture_nor_turns_a_box_inside_out(action: str) -> None:
    """Far off, or as narrow as it goes: errors of the profile's size would make of it what no answer may be."""
    amounts = {"right_px": 380.0, "down_px": 0.0} if action == "move" else {"right_px": 0.0, "down_px": 0.0}
    grow = -18.0 if action == "resize" else 0.0
    move = BoxMove.model_validate(
        {
            "reasoning": "", "action": action, **amounts, "grow_left_px": grow, "grow_top_px": 0.0, "grow_right_px": grow,
            "grow_bottom_px": 0.0, "cut_edges": [],
        }
    )  # fmt: skip
    request = asked_to_move(Box(560, 400, 600, 600))
    profile = replace(PAPER_MODELS["paper-gpt-4o"], correction=1.0)
    moved = [ErrorSampler(replace(profile, seed=seed), request).perturb(move, request) for seed in range(200)]
    assert len({(one.right_px, one.grow_left_px) for one in moved}) > 50
    for one in moved:
        request.question.validate(one)


def test_a_box_and_its_points_lie_off_together() -> None:
    """One look tells where a thing is."""
    picture, errs = toy_picture(), sampler(replace(PAPER_MODELS["paper-gpt-4-turbo"], edge=0.0))
    middle, box = PointPx(x=500, y=500), Box(450, 450, 550, 550)
    moved = errs.box(BoxPx.of(box, picture), picture, "T1")
    point = errs.point(middle, picture, "T1")
    assert moved is not None
    assert moved.as_box.centre == pytest.approx(point.as_tuple)
    assert point.as_tuple != middle.as_tuple


def test_what_was_not_measured_is_the_same_for_all_three() -> None:
    free = ("missed", "imagined", "wrong_thing", "wrong_choice", "wrong_plan", "overlooks", "edge", "correction")
    assert len({tuple(getattr(profile, name) for name in free) for profile in PAPER_MODELS.values()}) == 1
    assert RADIUS * np.hypot(SIDE_PX, SIDE_PX) == pytest.approx(RADIUS_PX)


@pytest.mark.parametrize("radial", [((1.0, 0.5),), ((2.0, 0.5), (1.0, 1.0)), ((1.0, 0.5), (2.0, 0.4), (3.0, 1.0))])
def test_distances_that_do_not_rise_to_all_points_are_refused(radial: tuple[tuple[float, float], ...]) -> None:
    with pytest.raises(ConfigError, match="radial of profile 'own'"):
        Profile("own", radial=radial)


def test_rates_that_do_not_sum_to_1_are_refused() -> None:
    with pytest.raises(ConfigError, match="judgement of off boxes"):
        Judgement(off=(0.5, 0.5, 0.5))
