"""Cameras refuse what they cannot be or cannot see."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from wonderful_team.core.geometry import Box, PinholeCamera, PlanarCamera, Pose
from wonderful_team.core.values import KeepOut
from wonderful_team.errors import ConfigError
from wonderful_team.images.calibration import load_camera
from wonderful_team.images.keep_out import region_m

K = np.array([[500.0, 0, 320], [0, 500, 240], [0, 0, 1]])
# A table that narrows towards the back: its horizon lies at about y = -80 px, or at 60 px for the lower picture.
CORNERS_PX = np.array([(200.0, 120.0), (440.0, 120.0), (600.0, 460.0), (40.0, 460.0)])
CORNERS_M = [(0.0, 0.0), (0.0, 0.8), (0.6, 0.8), (0.6, 0.0)]


def test_a_pinhole_camera_takes_a_pose_and_says_how_to_make_one_of_a_matrix() -> None:
    T = np.eye(4)
    T[:3, 3] = (0.1, 0.2, 0.3)
    with pytest.raises(
        TypeError, match=r"T_base_cam: expected a Pose, got ndarray of shape \(4, 4\).*Pose.from_matrix"
    ):
        PinholeCamera(K, T)  # type: ignore[arg-type]
    camera = PinholeCamera(K, Pose.from_matrix(T))
    assert camera.T_base_cam.position_m == pytest.approx((0.1, 0.2, 0.3))


@pytest.mark.parametrize(
    ("matrix", "says"),
    [
        (np.eye(4), r"K: expected shape \(3, 3\), got \(4, 4\)"),
        (K[:2], r"K: expected shape \(3, 3\)"),
        (np.diag([500.0, 500.0, 2.0]), r"K: expected \[\[fx, skew, cx\]"),
        (np.diag([-500.0, 500.0, 1.0]), "focal lengths must be positive"),
        (K * np.nan, "finite"),
    ],
)
def test_intrinsics_of_another_form_are_refused(matrix: np.ndarray, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        PinholeCamera(matrix, Pose.at((0, 0, 1)))


@pytest.mark.parametrize("number", [1e7, -1e308, 1e308, float("inf"), float("nan")])
@pytest.mark.parametrize("place", ["low", "high", "position", "K"])
def test_a_camera_file_holds_no_number_that_no_camera_has(number: float, place: str, tmp_path: Path) -> None:
    held = {"K": K.tolist(), "T_base_cam": np.eye(4).tolist(), "size_px": [640, 480]}
    held["workspace_m"] = {"low": [0.2, -0.4, 0.0], "high": [0.8, 0.4, 0.3]}
    if place in ("low", "high"):
        held["workspace_m"][place][0] = number
    else:
        held["T_base_cam" if place == "position" else "K"][0][3 if place == "position" else 0] = number
    (tmp_path / "camera.json").write_text(json.dumps(held), encoding="utf-8")
    with pytest.raises(ConfigError, match=r"every number lies within ±1e\+06|finite"):
        load_camera(tmp_path / "camera.json", (640, 480))


def test_a_matrix_that_is_no_pose_is_refused() -> None:
    for matrix, says in (
        (np.eye(3), "4 x 4"),
        (np.diag([1.0, 1, -1, 1]), "not a rotation"),
        (np.ones((4, 4)), "last row"),
    ):
        with pytest.raises(ValueError, match=says):
            Pose.from_matrix(matrix)


def horizon_px(camera: PlanarCamera, x: float) -> float:
    a, b, c = camera.H_table_px[2]
    return float(-(a * x + c) / b)


def test_what_lies_above_the_horizon_of_four_corners_has_no_place_on_the_table() -> None:
    camera = PlanarCamera.from_corners(CORNERS_PX, CORNERS_M)
    horizon = horizon_px(camera, 320.0)
    below, above = (320.0, horizon + 5.0), (320.0, horizon - 5.0)
    assert np.isfinite(camera.on_plane([below], 0.0)).all()
    with pytest.raises(ValueError, match="above the table's horizon"):
        camera.on_plane([below, above], 0.0)
    behind = camera.on_plane([below], 0.0)[0] * np.array([-50.0, 1.0, 1.0])
    with pytest.raises(ValueError, match="behind the camera"):
        camera.project([behind, -behind])


@pytest.mark.parametrize("order", [[0, 1, 2, 3], [2, 3, 0, 1], [3, 2, 1, 0]])
def test_the_order_of_the_corners_does_not_turn_the_table_over(order: list[int]) -> None:
    camera = PlanarCamera.from_corners(CORNERS_PX[order], np.array(CORNERS_M)[order])
    assert camera.on_plane(CORNERS_PX, 0.0)[:, :2] == pytest.approx(np.array(CORNERS_M), abs=1e-9)
    assert camera.project(np.column_stack([CORNERS_M, np.zeros(4)])) == pytest.approx(CORNERS_PX, abs=1e-6)


def test_corners_that_no_camera_sees_so_are_refused() -> None:
    with pytest.raises(ConfigError, match="no camera sees a table"):
        PlanarCamera.from_corners(CORNERS_PX, np.array(CORNERS_M)[[0, 2, 1, 3]])


def test_a_region_that_reaches_above_the_horizon_is_no_region_of_the_table() -> None:
    camera = PlanarCamera.from_corners(CORNERS_PX, CORNERS_M)
    horizon = horizon_px(camera, 320.0)
    whole = KeepOut("lamp", Box(300, horizon + 20, 340, 400))
    assert region_m(whole, camera, 0.0).is_valid
    assert region_m(KeepOut("lamp", Box(300, horizon - 40, 340, 400)), camera, 0.0) is None
    assert region_m(KeepOut("huge", Box(-1e308, 0, 1e308, 1), "m"), camera, 0.0) is None
