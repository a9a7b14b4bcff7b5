"""Cameras: pixels to metres and back, for every camera that may stand somewhere over a table."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from wonderful_team.core.geometry import AffineCamera, Camera, PinholeCamera, PlanarCamera, Pose
from wonderful_team.errors import ConfigError, MissingDepthError

HURRY = settings(max_examples=100, derandomize=True, deadline=None, database=None)
PIXELS = st.lists(st.tuples(st.floats(0, 640), st.floats(0, 480)), min_size=1, max_size=5)
TABLE_M = np.array([(0.0, 0.0, 0.0), (0.0, 0.8, 0.0), (0.6, 0.8, 0.0), (0.6, 0.0, 0.0)])


@st.composite
def poses(draw: st.DrawFn) -> Pose:
    quaternion = np.array([draw(st.floats(-1, 1)) for _ in range(4)])
    assume(np.linalg.norm(quaternion) > 0.1)
    return Pose(np.array([draw(st.floats(-2, 2)) for _ in range(3)]), quaternion)


@st.composite
def pinholes(draw: st.DrawFn, at: Pose | None = None) -> PinholeCamera:
    fx, fy = draw(st.floats(100, 2000)), draw(st.floats(100, 2000))
    K = np.array(
        [[fx, draw(st.floats(-20, 20)), draw(st.floats(200, 440))], [0, fy, draw(st.floats(150, 330))], [0, 0, 1]]
    )
    return PinholeCamera(K, at or draw(poses()))  # fmt: skip


@st.composite
def over_the_table(draw: st.DrawFn) -> PinholeCamera:
    """A camera that looks down at the table from above it, more or less steeply, from any side."""
    heading, tilt = draw(st.floats(-3.1, 3.1)), draw(st.floats(-0.6, 0.6))
    down = Pose(np.array([0.3, 0.4, draw(st.floats(0.8, 2.0))]), np.array([0.0, 1.0, 0.0, 0.0]))
    turn = Pose(np.zeros(3), np.array([np.cos(heading / 2), 0, 0, np.sin(heading / 2)]))
    tip = Pose(np.zeros(3), np.array([np.cos(tilt / 2), np.sin(tilt / 2), 0, 0]))
    return draw(pinholes(down @ turn @ tip))


@st.composite
def affines(draw: st.DrawFn) -> AffineCamera:
    pose = draw(poses())
    scale = draw(st.floats(50, 2000))
    rows = np.diag([scale, scale, 1.0]) @ pose.rotation
    return AffineCamera(np.column_stack([rows, (320.0, 240.0, 5.0)]))


CAMERAS = st.one_of(pinholes(), affines())


@HURRY
@given(camera=CAMERAS, pixels=PIXELS, depth=st.floats(0.1, 5))
def test_a_pixel_with_depth_is_seen_where_it_was(
    camera: Camera, pixels: list[tuple[float, float]], depth: float
) -> None:
    points = camera.deproject(pixels, [depth] * len(pixels))
    assert camera.project(points) == pytest.approx(np.array(pixels), abs=1e-4)
    # And back again: the same point in metres.
    assert camera.deproject(camera.project(points), [depth] * len(pixels)) == pytest.approx(points, abs=1e-6)


@HURRY
@given(camera=over_the_table(), z=st.floats(-0.1, 0.3))
def test_a_pixel_on_a_plane_lies_on_it_and_is_seen_where_it_was(camera: PinholeCamera, z: float) -> None:
    pixels = camera.project(TABLE_M + (0, 0, z))
    found = camera.on_plane(pixels, z)
    assert found == pytest.approx(TABLE_M + (0, 0, z), abs=1e-6)
    # The ray through the pixel and the depth of the plane there say the same.
    depth = camera.T_base_cam.inverse().apply(found)[:, 2]
    assert camera.deproject(pixels, depth) == pytest.approx(found, abs=1e-6)


@HURRY
@given(pinhole=over_the_table(), at=st.tuples(st.floats(0.05, 0.55), st.floats(0.05, 0.75)))
def test_four_corners_give_the_plane_that_the_camera_sees(pinhole: PinholeCamera, at: tuple[float, float]) -> None:
    """A homography fitted to what a pinhole camera sees agrees with it, and its w is positive before the camera."""
    camera = PlanarCamera.from_corners(pinhole.project(TABLE_M), TABLE_M[:, :2])
    point = np.array([(*at, 0.0)])
    pixel = pinhole.project(point)
    assert camera.on_plane(pixel, 0.0) == pytest.approx(point, abs=1e-5)
    assert camera.project(point) == pytest.approx(pixel, abs=1e-2)
    assert float(np.append(pixel[0], 1.0) @ camera.H_table_px[2]) > 0


@HURRY
@given(pinhole=over_the_table(), away=st.floats(0.05, 3))
def test_what_lies_behind_the_camera_is_not_seen(pinhole: PinholeCamera, away: float) -> None:
    ahead = pinhole.T_base_cam.apply([(0.1, 0.1, away)])
    behind = pinhole.T_base_cam.apply([(0.1, 0.1, -away)])
    assert pinhole.project(ahead).shape == (1, 2)
    with pytest.raises(ValueError, match="behind the camera"):
        pinhole.project(np.vstack([ahead, behind]))


@HURRY
@given(pinhole=over_the_table(), row=st.floats(-3000, 3000))
def test_above_the_horizon_there_is_no_table(pinhole: PinholeCamera, row: float) -> None:
    """Both kinds of camera refuse the same pixels: those whose rays never come down to the table."""
    camera = PlanarCamera.from_corners(pinhole.project(TABLE_M), TABLE_M[:, :2])
    pixel = np.array([320.0, row])
    w = float(np.append(pixel, 1.0) @ camera.H_table_px[2])
    scale = float(np.abs(camera.H_table_px[2]) @ (320.0, abs(row), 1.0))
    assume(abs(w) > 1e-3 * scale)
    for seen in (camera, pinhole):
        if w > 0:
            assert np.isfinite(seen.on_plane([pixel], 0.0)).all()
        else:
            with pytest.raises(ValueError, match="never meet"):
                seen.on_plane([pixel], 0.0)


@pytest.mark.parametrize("depth", [0.0, -0.5, np.nan, np.inf])
@pytest.mark.parametrize(
    "camera", [PinholeCamera(np.diag([500.0, 500, 1]), Pose.at((0, 0, 1))), AffineCamera(np.eye(3, 4))]
)
def test_no_depth_is_no_depth(camera: Camera, depth: float) -> None:
    with pytest.raises(MissingDepthError, match=r"no depth at pixels \[\[3.0, 4.0\]\]"):
        camera.deproject([(1, 2), (3, 4)], [1.0, depth])
    with pytest.raises(ValueError, match=r"depth_m: expected shape \(2,\), got \(1,\)"):
        camera.deproject([(1, 2), (3, 4)], [1.0])


def test_four_corners_know_no_depth() -> None:
    camera = PlanarCamera(np.eye(3))
    with pytest.raises(ConfigError, match="four corners give the table plane only"):
        camera.deproject([(1, 2)], [1.0])


@pytest.mark.parametrize(
    ("matrix", "says"),
    [
        (np.zeros((3, 3)), "cannot be inverted"),
        (np.ones((3, 3)), "cannot be inverted"),
        (np.eye(4), r"expected shape \(3, 3\)"),
        (np.diag([1.0, np.inf, 1.0]), "finite"),
    ],
)
def test_a_homography_that_is_none_is_refused(matrix: np.ndarray, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        PlanarCamera(matrix)


@pytest.mark.parametrize(
    ("pixels", "metres", "says"),
    [
        ([(0, 0), (9, 0), (9, 9)], [(0, 0), (1, 0), (1, 1)], "exactly four are needed, got 3 pixels and 3 metres"),
        ([(0, 0), (4, 0), (9, 0), (9, 9)], [(0, 0), (1, 0), (1, 1), (0, 1)], "lie on one line"),
        ([(0, 0), (9, 0), (9, 9), (0, 9)], [(0, 0), (0, 0), (1, 1), (0, 1)], "lie on one line"),
        ([(0, 0), (9, 0), (9, 9), (0, 9)], [(0, 0), (1, 1), (1, 0), (0, 1)], "no camera sees a table"),
    ],
)
def test_corners_that_fix_no_table_are_refused(
    pixels: list[tuple[float, float]], metres: list[tuple[float, float]], says: str
) -> None:
    with pytest.raises(ConfigError, match=says):
        PlanarCamera.from_corners(pixels, metres)


@pytest.mark.parametrize("matrix", [np.zeros((3, 4)), np.ones((3, 4)), np.eye(3, 4) * (1, 0, 1, 1)])
def test_an_affine_camera_whose_rows_depend_is_refused(matrix: np.ndarray) -> None:
    with pytest.raises(ValueError, match="must be independent"):
        AffineCamera(matrix)


@pytest.mark.parametrize("count", [1, 2, 17, 1000])
@pytest.mark.parametrize(
    "axes",
    [
        [(0, 600, 0, 320), (600, 0, 0, -150), (0, 0, -1, 1)],
        [(480, 0, 0, 10), (0, -480, 0, 240), (0, 0, -1, 1.3)],
        [(0, 600, 0, 320), (424, 0, -424, 7), (-0.7, 0, -0.7, 1.2)],
    ],
)
def test_an_affine_camera_gives_the_same_metres_as_the_system_that_it_stands_for(
    axes: list[tuple[float, ...]], count: int
) -> None:
    camera, rng = AffineCamera(np.array(axes)), np.random.default_rng(count)
    pixels, depth = rng.uniform(0, 640, (count, 2)), rng.uniform(0.5, 2, count)
    seen = np.column_stack([pixels, depth]) - camera.matrix[:, 3]
    expected = np.linalg.solve(camera.matrix[:, :3], seen.T).T
    assert camera.deproject(pixels, depth) == pytest.approx(expected, rel=1e-12, abs=1e-12)
    level = camera.on_plane(pixels, 0.1)
    assert level[:, 2] == pytest.approx(0.1)
    assert camera.project(level) == pytest.approx(pixels)


def test_an_affine_camera_that_looks_along_the_table_fixes_no_point_of_it() -> None:
    along = AffineCamera(np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, 1, 0, 0]]))
    with pytest.raises(ValueError, match="looks along the plane"):
        along.on_plane([(1, 2)], 0.0)


@HURRY
@given(first=poses(), second=poses())
def test_poses_compose_as_their_matrices_and_undo_themselves(first: Pose, second: Pose) -> None:
    points = np.array([(0.1, -0.2, 0.3), (1.0, 2.0, -3.0)])
    assert (first @ second).apply(points) == pytest.approx(first.apply(second.apply(points)), abs=1e-9)
    assert first.inverse().apply(first.apply(points)) == pytest.approx(points, abs=1e-9)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = first.rotation, first.position_m
    assert Pose.from_matrix(T).rotation == pytest.approx(first.rotation, abs=1e-9)
