"""The cameras that views carry agree with the pictures, to the pixel and to the millimetre."""

from __future__ import annotations

import numpy as np
import pytest

from wonderful_team.errors import ConfigError
from wonderful_team.sims.tabletop import Scene, make_world, task


@task("test/camera", instruction="put the heart on the star", horizon=2)
def _camera_scene(scene: Scene, rng: np.random.Generator) -> None:
    heart = scene.add("heart", "red", at=(0.35, -0.35), name="heart")
    scene.add("ring", "blue", at=(0.6, -0.1), name="ring")
    scene.add("L-shaped block", "green", at=(0.5, 0.15), yaw_rad=0.0, name="ell")
    star = scene.add("star", "wooden", at=(0.65, 0.4), name="star")
    scene.goal(heart, near=star)


@pytest.mark.parametrize("size_px", [(640, 320), (256, 128)])
def test_projected_centres_match_the_seen_ones(size_px: tuple[int, int]) -> None:
    world = make_world("test/camera", size_px=size_px)
    view = world.observe().main
    assert view.size_px == size_px
    for name, thing in world.privileged.truth()["things"].items():
        rows, columns = np.nonzero(world.privileged.mask(name))
        seen = np.array([columns.mean() + 0.5, rows.mean() + 0.5])
        expected = view.camera.project([thing["position_m"]])[0]
        assert np.linalg.norm(seen - expected) < 1.0, name
    world.close()


def test_depth_lifts_pixels_to_the_true_surfaces() -> None:
    world = make_world("test/camera")
    views = world.observe().views
    for name, thing in world.privileged.truth()["things"].items():
        point = np.array(thing["grasp_m"])
        for view in views.values():
            pixel = view.camera.project([point])[0]
            depth = view.depth_m[int(pixel[1]), int(pixel[0])]
            lifted = view.camera.deproject([np.floor(pixel) + 0.5], [depth])[0]
            assert abs(lifted[2] - point[2]) < 0.003, (name, view.id)
            assert np.linalg.norm(lifted[:2] - point[:2]) < 0.003, (name, view.id)
    bare = views["front"]
    pixel = bare.camera.project([(0.3, 0.3, 0.0)])[0]
    depth = bare.depth_m[int(pixel[1]), int(pixel[0])]
    assert abs(bare.camera.deproject([pixel], [depth])[0][2]) < 0.003
    world.close()


def test_up_is_towards_the_robot_and_nothing_is_mirrored() -> None:
    world = make_world("test/camera")
    mask = world.privileged.mask("ell")
    rows, columns = np.nonzero(mask)
    box = mask[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]
    half_row, half_column = box.shape[0] // 2, box.shape[1] // 2
    assert box[half_row:, half_column:].mean() > 0.5, "the foot of an L points right, at the bottom"
    assert box[: half_row - 4, half_column:].mean() < 0.1
    top = world.observe().main.camera
    (here,), (nearer_robot,), (right) = (
        top.project([(0.5, 0, 0)]),
        top.project([(0.4, 0, 0)]),
        top.project([(0.5, 0.1, 0)]),
    )
    assert nearer_robot[1] < here[1]
    assert right[0][0] > here[0]
    world.close()


def test_a_size_that_is_not_two_to_one_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"size_px: expected \(2 n, n\).*\(640, 480\)"):
        make_world("test/camera", size_px=(640, 480))
