"""Looks are drawn when somebody reads them, as things stood then; what was drawn once is not drawn again."""

from __future__ import annotations

import threading
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from wonderful_team.core.values import LaterView, Observation, View
from wonderful_team.errors import ConfigError
from wonderful_team.sims.tabletop import make_world
from wonderful_team.sims.tabletop.drawing_gl import OpenGLRenderer
from wonderful_team.sims.tabletop.kept_pictures import KeepingRenderer, kept_pictures
from wonderful_team.sims.tabletop.renderer import Drawn


def cameras_of(monkeypatch: pytest.MonkeyPatch, method: str) -> list[str]:
    """Cameras of the pictures that a renderer's method draws from now on, in order."""
    cameras: list[str] = []
    real = getattr(OpenGLRenderer, method)

    def counted(self: OpenGLRenderer, state: object, camera: str, *, alone: bool = False) -> Any:
        cameras.append(camera)
        return real(self, state, camera, alone=alone)

    monkeypatch.setattr(OpenGLRenderer, method, counted)
    return cameras


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Cameras of the pictures that were drawn, in order."""
    return cameras_of(monkeypatch, "draw")


def moved(seed: int) -> tuple[object, Observation, Observation]:
    world = make_world("visual_manipulation", seed)
    before = world.observe()
    world.execute(next(iter(world.privileged.oracle())))
    return world, before, world.observe()


def test_a_look_that_is_read_late_shows_how_things_stood_when_it_was_taken(drawn: list[str]) -> None:
    world, before, after = moved(41)
    assert drawn == []
    late = before.main.rgb, before.main.depth_m
    assert drawn == ["top"]
    assert not np.array_equal(late[0], after.main.rgb)
    world.close()
    again = make_world("visual_manipulation", 41)
    at_once = again.observe().main
    assert np.array_equal(late[0], at_once.rgb)
    assert np.array_equal(late[1], at_once.depth_m)
    again.close()


def test_a_look_can_be_read_when_its_world_is_closed(drawn: list[str]) -> None:
    world, _, after = moved(42)
    world.close()
    assert after.main.rgb.shape == (*reversed(after.main.size_px), 3)
    assert after.main.depth_m is not None
    assert drawn == ["top"]
    with pytest.raises(ConfigError, match="closed"):
        world.observe()


def test_an_instructions_pictures_are_drawn_when_they_are_read_even_when_the_world_is_closed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cameras = cameras_of(monkeypatch, "colours")
    # A scene with props has a model of its own for its pictures, one without them the table's.
    for task in ("visual_manipulation", "rearrange"):
        world, again = (make_world(task, 4100 + len(task)) for _ in range(2))
        slots = world.instruction.slots
        assert slots
        assert not cameras
        world.close()
        for name, slot in again.instruction.slots.items():
            for camera, view in slot.views.items():
                assert np.array_equal(slots[name].views[camera].rgb, view.rgb)
        assert cameras
        cameras.clear()
        again.close()


def test_two_looks_are_told_apart_by_the_main_view_alone(drawn: list[str]) -> None:
    world, before, after = moved(43)
    assert not before.shows_the_same_as(after)
    assert drawn == ["top", "top"]
    assert after.shows_the_same_as(world.observe())
    assert before.hash != after.hash
    world.close()


def test_settings_on_one_scene_share_what_is_drawn(drawn: list[str]) -> None:
    first, second, other = make_world("rotate", 44), make_world("rotate", 44), make_world("rotate", 45)
    pictures = first.observe().views
    assert drawn == []
    mine = {name: (view.rgb, view.depth_m) for name, view in pictures.items()}
    assert drawn == ["top", "front"]
    for name, view in second.observe().views.items():
        assert view.rgb is mine[name][0]
        assert view.depth_m is mine[name][1]
    assert drawn == ["top", "front"]
    assert not np.array_equal(other.observe().main.rgb, mine["top"][0])
    with pytest.raises(ValueError, match="read-only"):
        mine["top"][0][0, 0] = 0
    for world in (first, second, other):
        world.close()


def test_pictures_in_another_light_are_not_shared(drawn: list[str]) -> None:
    worlds = [make_world(name, 46) for name in ("rotate", "rotate@lighting=2", "rotate@camera=2")]
    pictures = [world.observe().main.rgb for world in worlds]
    assert len({picture.tobytes() for picture in pictures}) == 3
    assert drawn == ["top"] * 3
    for world in worlds:
        world.close()


class Counting:
    """Draws nothing but its own count."""

    name = "counting"

    def __init__(self) -> None:
        self.count = 0

    def draw(self, state: object, camera: str, *, alone: bool = False) -> Drawn:
        self.count += 1
        return Drawn(np.full((10, 20, 3), self.count, np.uint8), np.zeros((10, 20), np.float32))

    def colours(self, state: object, camera: str, *, alone: bool = False) -> np.ndarray:
        return self.draw(state, camera).rgb

    def bodies(self, state: object, camera: str) -> np.ndarray:
        self.count += 1
        return np.full((10, 20), self.count)

    def close(self) -> None:
        pass


class Poses:
    """As much of a state as names a picture."""

    def __init__(self, x: float) -> None:
        self.geom_xpos, self.geom_xmat = np.full((1, 3), x), np.eye(3).reshape(1, 9)


def test_the_longest_unused_pictures_are_given_up() -> None:
    kept = kept_pictures(3 * 10 * 20 * (3 + 4))
    drawing = Counting()
    renderer = KeepingRenderer(drawing, "a model", kept)
    for x in (1, 2, 3):
        renderer.draw(Poses(x), "top")
    renderer.draw(Poses(1), "top")
    assert drawing.count == 3
    renderer.draw(Poses(4), "top")
    assert kept.bytes == 3 * 10 * 20 * (3 + 4)
    renderer.draw(Poses(1), "top")
    assert drawing.count == 4
    renderer.draw(Poses(2), "top")
    assert drawing.count == 5


def test_another_question_or_model_or_camera_is_another_picture() -> None:
    kept, drawing = kept_pictures(), Counting()
    first, second = (KeepingRenderer(drawing, name, kept) for name in ("one", "two"))
    for renderer in (first, second):
        for camera in ("top", "front"):
            for alone in (False, True):
                renderer.draw(Poses(1), camera, alone=alone)
                renderer.colours(Poses(1), camera, alone=alone)
            renderer.bodies(Poses(1), camera)
    assert drawing.count == 20


def test_a_view_is_drawn_once_whoever_asks_at_the_same_time() -> None:
    begun, count = threading.Barrier(4), []

    def draw() -> tuple[np.ndarray, None]:
        count.append(1)
        return np.zeros((4, 6, 3), np.uint8), None

    view = LaterView("top", "top", 0.0, (6, 4), draw)

    def read() -> None:
        begun.wait(5)
        assert view.rgb.shape == (4, 6, 3)

    readers = [threading.Thread(target=read) for _ in range(4)]
    for reader in readers:
        reader.start()
    for reader in readers:
        reader.join()
    assert count == [1]
    assert view.depth_m is None


def test_a_look_without_depth_draws_nothing_until_it_is_read() -> None:
    count = []

    def draw() -> tuple[np.ndarray, np.ndarray]:
        count.append(1)
        return np.zeros((4, 6, 3), np.uint8), np.ones((4, 6), np.float32)

    view = LaterView("top", "top", 0.0, (6, 4), draw)
    plain = view.without_depth()
    assert count == []
    assert plain.depth_m is None
    assert plain.rgb is view.rgb
    assert isinstance(View("top", "top", 0.0, view.rgb).without_depth(), View)
    assert count == [1]


def test_a_look_can_be_changed_like_any_view() -> None:
    world = make_world("rotate", 47)
    seen = world.observe().main
    dark = replace(seen, rgb=np.zeros_like(seen.rgb))
    assert type(dark) is View
    assert not dark.rgb.any()
    assert dark.depth_m is seen.depth_m
    assert dark.camera is seen.camera
    assert (dark.id, dark.time_s) == (seen.id, seen.time_s)
    world.close()
