"""The paper's rule for a grounded point, on shapes whose shares are known."""

from __future__ import annotations

import numpy as np
import pytest

from wonderful_team.lab.label_rule import LabelRule

SQUARE = np.zeros((60, 100), bool)
SQUARE[20:40, 30:50] = True
RING = SQUARE.copy()
RING[25:35, 35:45] = False


@pytest.mark.parametrize(
    ("point", "share"),
    [((40, 30), 1.0), ((30, 30), 0.5), ((50, 30), 0.5), ((30, 20), 0.25), ((25, 30), 0.0), ((80, 50), 0.0)],
)
def test_the_share_of_the_label_on_the_object(point: tuple[float, float], share: float) -> None:
    assert LabelRule(4, 0).share_inside(point, SQUARE) == pytest.approx(share, abs=0.02)


def test_half_of_the_label_is_enough_and_less_is_not() -> None:
    rule = LabelRule(4, 0)
    assert rule.holds((30.1, 30), SQUARE)
    assert not rule.holds((29.5, 30), SQUARE)


def test_a_point_near_the_middle_counts_though_it_lies_in_a_hole() -> None:
    assert not LabelRule(2, 0).holds((41, 31), RING)
    assert LabelRule(2, 3).holds((41, 31), RING)
    assert not LabelRule(2, 1).holds((41, 31), RING)


def test_what_sticks_out_of_the_view_is_not_on_the_object() -> None:
    everywhere = np.ones((60, 100), bool)
    assert LabelRule(4, 0).share_inside((0, 30), everywhere) == pytest.approx(0.5, abs=0.02)
    assert LabelRule(4, 0).share_inside((500, 500), everywhere) == 0.0


def test_nothing_that_does_not_show_is_hit() -> None:
    assert not LabelRule(4, 1000).holds((40, 30), np.zeros((60, 100), bool))


@pytest.mark.parametrize(("radius", "reach"), [(0, 1), (-1, 1), (float("nan"), 1), (1, -1)])
def test_a_rule_without_a_size_is_refused(radius: float, reach: float) -> None:
    with pytest.raises(ValueError, match="radius must be positive and range 0 px or more"):
        LabelRule(radius, reach)
