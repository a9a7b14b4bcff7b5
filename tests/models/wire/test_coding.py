"""Which file a picture is sent as."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.models.wire.test_weight import files, noisy, read, request
from wonderful_team import registry
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import View
from wonderful_team.images import whole
from wonderful_team.models.conventions import CONVENTIONS, PIXELS
from wonderful_team.models.providers import make_provider
from wonderful_team.models.wire import Encoding, compose, media_type


def photo() -> Picture:
    """A photo without tick labels."""
    return _bare(noisy((640, 480)))


def _bare(picture: Picture) -> Picture:
    return whole(View(picture.name, picture.name, 0.0, picture.rgb), picture.name, min_side_px=1)


def drawing() -> Picture:
    rgb = np.full((480, 640, 3), 200, np.uint8)
    cv2.circle(rgb, (300, 200), 60, (190, 40, 30), -1, cv2.LINE_AA)
    return _bare(Picture("drawing", rgb, noisy((640, 480)).frame))


def rendering() -> Picture:
    world = registry.make_world("tabletop/rotate", 300000)
    try:
        return whole(world.observe().main, "table", min_side_px=1)
    finally:
        world.close()


def sent(picture: Picture, encoding: Encoding = "auto") -> str:
    return media_type(files(compose(request(picture), PIXELS, encoding=encoding))[0])


def test_photos_go_out_as_jpeg_and_all_else_as_png() -> None:
    assert sent(photo()) == "image/jpeg"
    assert sent(noisy()) == "image/png"  # tick labels are drawn on it
    assert sent(drawing()) == "image/png"
    assert sent(rendering()) == "image/png"


def test_an_enlarged_photo_is_a_photo() -> None:
    view = View("a", "a", 0.0, photo().rgb)
    assert sent(whole(view, "main view", long_side_px=1280)) == "image/jpeg"


@pytest.mark.parametrize("encoding", ["png", "jpeg"])
def test_one_file_for_all_pictures_can_be_chosen(encoding: Encoding) -> None:
    assert {sent(picture(), encoding) for picture in (photo, noisy, drawing)} == {f"image/{encoding}"}


def test_a_photo_sent_as_jpeg_is_near_to_it_and_as_large() -> None:
    shown = photo()
    jpeg, png = (read(files(compose(request(shown), PIXELS, encoding=kind))[0]) for kind in ("jpeg", "png"))
    assert jpeg.shape == png.shape
    # Of the noise less stays; what it lies on stays.
    smooth = [cv2.blur(image.astype(np.float32), (5, 5)) for image in (jpeg, png)]
    assert np.abs(smooth[0] - smooth[1]).mean() < 1.5


def test_a_sheet_with_tick_labels_on_it_is_png() -> None:
    bare = [_bare(noisy((640, 480), name)) for name in "ab"]
    labelled = [*bare, noisy((640, 480), "c")]
    kinds = [
        media_type(files(compose(request(*pictures), CONVENTIONS["gemini"], one_picture=True))[0])
        for pictures in (bare, labelled)
    ]
    assert kinds == ["image/jpeg", "image/png"]


def test_the_encoding_is_part_of_what_the_cache_knows_a_model_by() -> None:
    made = {kind: make_provider("anthropic:claude-opus-4-5", api_key="x", encoding=kind) for kind in ("auto", "png")}
    assert made["auto"].identity["encoding"] == "auto"
    assert made["auto"].identity != made["png"].identity
