"""Photos with a camera file, from the command line: what is not known is asked for by name, and nothing crashes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from wonderful_team.cli.app import run

ORDER = "put the red square to the left of the blue square"
K = [[500.0, 0.0, 200.0], [0.0, 500.0, 150.0], [0.0, 0.0, 1.0]]
LOOKING_DOWN = [[0.0, -1.0, 0.0, 0.5], [-1.0, 0.0, 0.0, 0.1], [0.0, 0.0, -1.0, 1.0], [0.0, 0.0, 0.0, 1.0]]
CAMERA: dict[str, Any] = {
    "K": K,
    "T_base_cam": LOOKING_DOWN,
    "size_px": (400, 300),
    "workspace_m": {"low": [0.1, -0.5, -0.01], "high": [0.9, 0.6, 0.5]},
}


@pytest.fixture
def desk(tmp_path: Path) -> Path:
    """A photo with its camera file and its depth: two blocks on a table."""
    rgb = np.full((300, 400, 3), 200, np.uint8)
    rgb[120:170, 80:130] = (200, 30, 30)
    rgb[120:170, 260:310] = (30, 60, 200)
    cv2.imwrite(str(tmp_path / "desk.png"), rgb[:, :, ::-1])
    (tmp_path / "camera.json").write_text(json.dumps(CAMERA), encoding="utf-8")
    depth_m = np.ones((300, 400), np.float32)
    depth_m[120:170, 80:130] = depth_m[120:170, 260:310] = 0.97
    np.save(tmp_path / "depth.npy", depth_m)
    return tmp_path


def plan(desk: Path, *options: str) -> int:
    return run(["plan", str(desk / "desk.png"), ORDER, *options, "--out", str(desk / "runs")])


def with_depth(desk: Path) -> tuple[str, ...]:
    return "--camera", str(desk / "camera.json"), "--depth", str(desk / "depth.npy")


def test_camera_and_depth_give_a_plan_in_metres_that_the_gate_admits(
    desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert plan(desk, *with_depth(desk), "--json") == 0
    result = json.loads(capsys.readouterr().out)["result"]
    assert result["actions"][0]["action"]["kind"] == "pick_place"
    assert result["warnings"] == []


def test_a_camera_without_depth_warns_and_its_heights_are_not_admitted(
    desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan(desk, "--camera", str(desk / "camera.json"))
    told = capsys.readouterr()
    assert "no depth is given: every height is taken to be the table's" in told.err
    assert "heights: not measured: there is no depth" in told.out + told.err


def test_a_camera_file_without_a_workspace_is_planned_and_the_warning_says_what_is_not_checked(
    desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (desk / "camera.json").write_text(json.dumps({k: v for k, v in CAMERA.items() if k != "workspace_m"}))
    assert plan(desk, *with_depth(desk), "--json") == 0
    told = capsys.readouterr()
    assert "no workspace is stated" in told.err
    assert json.loads(told.out)["result"]["status"] == "planned"


@pytest.mark.parametrize(
    ("depth", "says"),
    [
        (np.zeros((300, 400), np.float32), "holds no depth"),
        (np.full((300, 400), np.nan, np.float32), "holds no depth"),
        (np.full((300, 400), -1.0, np.float32), "holds no depth"),
        (np.full((300, 400), 60.0, np.float32), "more than 50 m"),
        (np.ones((30, 40), np.float32), "its shape is (30, 40)"),
    ],
    ids=["zero", "NaN", "negative", "far", "size"],
)
def test_depth_that_says_nothing_is_wrong_use_and_named(
    desk: Path, depth: Any, says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    np.save(desk / "depth.npy", depth)
    assert plan(desk, *with_depth(desk)) == 2
    told = capsys.readouterr().err
    assert "depth.npy" in told
    assert says in told


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"K": np.eye(4).tolist()}, "K: expected shape (3, 3)"),
        ({"T_base_cam": np.eye(3).tolist()}, "T_base_cam"),
        ({"T_base_cam": np.zeros((4, 4)).tolist()}, "T_base_cam"),
    ],
    ids=["K", "pose of another shape", "no pose"],
)
def test_a_camera_that_is_none_is_wrong_use_and_named(
    desk: Path, change: dict[str, Any], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (desk / "camera.json").write_text(json.dumps({**CAMERA, **change}))
    assert plan(desk, *with_depth(desk)) == 2
    assert says in capsys.readouterr().err


def test_a_keep_out_region_above_the_horizon_of_the_corners_refuses(
    desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # The table's sides meet far above the picture's middle; the region reaches above where they do.
    corners = "150,60 250,60 400,300 0,300=0.8x0.6"
    for box, refused in (("10,280,20,290", False), ("150,-400,160,-300", True), ("150,-400,160,20", True)):
        plan(desk, "--corners", corners, "--keep-out", f"lamp={box}")
        told = capsys.readouterr()
        assert ("meets no table" in told.out + told.err) is refused, (box, told)
