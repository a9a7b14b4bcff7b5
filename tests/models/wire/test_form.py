"""An answer in each family's own format: schema, numbers, names, and the way back to our pixels."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.models.wire.scenes import answer_px, picture, reading
from tests.models.wire.writing import written
from wonderful_team.contracts import PlanDraft, Points, SceneReading
from wonderful_team.contracts.give_box import BoxAnswer
from wonderful_team.models.conventions import CONVENTIONS, Convention
from wonderful_team.models.wire import Form, compose

NAMES = sorted(CONVENTIONS)


def back(form: Form, value: Any, size: tuple[int, int]) -> Any:
    return form.read(value, lambda pairs: form.convention.to_px(pairs, size))


@settings(deadline=None, max_examples=60)
@given(st.sampled_from(NAMES), st.tuples(st.integers(60, 1500), st.integers(60, 1500)))
def test_an_answer_comes_back_from_every_family(name: str, size: tuple[int, int]) -> None:
    view = picture(size)
    form = Form.of(SceneReading, CONVENTIONS[name])
    spoken = json.loads(json.dumps(written(form, answer_px(view), size)))
    got = SceneReading.model_validate(back(form, spoken, size))
    want = SceneReading.model_validate(answer_px(view))
    assert got.targets[0].box is not None
    assert want.targets[0].box is not None
    # Numbers are written with three digits after the point.
    slack = 2 * max(size) / 1000
    assert got.targets[0].box.as_box.as_tuple == pytest.approx(want.targets[0].box.as_box.as_tuple, abs=slack)
    assert got.targets[1].box is None


@pytest.mark.parametrize(
    ("name", "spoken", "box"),
    [
        ("gemini", {"reasoning": "", "box_2d": [250, 100, 500, 300]}, (64, 120, 192, 240)),
        ("qwen3-vl", {"reasoning": "", "bbox_2d": [100, 250, 300, 500]}, (64, 120, 192, 240)),
        ("claude", {"reasoning": "", "box": [64, 120, 192, 240]}, (64, 120, 192, 240)),
        (
            "moondream",
            {"reasoning": "", "box": {"x_min": 0.1, "y_min": 0.25, "x_max": 0.3, "y_max": 0.5}},
            (64, 120, 192, 240),
        ),
        ("molmo1", {"reasoning": "", "box": [10, 25, 30, 50]}, (64, 120, 192, 240)),
    ],
)
def test_each_family_is_read_as_it_speaks(name: str, spoken: Any, box: tuple[float, ...]) -> None:
    form = Form.of(BoxAnswer, CONVENTIONS[name])
    assert set(spoken) == set(form.schema["properties"])
    got = BoxAnswer.model_validate(back(form, spoken, (640, 480)))
    assert got.box is not None
    assert got.box.as_box.as_tuple == pytest.approx(box)


@pytest.mark.parametrize(
    "box",
    [
        ["64", "120", "192", "240"],
        {"x0": 64, "y0": 120, "x1": 192, "y1": 240},
        {"x1": 64, "y1": 120, "x2": 192, "y2": 240},
        [[64, 120], [192, 240]],
        [[64, 120, 192, 240]],
        "[64, 120, 192, 240]",
        {"bbox": [64, 120, 192, 240], "label": "disc"},
    ],
)
def test_other_ways_of_writing_a_box_are_understood(box: Any) -> None:
    form = Form.of(BoxAnswer, CONVENTIONS["gpt"])
    got = BoxAnswer.model_validate(back(form, {"reasoning": "", "box": box}, (640, 480)))
    assert got.box is not None
    assert got.box.as_box.as_tuple == pytest.approx((64, 120, 192, 240))


@pytest.mark.parametrize("box", [[1, 2, 3], [1, 2, 3, 4, 5], "left", {"x": 1}, [1, 2, 3, "a"], [True, 1, 2, 3], 7])
def test_a_box_that_is_none_is_sent_back_with_what_would_be_valid(box: Any) -> None:
    form = Form.of(BoxAnswer, CONVENTIONS["gemini"])
    with pytest.raises(ValueError, match=r"answer\.box_2d: expected \[ymin, xmin, ymax, xmax\] in thousandths"):
        back(form, {"reasoning": "", "box_2d": box}, (640, 480))


@pytest.mark.parametrize("number", [float("inf"), float("nan"), "nan", "1e999"])
def test_a_number_that_is_not_finite_is_refused(number: Any) -> None:
    form = Form.of(Points, CONVENTIONS["gpt"])
    with pytest.raises(ValueError, match="finite"):
        back(form, {"reasoning": "", "found": True, "points": [[number, 3]]}, (640, 480))


def test_the_schema_states_unit_and_order_and_never_says_pixels_of_thousandths() -> None:
    text = Form.of(SceneReading, CONVENTIONS["gemini"]).text
    assert "[ymin, xmin, ymax, xmax] in thousandths of width and height (0 to 1000)" in text
    assert '"box_2d"' in text
    assert "pixel" not in text.lower()
    assert "Px" not in text


def test_answers_without_places_are_plain_and_kept() -> None:
    form = Form.of(PlanDraft, CONVENTIONS["gemini"])
    assert not form.has_places
    assert compose(reading(picture()), CONVENTIONS["gemini"]).form.has_places


def test_an_offset_and_scale_that_were_measured_are_undone() -> None:
    odd = Convention("odd", "yx", "thousandths", offset_px=(4, -3), scale=(1.1, 0.9))
    form = Form.of(BoxAnswer, odd)
    spoken = written(form, {"reasoning": "", "box": {"x0": 10, "y0": 20, "x1": 30, "y1": 40}}, (640, 480))
    got = BoxAnswer.model_validate(back(form, spoken, (640, 480)))
    assert got.box is not None
    assert got.box.as_box.as_tuple == pytest.approx((10, 20, 30, 40), abs=0.01)
