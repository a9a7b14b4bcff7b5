"""What counts as a five-pointed star, judged on the ink alone: right ones, and many that are not."""

from __future__ import annotations

import math

import numpy as np
import pytest

import wonderful_team as wt
from tests.sims.arms.needed import needs_arms
from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.arms import ArmWorld
from wonderful_team.sims.arms.drawing import Drawing
from wonderful_team.sims.arms.star import star_points, star_problem
from wonderful_team.sims.tabletop.model import Thing

CENTRE = (0.48, 0.05)
PAPER = Thing("paper", "paper", "green paper", *CENTRE, 0.0)


def inked(corners: Array, seed: int = 0, shake_m: float = 0.0007) -> Array:
    """A line as a pen leaves it: a point every millimetre, not quite straight."""
    rng = np.random.default_rng(seed)
    parts = []
    for one, other in zip(corners[:-1], corners[1:], strict=True):
        count = max(2, round(float(np.linalg.norm(other - one)) / 0.001))
        parts.append(one + np.linspace(0, 1, count, endpoint=False)[:, None] * (other - one))
    line = np.vstack([*parts, corners[-1:]])
    return line + rng.normal(0.0, shake_m, line.shape)


def ring(count: int, reach_m: float = 0.06, leap: int = 1, turn: float = 0.3) -> Array:
    """Corners of a polygon, or of a star that leaps over some."""
    angles = [turn + 2 * math.pi * k * leap / count for k in range(count + 1)]
    return np.array([(CENTRE[0] + reach_m * math.cos(a), CENTRE[1] + reach_m * math.sin(a)) for a in angles])


@pytest.mark.parametrize("turn", [0.0, 0.4, math.pi])
@pytest.mark.parametrize("reach_m", [0.03, 0.065])
def test_outlined_and_crossing_stars_count(turn: float, reach_m: float) -> None:
    assert star_problem([inked(star_points(CENTRE, reach_m, turn))]) == ""
    assert star_problem([inked(ring(5, reach_m, 2, turn))]) == ""


def test_strokes_that_meet_count_as_one_line_in_any_order_and_direction() -> None:
    line = star_points(CENTRE, 0.06)
    parts = [inked(line[0:3]), inked(line[6:11])[::-1], inked(line[2:7])]
    assert star_problem(parts) == ""


def bulging() -> Array:
    line = inked(star_points(CENTRE, 0.065))
    share = np.linspace(0, 20 * math.pi, len(line))
    return line + 0.012 * np.column_stack([np.sin(share), np.cos(share)])


def star_of(count: int, inner: float = 0.45, reach_m: float = 0.06) -> Array:
    angles = [math.pi * k / count for k in range(2 * count + 1)]
    radii = [reach_m if k % 2 == 0 else reach_m * inner for k in range(2 * count + 1)]
    return np.array(
        [(CENTRE[0] + r * math.cos(a), CENTRE[1] + r * math.sin(a)) for r, a in zip(radii, angles, strict=True)]
    )


def uneven() -> Array:
    line = star_points(CENTRE, 0.06).copy()
    line[2] = line[2] + (line[2] - np.array(CENTRE)) * 0.6
    return line


@pytest.mark.parametrize(
    ("strokes", "why"),
    [
        ([inked(ring(5))], "pentagon"),
        ([inked(ring(4))], "4 corners"),
        ([inked(ring(40))], "corners or bends|% of the tips' distance"),
        ([inked(star_of(4))], "8 corners"),
        ([inked(star_of(6))], "12 corners"),
        ([inked(star_points(CENTRE, 0.06)[:-1])], "not closed"),
        ([inked(star_points(CENTRE, 0.06)[:6]), inked(star_points(CENTRE, 0.06)[7:])], "not closed"),
        ([inked(star_points(CENTRE, 0.018))], "corners|mm from its middle"),
        ([inked(star_of(5, 0.85))], "% of the tips' distance|corners"),
        ([inked(uneven())], "unevenly|degrees from evenly"),
        ([bulging()], "corners or bends|degrees|unevenly|distance"),
    ],
    ids=["pentagon", "square", "circle", "four", "six", "open", "missing edge", "tiny", "blunt", "uneven", "wavy"],
)
def test_what_is_no_five_pointed_star(strokes: list[Array], why: str) -> None:
    problem = star_problem(strokes)
    assert problem
    assert any(word in problem for word in why.split("|")), problem


def drawn(strokes: list[Array]) -> tuple[bool | None, str]:
    work = Drawing(PAPER, star_problem, lambda poses: star_points(CENTRE, 0.06))
    work.strokes = [[(float(x), float(y)) for x, y in stroke] for stroke in strokes]
    score = work.score({"paper": Pose.at((*CENTRE, 0.0))})
    return score.success, score.reason


def test_the_ink_must_lie_on_the_paper() -> None:
    right = inked(star_points(CENTRE, 0.06))
    assert drawn([right])[0]
    success, reason = drawn([right + np.array([0.05, 0.0])])
    assert success is False
    assert "outside the paper" in reason
    assert drawn([]) == (False, "there is no line of ink")
    # A mark beside the star is ink that nobody asked for.
    assert drawn([right, inked(np.array([[0.50, 0.05], [0.52, 0.05]]))])[0] is False


def test_nothing_can_be_done_about_a_wrong_drawing() -> None:
    work = Drawing(PAPER, star_problem, lambda poses: star_points(CENTRE, 0.06))
    poses = {"paper": Pose.at((*CENTRE, 0.0))}
    assert [action.kind for action in work.oracle(poses)] == ["trajectory", "home"]
    work.strokes = [[(float(x), float(y)) for x, y in inked(ring(5))]]
    assert work.oracle(poses) == []


@needs_arms
def test_a_pen_that_is_led_over_noisy_depth_does_not_lift_off() -> None:
    world = ArmWorld("star@depth=2", 5000)
    try:
        trial = wt.rollout(wt.Team(model="offline"), world)
        assert trial.outcome == "success", trial.reason
        work = world._table.work
        assert isinstance(work, Drawing)
        (line,) = work.ink
        assert len(line) > 300
    finally:
        world.close()
