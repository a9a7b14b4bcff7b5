"""Photos, and what makes metres of their pixels."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import wonderful_team as wt
from wonderful_team.api.photos import corners_camera, instruction_with_pictures, load_camera, load_depth, read_keep_out
from wonderful_team.core.geometry import Pose
from wonderful_team.core.values import NO_WORKSPACE
from wonderful_team.errors import BadPictureError, ConfigError

SIZE_PX = (400, 300)
K = [[500.0, 0.0, 200.0], [0.0, 500.0, 150.0], [0.0, 0.0, 1.0]]
LOOKING_DOWN = [[0.0, -1.0, 0.0, 0.5], [-1.0, 0.0, 0.0, 0.1], [0.0, 0.0, -1.0, 1.0], [0.0, 0.0, 0.0, 1.0]]
WHOLE: dict[str, Any] = {
    "K": K,
    "T_base_cam": LOOKING_DOWN,
    "size_px": SIZE_PX,
    "workspace_m": {"low": [0.2, -0.4, 0.0], "high": [0.8, 0.4, 0.5]},
}


def write(path: Path, content: Any) -> Path:
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return path


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    path = tmp_path / "desk.png"
    cv2.imwrite(str(path), np.full((300, 400, 3), 128, np.uint8))
    return path


def test_a_photo_alone_has_no_metres(photo: Path) -> None:
    seen = wt.Observation.from_files(photo)
    assert seen.main.size_px == SIZE_PX
    assert seen.main.camera is None
    assert seen.limits is None


def test_the_first_photo_is_the_main_view_and_equal_names_stay_apart(photo: Path, tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    other = tmp_path / "b" / "desk.png"
    other.write_bytes(photo.read_bytes())
    seen = wt.Observation.from_files(photo, other)
    assert list(seen.views) == ["desk-1", "desk-2"]
    assert seen.main.id == "desk-1"


def test_corners_with_a_size_put_the_origin_at_the_first_corner() -> None:
    found = corners_camera("0,0 400,0 400,300 0,300=0.8x0.6", SIZE_PX)
    assert np.allclose(found.camera.on_plane([(0, 0), (400, 0), (0, 300)], 0.0)[:, :2], [(0, 0), (0, 0.8), (0.6, 0)])
    assert found.limits.high_m[:2] == pytest.approx((0.6, 0.8))


def test_corners_with_points_of_the_base_frame() -> None:
    text = "10,20=0.25,-0.5 390,20=0.25,0.5 390,280=0.75,0.5 10,280=0.75,-0.5"
    found = corners_camera(text, SIZE_PX)
    assert np.allclose(found.camera.on_plane([(200, 150)], 0.0)[0, :2], (0.5, 0.0))
    assert found.limits.low_m[:2] == pytest.approx((0.25, -0.5))


def test_a_camera_file_gives_camera_and_workspace(tmp_path: Path) -> None:
    found = load_camera(write(tmp_path / "c.json", WHOLE), SIZE_PX)
    # The camera hangs 1 m above (0.5, 0.1) and looks down: its centre pixel shows that point.
    assert np.allclose(found.camera.on_plane([(200, 150)], 0.0)[0], (0.5, 0.1, 0.0))
    assert found.limits.low_m == (0.2, -0.4, 0.0)


def test_any_rotation_of_a_camera_file_survives(tmp_path: Path) -> None:
    for quaternion in ([1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [0.3, -0.5, 0.7, 0.2]):
        pose = Pose(np.zeros(3), np.array(quaternion, dtype=float))
        matrix = np.eye(4)
        matrix[:3, :3] = pose.rotation
        found = load_camera(write(tmp_path / "c.json", {**WHOLE, "T_base_cam": matrix.tolist()}), SIZE_PX)
        assert np.allclose(found.camera.T_base_cam.rotation, pose.rotation, atol=1e-6)  # type: ignore[attr-defined]


def test_a_camera_file_without_a_workspace_says_nothing_about_it(tmp_path: Path) -> None:
    content = {key: value for key, value in WHOLE.items() if key != "workspace_m"}
    assert load_camera(write(tmp_path / "c.json", content), SIZE_PX).limits is NO_WORKSPACE


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ("{", "is not JSON"),
        ({"K": None}, "either K with T_base_cam"),
        ({"K": [[1, 2], [3, 4]]}, "K"),
        ({"T_base_cam": np.diag([1.0, 1.0, -1.0, 1.0]).tolist()}, "not a rotation"),
        ({"T_base_cam": np.eye(3).tolist()}, "4 x 4"),
        ({"size_px": [640, 480]}, "640 x 480 px, but the picture has 400 x 300"),
        ({"workspace_m": {"low": [0, 0, 0], "high": [0, 1, 1]}}, "workspace"),
        ({"fov": 60}, "fov"),
    ],
)
def test_a_malformed_camera_file_says_why(tmp_path: Path, change: Any, says: str) -> None:
    content = change if isinstance(change, str) else {**WHOLE, **change}
    with pytest.raises(ConfigError, match=says):
        load_camera(write(tmp_path / "c.json", content), SIZE_PX)


def test_depth_of_a_png_is_millimetres_and_of_an_npy_metres(tmp_path: Path) -> None:
    raw = np.full((300, 400), 482, np.uint16)
    raw[0, 0] = 0
    cv2.imwrite(str(tmp_path / "d.png"), raw)
    np.save(tmp_path / "d.npy", raw / 1000.0)
    for name in ("d.png", "d.npy"):
        depth_m = load_depth(tmp_path / name, SIZE_PX)
        assert depth_m[5, 5] == pytest.approx(0.482)
        assert math.isnan(depth_m[0, 0])


def test_wrong_depth_files_say_why(tmp_path: Path) -> None:
    np.save(tmp_path / "small.npy", np.ones((10, 10)))
    cv2.imwrite(str(tmp_path / "eight.png"), np.ones((300, 400), np.uint8))
    write(tmp_path / "text.npy", "no numbers")
    for name, says in (
        ("small.npy", "shape"),
        ("eight.png", "16-bit"),
        ("text.npy", "text.npy"),
        ("none.png", "exist"),
    ):
        with pytest.raises(BadPictureError, match=says):
            load_depth(tmp_path / name, SIZE_PX)


def test_a_photo_with_camera_and_depth_is_planned_in_metres(photo: Path, tmp_path: Path) -> None:
    np.save(tmp_path / "d.npy", np.full((300, 400), 0.9))
    seen = wt.Observation.from_files(photo, depth=tmp_path / "d.npy", camera=write(tmp_path / "c.json", WHOLE))
    assert seen.main.depth_m is not None
    assert seen.limits is not None
    with pytest.raises(ConfigError, match="not both"):
        wt.Observation.from_files(photo, camera="c.json", corners="0,0 1,0 1,1 0,1=1x1")


def test_pictures_of_the_instruction(photo: Path) -> None:
    wanted = instruction_with_pictures("put {cup} where {goal} shows", {"cup": photo, "goal:scene": photo})
    assert {name: slot.kind for name, slot in wanted.slots.items()} == {"cup": "object", "goal": "scene"}
    with pytest.raises(ConfigError, match="--picture cup=FILE"):
        instruction_with_pictures("put {cup} away", {})
    with pytest.raises(ConfigError, match="never says"):
        instruction_with_pictures("tidy up", {"cup": photo})
    with pytest.raises(ConfigError, match="unknown kind 'seen'"):
        instruction_with_pictures("put {cup} away", {"cup:seen": photo})


def test_keep_out_regions() -> None:
    lamp, second = read_keep_out(["lamp=1,2,3,4", "0.1,0.2,0.3,0.4m"])
    assert (lamp.name, lamp.unit, lamp.box.as_tuple) == ("lamp", "px", (1, 2, 3, 4))
    assert (second.name, second.unit) == ("region 2", "m")
