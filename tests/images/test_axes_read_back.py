"""A real OCR engine reads the axes back: every number stands at the pixel it names."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator

import cv2
import numpy as np
import pytest

from tests.images.scenes import view
from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Axes, Picture
from wonderful_team.images import Ticks, crop, draw, whole

Reader = Callable[[Array], list[tuple[str, float, float]]]
BAND_PX = 64  # the numbers lie this close to the edge


@pytest.fixture(scope="module")
def read() -> Iterator[Reader]:
    """Reads (text, x, y) off an image with RapidOCR; its weights ship inside its wheel."""
    logging.disable(logging.INFO)
    rapidocr = pytest.importorskip("rapidocr")
    engine = rapidocr.RapidOCR(
        params={
            "Global.log_level": "critical",
            "Global.use_cls": False,
            # Thin bands would otherwise be enlarged until their short side has 736 pixels.
            "Det.limit_type": "max",
            "Det.limit_side_len": 2048,
            "EngineConfig.onnxruntime.intra_op_num_threads": 1,
        }
    )

    def read_image(rgb: Array) -> list[tuple[str, float, float]]:
        zoom = 1.5 if max(rgb.shape) < 800 else 1.0
        enlarged = cv2.resize(rgb[..., ::-1], None, fx=zoom, fy=zoom, interpolation=cv2.INTER_CUBIC)
        found = engine(enlarged, use_cls=False)
        if found.boxes is None:
            return []
        centres = [np.asarray(box).mean(axis=0) / zoom for box in found.boxes]
        return [(text, float(x), float(y)) for text, (x, y) in zip(found.txts, centres, strict=True)]

    yield read_image
    logging.disable(logging.NOTSET)


def numbers_along(read: Reader, picture: Picture, ticks: Ticks, axis: int) -> list[tuple[int, float]]:
    """The numbers read along the top (axis 0) or the left edge (1), with where each stands [px]."""
    drawn = draw(picture, ticks)
    band = drawn[:BAND_PX] if axis == 0 else drawn[:, :BAND_PX]
    seen = [(text, (x, y)) for text, x, y in read(band) if text.isdecimal() and (x, y)[1 - axis] < BAND_PX * 0.75]
    # The corner's 0 and, in each band, the first number of the other axis stand apart from this axis.
    return [(int(text), at[axis]) for text, at in seen if at[axis] > 30]


def crop_with_reference() -> tuple[Picture, Frame]:
    source = view()
    sent = whole(source, "top")
    return crop(source, Box(120, 224, 200, 304), "crop", marks=(Axes(reference=sent.frame),)), sent.frame


def pictures() -> dict[str, tuple[Picture, Ticks, Callable[[float, int], float]]]:
    """Name to picture, tick style, and the truth: what number belongs at a place along an axis."""
    plain = whole(view(), "top", marks=(Axes(),))
    small = whole(view(256, 128), "top", marks=(Axes(),))
    part, reference = crop_with_reference()

    def in_reference(at: float, axis: int) -> float:
        return reference.point_to_picture(part.frame.point_to_view((at, at)))[axis]

    return {
        "whole 640 x 480, pixels": (plain, Ticks.PIXELS, lambda at, _: at),
        "whole 640 x 480, thousandths": (plain, Ticks.THOUSANDTHS, lambda at, axis: at / plain.size_px[axis] * 1000),
        "small view enlarged, pixels": (small, Ticks.PIXELS, lambda at, _: at),
        "small view enlarged, thousandths": (
            small,
            Ticks.THOUSANDTHS,
            lambda at, axis: at / small.size_px[axis] * 1000,
        ),
        "crop labelled in the whole view's pixels": (part, Ticks.PIXELS, in_reference),
        "crop labelled in thousandths of the whole view": (
            part,
            Ticks.THOUSANDTHS,
            lambda at, axis: in_reference(at, axis) / reference.size_px[axis] * 1000,
        ),
    }


@pytest.mark.parametrize("name", list(pictures()))
def test_numbers_stand_where_they_say(read: Reader, name: str) -> None:
    picture, ticks, truth = pictures()[name]
    for axis in (0, 1):
        numbers = numbers_along(read, picture, ticks, axis)
        assert len(numbers) >= 4
        per_px = abs(truth(101.0, axis) - truth(100.0, axis))
        wrong = [(value, at) for value, at in numbers if abs(value - truth(at, axis)) > 2.0 * per_px]
        assert wrong == [], f"{name}, axis {axis}: (number, px) that do not agree; all: {numbers}"
