"""Whoever wrote a detector: what comes back is in order and fits the picture, or an error names the detector and the value."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from wonderful_team.core.geometry import Box
from wonderful_team.core.values import Detection
from wonderful_team.detectors import detect, found_words, identity_of
from wonderful_team.errors import DetectorCodeError, NotUnderstoodError

RGB = np.zeros((40, 60, 3), np.uint8)


class Saying:
    """A detector that returns, or raises, what it is told to."""

    name = "saying"

    def __init__(self, answer: Any) -> None:
        self.answer = answer

    def detect(self, rgb: np.ndarray, words: Sequence[str]) -> Any:
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer


class Waiting(Saying):
    async def detect(self, rgb: np.ndarray, words: Sequence[str]) -> Any:
        await asyncio.sleep(0)
        return self.answer


def look(detector: Any, *words: str, **options: Any) -> tuple[Detection, ...]:
    return asyncio.run(detect(detector, RGB, words or ("cup", "bowl"), **options))


def found(words: str = "cup", box: tuple[float, ...] = (1, 2, 11, 12), score: float = 0.5, **more: Any) -> Detection:
    return Detection(words, Box(*box), score, **more)


@pytest.mark.parametrize("kind", [Saying, Waiting])
def test_detections_come_in_the_order_of_the_words_the_surest_first(kind: Any) -> None:
    answer = [found("bowl"), found("cup", score=0.2), found("cup", score=0.9)]
    assert [(one.words, one.score) for one in look(kind(answer))] == [("cup", 0.9), ("cup", 0.2), ("bowl", 0.5)]


def test_nothing_found_is_an_answer() -> None:
    assert look(Saying([])) == ()


def test_a_plain_detector_runs_beside_the_loop_and_sees_a_picture_that_cannot_be_changed() -> None:
    class Noting(Saying):
        def detect(self, rgb: np.ndarray, words: Sequence[str]) -> Any:
            self.answer = (threading.current_thread(), rgb.flags.writeable, words)
            return []

    noting = Noting(None)
    look(noting, "cup", "cup")
    assert noting.answer[0] is not threading.main_thread()
    assert noting.answer[1:] == (False, ("cup",))


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (None, "detector 'saying' returned a NoneType; valid: a list of wt.Detection"),
        ("cup", "returned a str"),
        ({"cup": []}, "returned a dict"),
        ([found(), (1, 2, 3, 4)], r"detector 'saying', detection 2 is a tuple; valid: a wt.Detection"),
        ([found("mug")], "detection 1 is for 'mug', which was not asked for; valid: cup, bowl"),
        (
            [found(box=(50, 2, 70, 12))],
            r"has the box \(50.0, 2.0, 70.0, 12.0\) px; valid: within the picture, 0 to 60 px",
        ),
        ([found(box=(500, 2, 700, 12))], r"has the box \(500.0, "),
        ([found(mask=np.ones((60, 40), bool))], r"mask of shape \(60, 40\); valid: \(40, 60\), the picture's"),
        ([found()] * 1001, "returned 1001 detections; valid: at most 1000"),
        (KeyError("x"), r"detect\(\) of detector 'saying' raised KeyError: 'x' \(test_asking.py:"),
    ],
)
def test_what_are_no_detections_is_an_error_that_names_detector_and_value(answer: Any, message: str) -> None:
    with pytest.raises(DetectorCodeError, match=message):
        look(Saying(answer))


def test_an_edge_that_rounding_pushed_out_of_the_picture_is_cut_there() -> None:
    (one,) = look(Saying([found(box=(-0.4, 2, 60.9, 12))]))
    assert one.box == Box(0, 2, 60, 12)


def test_a_detector_that_does_not_come_back_is_given_up() -> None:
    class Hanging(Waiting):
        async def detect(self, rgb: np.ndarray, words: Sequence[str]) -> Any:
            await asyncio.Event().wait()

    with pytest.raises(DetectorCodeError, match="detector 'saying' did not come back within 0.05 s"):
        look(Hanging(None), within_s=0.05)


def test_a_refusal_by_name_stays_one() -> None:
    with pytest.raises(NotUnderstoodError, match="I do not know"):
        look(Saying(NotUnderstoodError("I do not know: cup")))


def test_what_a_record_says_of_a_detector() -> None:
    detector = Saying(None)
    assert identity_of(detector) == {"name": "saying"}
    detector.setting = {"threshold": 0.3}  # type: ignore[attr-defined]
    assert identity_of(detector) == {"name": "saying", "threshold": "0.3"}


def test_what_was_found_in_a_line() -> None:
    several = [found(score=score) for score in (0.9, 0.8, 0.7, 0.6, 0.5)]
    assert found_words(several, ["cup", "bowl"]) == "cup: 5 (0.90, 0.80, 0.70 and 2 more); bowl: none"
