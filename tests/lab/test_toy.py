"""The toy table: its circle is as large as the paper's, and its four kinds of boxes are what the paper calls them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from wonderful_team.core.geometry import Box
from wonderful_team.lab.toy import BOX_KINDS, RADIUS_PX, RIGHT, SIDE_PX, ToyTable

SEEDS = range(3000, 3060)


def test_the_same_seed_draws_the_same_table() -> None:
    assert np.array_equal(ToyTable(7).view.rgb, ToyTable(7).view.rgb)
    assert not np.array_equal(ToyTable(7).view.rgb, ToyTable(8).view.rgb)
    assert ToyTable(7).box("around") == ToyTable(7).box("around")


def test_the_target_is_a_circle_of_50_px_and_the_only_one_of_its_words() -> None:
    for seed in SEEDS:
        table = ToyTable(seed)
        assert table.target.shape == "circle"
        assert [thing.words for thing in table.things].count(table.target.words) == 1
        assert table.target.mask.sum() == pytest.approx(math.pi * RADIUS_PX**2, rel=0.01)
        assert sum(thing.mask.astype(int) for thing in table.things).max() == 1, "no shape covers another"


def test_boxes_are_what_their_kind_says() -> None:
    whole = Box(0, 0, SIDE_PX, SIDE_PX)
    for seed in SEEDS:
        table = ToyTable(seed)
        right = table.target.box
        boxes = {kind: table.box(kind) for kind in BOX_KINDS}
        assert all(box == box.intersection(whole) for box in boxes.values())
        assert boxes["perfect"] == right
        assert 0.0 < boxes["slightly_off"].iou(right) < 0.75
        assert boxes["around"].intersection(right) is None
        assert math.dist(boxes["around"].centre, right.centre) <= 4.0 * RADIUS_PX + 1e-9
        assert boxes["wrong_object"] in [thing.box for thing in table.things[1:]]
    assert set(RIGHT.values()) == {"accept", "revise", "reject"}


def test_nothing_is_moved_there() -> None:
    table = ToyTable(1)
    report = table.execute(None)  # type: ignore[arg-type]
    assert not report.executed
    assert report.fault is not None
    assert table.privileged.score().success is None
