"""Picture and depth files as people have them: phones, scanners, editors, depth cameras, and broken ones."""

from __future__ import annotations

import io
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from tests.images.scenes import table
from wonderful_team.errors import BadPictureError
from wonderful_team.images import load_depth, load_picture, to_png

RGB = table(64, 48)


def test_png_round_trip_is_exact_and_read_only(tmp_path: Path) -> None:
    file = tmp_path / "a.png"
    file.write_bytes(to_png(RGB))
    loaded = load_picture(file)
    assert np.array_equal(loaded, RGB)
    assert not loaded.flags.writeable


@pytest.mark.parametrize(("orientation", "turns"), [(3, 2), (6, 3), (8, 1)])
def test_exif_orientation_is_honoured(tmp_path: Path, orientation: int, turns: int) -> None:
    exif = Image.Exif()
    exif[0x0112] = orientation
    file = tmp_path / "phone.png"
    Image.fromarray(RGB).save(file, exif=exif)
    assert np.array_equal(load_picture(file), np.rot90(RGB, turns))


def test_transparency_lies_over_white(tmp_path: Path) -> None:
    layer = np.dstack([RGB, np.zeros((48, 64), np.uint8)])
    layer[:, :32, 3] = 255
    Image.fromarray(layer).save(tmp_path / "cut_out.png")
    loaded = load_picture(tmp_path / "cut_out.png")
    assert np.array_equal(loaded[:, :32], RGB[:, :32])
    assert (loaded[:, 32:] == 255).all()


def test_palette_with_transparency(tmp_path: Path) -> None:
    picture = Image.new("P", (20, 20), 1)
    picture.putpalette([10, 20, 30, 200, 100, 50])
    picture.putpixel((3, 4), 0)
    picture.save(tmp_path / "icon.png", transparency=0)
    loaded = load_picture(tmp_path / "icon.png")
    assert loaded[4, 3].tolist() == [255, 255, 255]
    assert loaded[0, 0].tolist() == [200, 100, 50]


def test_grey_16_bit_and_cmyk_become_rgb(tmp_path: Path) -> None:
    ramp = np.linspace(0, 65535, 32 * 32).astype(np.uint16).reshape(32, 32)
    cv2.imwrite(str(tmp_path / "deep.png"), ramp)
    deep = load_picture(tmp_path / "deep.png")
    assert deep.dtype == np.uint8
    assert deep[0, 0].tolist() == [0, 0, 0]
    assert deep[-1, -1].tolist() == [255, 255, 255]
    assert np.abs(deep[..., 0].astype(float) - ramp / 257).max() <= 0.51
    Image.new("L", (20, 20), 77).save(tmp_path / "grey.png")
    assert (load_picture(tmp_path / "grey.png") == 77).all()
    Image.new("CMYK", (20, 20), (0, 255, 255, 0)).save(tmp_path / "print.tif")
    red = load_picture(tmp_path / "print.tif")[0, 0]
    assert red[0] > 200
    assert red[1:].max() < 60


def test_16_bit_colour_is_brought_to_8(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "rgb16.png"), np.ascontiguousarray(RGB[..., ::-1].astype(np.uint16) * 257))
    assert np.abs(load_picture(tmp_path / "rgb16.png").astype(int) - RGB).max() <= 1


def broken(folder: Path) -> dict[str, tuple[Path, str]]:
    """Files that cannot be used, with what the message must say."""
    (folder / "empty.png").touch()
    (folder / "notes.png").write_text("not a picture")
    buffer = io.BytesIO()
    Image.fromarray(table(320, 240)).save(buffer, "JPEG")
    (folder / "cut.jpg").write_bytes(buffer.getvalue()[:600])
    (folder / "cut.png").write_bytes(to_png(RGB)[:200])
    (folder / "dot.png").write_bytes(to_png(np.zeros((1, 1, 3), np.uint8)))
    (folder / "thin.png").write_bytes(to_png(np.zeros((16, 400, 3), np.uint8)))
    Image.new("1", (20000, 9000)).save(folder / "huge.png")
    Image.new("F", (20, 20)).save(folder / "float.tif")
    return {
        "missing": (folder / "none.png", "there is no such file"),
        "folder": (folder, "it is a folder"),
        "empty": (folder / "empty.png", "empty"),
        "text": (folder / "notes.png", "not a picture"),
        "cut jpeg": (folder / "cut.jpg", "damaged"),
        "cut png": (folder / "cut.png", "damaged"),
        "dot": (folder / "dot.png", "1 x 1 px; valid: at least 16 px"),
        "thin": (folder / "thin.png", "400 x 16 px; valid: .*1:20"),
        "huge": (folder / "huge.png", "(20000 x 9000 px|too many pixels); valid: .*64 million"),
        "float": (folder / "float.tif", "floating-point"),
    }


def test_files_that_cannot_be_used_say_why_and_what_would_be_valid(tmp_path: Path) -> None:
    for name, (file, words) in broken(tmp_path).items():
        with pytest.raises(BadPictureError, match=words) as caught:
            load_picture(file)
        assert str(file) in str(caught.value), name
        assert "valid: " in str(caught.value), name


def test_depth_in_millimetres_and_metres(tmp_path: Path) -> None:
    millimetres = np.full((24, 32), 812, np.uint16)
    millimetres[0, 0] = 0
    cv2.imwrite(str(tmp_path / "depth.png"), millimetres)
    metres = np.full((24, 32), 0.812, np.float32)
    metres[0, :4] = (0, np.nan, np.inf, -1)
    np.save(tmp_path / "depth.npy", metres)
    for name, unknown in (("depth.png", 1), ("depth.npy", 4)):
        depth = load_depth(tmp_path / name)
        assert depth.shape == (24, 32)
        assert depth.dtype == np.float32
        assert np.isnan(depth).sum() == unknown
        assert np.nanmax(np.abs(depth - 0.812)) < 1e-6


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (np.full((20, 20), 812, np.uint16), "uint16, whose unit is not known"),
        (np.full((20, 20), 812.0), "812 m, more than 50 m: a wrong unit"),
        (np.zeros((20, 20)), "holds no depth"),
        (np.ones((20, 20, 3)), r"its shape is \(20, 20, 3\)"),
    ],
)
def test_depth_arrays_that_cannot_be_meant(tmp_path: Path, array: np.ndarray, words: str) -> None:
    np.save(tmp_path / "depth.npy", array)
    with pytest.raises(BadPictureError, match=words):
        load_depth(tmp_path / "depth.npy")


def test_coloured_depth_is_refused(tmp_path: Path) -> None:
    (tmp_path / "pretty.png").write_bytes(to_png(RGB))
    with pytest.raises(BadPictureError, match="mode RGB, not of depth; valid: a 16-bit grey PNG in millimetres"):
        load_depth(tmp_path / "pretty.png")
    (tmp_path / "bad.npy").write_bytes(b"\x93NUMPY")
    with pytest.raises(BadPictureError, match=r"not a \.npy array"):
        load_depth(tmp_path / "bad.npy")
