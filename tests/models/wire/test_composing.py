"""A request in a model's own terms: its unit in the words, its ticks on the pictures, its answers back in our pixels."""

from __future__ import annotations

import json

import cv2
import numpy as np
import pytest

from tests.models.wire.scenes import answer_px, picture, reading
from tests.models.wire.writing import written
from wonderful_team import contracts as c
from wonderful_team.agents import build_request
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes
from wonderful_team.core.values import Subgoal
from wonderful_team.models.conventions import CONVENTIONS
from wonderful_team.models.wire import compose
from wonderful_team.models.wire.composing import Composed


def words(composed: Composed) -> str:
    return "\n".join(piece for piece in composed.pieces if isinstance(piece, str))


def images(composed: Composed) -> list[np.ndarray]:
    files = [piece for piece in composed.pieces if isinstance(piece, bytes)]
    return [cv2.imdecode(np.frombuffer(file, np.uint8), cv2.IMREAD_COLOR) for file in files]


def in_numbers(composed: Composed, points_px: list[tuple[float, float]]) -> np.ndarray:
    """Our pixels in the model's numbers: `to_px` is affine, so three pairs of numbers tell it and its inverse."""
    origin, first, second = composed.to_px([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    return (np.array(points_px) - origin) @ np.linalg.inv(np.stack([first - origin, second - origin]))


@pytest.mark.parametrize("pasted", [False, True])
@pytest.mark.parametrize("name", sorted(CONVENTIONS))
def test_an_answer_in_the_models_numbers_comes_back_in_pixels_of_our_picture(name: str, pasted: bool) -> None:
    view = picture((1000, 500), axes=True)
    composed = compose(reading(view, (picture((300, 200), "front"),)), CONVENTIONS[name], one_picture=pasted)
    ours = answer_px(view)
    box = ours["targets"][0]["box"]  # type: ignore[index]
    corners = in_numbers(composed, [(box["x0"], box["y0"]), (box["x1"], box["y1"])]).ravel().tolist()
    keys = composed.convention.shape.box_keys
    spoken = written(composed.form, ours, view.size_px)
    spoken["targets"][0][composed.convention.shape.box] = (
        corners if keys is None else dict(zip(keys, corners, strict=True))
    )
    got = composed.read(json.dumps(spoken)).value
    assert got["targets"][0]["box"] == pytest.approx(box, abs=1e-6)


def test_words_and_pictures_keep_their_order() -> None:
    view = picture()
    composed = compose(reading(view, (picture((300, 200), "front"),)), CONVENTIONS["gpt"])
    kinds = [type(piece) for piece in composed.pieces]
    assert kinds == [str, bytes, str, bytes, str]
    assert "main view" in composed.pieces[0]
    assert [image.shape[:2] for image in images(composed)] == [(480, 640), (200, 300)]


def test_thousandths_are_said_everywhere_and_pixels_nowhere() -> None:
    composed = compose(reading(picture(axes=True)), CONVENTIONS["gemini"])
    said = words(composed)
    assert "in thousandths of width and height (0 to 1000)" in said
    assert "x from 0 to 1000, y from 0 to 1000" in said
    assert "y before x" in said
    assert "own pixels" not in said
    assert "x from 0 to 640" not in said


def test_a_picture_that_the_model_would_shrink_is_announced_in_the_size_it_is_sent() -> None:
    composed = compose(reading(picture((3000, 1000))), CONVENTIONS["claude"])
    width, height = CONVENTIONS["claude"].seen_size((3000, 1000))
    assert f"({width} x {height} px)" in words(composed)
    assert images(composed)[0].shape[:2] == (height, width)
    assert f"x from 0 to {width}, y from 0 to {height}" in words(composed)


def test_numbers_in_words_and_amounts_stay_pixels_for_every_model() -> None:
    view = picture().marked(Axes())
    question = c.WriteFunction(Subgoal("G1", "sweep"), view, {"T1": Box(1, 2, 3, 4)})
    said = words(compose(build_request(question, id="f", stage="act"), CONVENTIONS["gemini"]))
    assert "tick labels in its own pixels" in said
    assert "thousandths" not in said


def test_a_server_of_one_picture_gets_one_sheet_and_is_told_where_everything_lies() -> None:
    view = picture()
    composed = compose(reading(view, (picture((300, 200), "front"),)), CONVENTIONS["gpt"], one_picture=True)
    assert len(images(composed)) == 1
    assert composed.sizes_px == ((images(composed)[0].shape[1], images(composed)[0].shape[0]),)
    assert '- picture 1, "main view": x 12 to 652, y 30 to 510' in words(composed)
    assert '- picture 2, "front": x 664 to 964, y 30 to 230' in words(composed)
    assert "Answer with positions in the sheet" in words(composed)
    one = compose(reading(view), CONVENTIONS["gpt"], one_picture=True)
    assert "sheet" not in words(one)


def test_the_schema_is_told_in_words_where_asked() -> None:
    silent = compose(reading(picture()), CONVENTIONS["gemini"])
    told = compose(reading(picture()), CONVENTIONS["gemini"], schema_in_words=True)
    assert "box_2d" not in words(silent)
    assert told.form.text in words(told)


def test_molmo_may_answer_with_tags() -> None:
    question = c.LocatePoints(reading(picture()).question.targets[0], "centre", (), picture())
    composed = compose(build_request(question, id="p", stage="ground"), CONVENTIONS["molmo1"])
    got = composed.read('<point x="50.0" y="25.0" alt="disc">disc</point>')
    assert got.value["points"] == [pytest.approx({"x": 320, "y": 120})]
