"""Questions that only rivals ask: answered from the pixels shown."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from wonderful_team.contracts import ListObjects, SelectMarks
from wonderful_team.core.geometry import Frame
from wonderful_team.core.pictures import Candidates, Picture
from wonderful_team.core.values import Target
from wonderful_team.offline.answers.grounding import answer_select_marks
from wonderful_team.offline.answers.listing import answer_list_objects


def desk(mirrored: bool = False) -> Picture:
    """A red circle on the left and a blue square on the right, or the other way round."""
    rgb = np.full((480, 640, 3), (186, 178, 160), np.uint8)
    cv2.circle(rgb, (160, 300), 50, (200, 40, 40), -1, cv2.LINE_AA)
    cv2.rectangle(rgb, (400, 120), (520, 240), (30, 60, 190), -1)
    rgb = np.ascontiguousarray(rgb[:, ::-1]) if mirrored else rgb
    return Picture("top view", rgb, Frame.whole("top", (640, 480)))


MARKS = Candidates(((20.0, 20.0), (160.0, 345.0), (165.0, 305.0), (460.0, 180.0), (480.0, 305.0)))


@pytest.mark.parametrize(("mirrored", "first"), [(False, [3, 2]), (True, [5])])
def test_marks_on_the_thing_come_first_the_nearest_to_its_middle_before_the_others(
    mirrored: bool, first: list[int]
) -> None:
    asked = SelectMarks(Target("T1", "object", "red circle"), "pick", desk(mirrored).marked(MARKS), 2)
    assert answer_select_marks(asked).numbers[: len(first)] == first


def test_no_mark_is_selected_for_what_is_not_there() -> None:
    asked = SelectMarks(Target("T1", "object", "green star"), "pick", desk().marked(MARKS), 3)
    assert answer_select_marks(asked).numbers == []


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_list_says_what_is_seen_and_where(mirrored: bool) -> None:
    said = answer_list_objects(ListObjects(desk(mirrored)))
    found = {item.name: item.point.as_tuple for item in said.objects}
    red, blue = (160, 300), (460, 180)
    if mirrored:
        red, blue = (640 - red[0], red[1]), (640 - blue[0], blue[1])
    assert len(found) == 2
    assert next(at for name, at in found.items() if "red" in name) == pytest.approx(red, abs=6)
    assert next(at for name, at in found.items() if "blue" in name) == pytest.approx(blue, abs=6)


def test_an_empty_table_is_an_empty_list() -> None:
    plain = Picture("top view", np.full((480, 640, 3), 180, np.uint8), Frame.whole("top", (640, 480)))
    assert answer_list_objects(ListObjects(plain)).objects == []
