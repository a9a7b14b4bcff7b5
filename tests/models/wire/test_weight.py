"""Pictures that are too heavy for a service go out as JPEG, in the same size and legible; all others as they were."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from tests.models.wire.scenes import TARGETS, picture
from wonderful_team import contracts as c
from wonderful_team.agents import build_request
from wonderful_team.core.pictures import Axes, Picture
from wonderful_team.core.values import Request, View
from wonderful_team.images import whole
from wonderful_team.models.conventions import CONVENTIONS, PIXELS
from wonderful_team.models.families import guess_family
from wonderful_team.models.wire import UNLIMITED, Weight, compose, media_type
from wonderful_team.models.wire.composing import Composed
from wonderful_team.models.wire.weight import sent_bytes


def noisy(size: tuple[int, int] = (1280, 960), name: str = "main view") -> Picture:
    """A photo with noise, as PNG cannot make it small, with tick labels."""
    width, height = size
    rng = np.random.default_rng(list(name.encode()))
    smooth = cv2.resize(rng.integers(0, 256, (9, 12, 3), np.uint8), size, interpolation=cv2.INTER_CUBIC)
    rgb = np.clip(smooth.astype(np.int16) + rng.normal(0, 12, (height, width, 3)), 0, 255).astype(np.uint8)
    return whole(View(name, name, 0.0, rgb), name, min_side_px=1).marked(Axes())


def request(*pictures: Picture) -> Request:
    question = c.ReadScene(TARGETS, ("G1: put the disc there",), pictures[0], pictures[1:])
    return build_request(question, id="ground/read", stage="ground")


def files(composed: Composed) -> list[bytes]:
    return [piece for piece in composed.pieces if isinstance(piece, bytes)]


def read(file: bytes) -> np.ndarray:
    return cv2.imdecode(np.frombuffer(file, np.uint8), cv2.IMREAD_COLOR).astype(np.int16)


def test_within_the_limits_nothing_changes() -> None:
    asked = request(noisy(), picture())
    free, bound = compose(asked, PIXELS), compose(asked, PIXELS, limits=Weight(30_000_000, 60_000_000))
    assert files(free) == files(bound)
    assert free.notice == bound.notice == ""
    assert media_type(files(free)[0]) == "image/png"
    assert free.picture_bytes == sum(map(sent_bytes, files(free)))


@pytest.mark.parametrize("pasted", [False, True])
def test_a_picture_that_is_too_heavy_goes_out_as_jpeg_in_the_same_size(pasted: bool) -> None:
    asked = request(noisy(), picture())
    plain = compose(asked, PIXELS, one_picture=pasted)
    light = compose(asked, PIXELS, one_picture=pasted, limits=Weight(picture=2_000_000))
    assert sent_bytes(files(plain)[0]) > 2_000_000
    assert all(sent_bytes(file) <= 2_000_000 for file in files(light))
    assert media_type(files(light)[0]) == "image/jpeg"
    # The light one beside it stays what it was.
    assert files(light)[1:] == files(plain)[1:]
    assert [read(file).shape for file in files(light)] == [read(file).shape for file in files(plain)]
    assert light.sizes_px == plain.sizes_px
    assert "sent as JPEG" in light.notice
    assert "2000000 bytes a picture" in light.notice


def test_tick_labels_stay_sharp_at_the_lowest_quality() -> None:
    asked = request(noisy((1280, 640)))
    sharp, light = (read(files(compose(asked, PIXELS, limits=limits))[0]) for limits in (UNLIMITED, Weight(picture=1)))
    band = (slice(0, 40), slice(60, 1240))
    plates, kept = (np.abs(image[band]).max(axis=-1) for image in (sharp, light))
    ink, paper = plates < 60, plates > 235
    assert ink.sum() > 500
    assert paper.sum() > 500
    # Letters are white on dark plates: the two stay far apart.
    assert np.percentile(kept[paper], 5) - np.percentile(kept[ink], 95) > 60


def test_many_pictures_share_the_limit_of_a_request() -> None:
    asked = request(*(noisy((900, 700), name) for name in "abcd"))
    most = 3_000_000
    light = compose(asked, CONVENTIONS["gemini"], limits=Weight(request=most))
    assert compose(asked, CONVENTIONS["gemini"]).picture_bytes > 1.5 * most
    assert light.picture_bytes <= most
    assert len(files(light)) == 4
    assert f"{most} bytes a request" in light.notice


def test_a_drawing_is_never_made_heavier() -> None:
    shown = picture()
    light = compose(request(shown), PIXELS, limits=Weight(request=1))
    assert light.picture_bytes <= compose(request(shown), PIXELS).picture_bytes


def test_families_that_name_a_limit_have_it() -> None:
    assert guess_family("claude-sonnet-4-5").weight.picture == 5_242_880
    assert guess_family("claude-opus-4-7").weight == guess_family("claude-sonnet-4-5").weight
    assert guess_family("gemini-3-pro").weight.request == 18_000_000
    assert guess_family("gpt-5.6").weight.request == 45_000_000
    assert guess_family("qwen3-vl-8b").weight == UNLIMITED
    assert replace(UNLIMITED, picture=3).request is None
