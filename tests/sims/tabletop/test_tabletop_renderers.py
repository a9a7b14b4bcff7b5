"""Pictures are drawn with OpenGL where there is one and by ray casting where there is none, whoever asks."""

from __future__ import annotations

import concurrent.futures.thread
import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from wonderful_team.core.interrupts import Interrupted, ends_on_signal
from wonderful_team.errors import ConfigError
from wonderful_team.sims.tabletop import make_world
from wonderful_team.sims.tabletop.drawing_gl import _DrawingThread

LOOK = """
from wonderful_team.sims.tabletop import make_world
world = make_world("rotate", 1)
world.observe()
print(world.renderer, len(world.notes), "ray casting" in " ".join(world.notes))
"""


def test_ray_casting_shows_the_same_scene() -> None:
    usual, cast = make_world("visual_manipulation", 2), make_world("visual_manipulation", 2, renderer="rays")
    assert cast.renderer == "rays"
    for name in ("top", "front"):
        one, two = usual.observe().views[name], cast.observe().views[name]
        assert np.abs(one.rgb.astype(int) - two.rgb).mean() < 6
        assert np.isfinite(two.depth_m).all()
        assert np.median(np.abs(one.depth_m - two.depth_m)) < 0.001
    slots = zip(usual.instruction.slots.values(), cast.instruction.slots.values(), strict=True)
    for one, two in slots:
        assert np.abs(one.views["top"].rgb.astype(int) - two.views["top"].rgb).mean() < 2
    for name, mask in usual.privileged.masks().items():
        assert (mask != cast.privileged.masks()[name]).mean() < 0.002
    usual.close()
    cast.close()


def test_another_thread_sees_the_same_pixels() -> None:
    world = make_world("rotate", 1)
    here = world.observe().hash
    with ThreadPoolExecutor(1) as pool:
        assert pool.submit(lambda: world.observe().hash).result() == here
    world.close()


@pytest.mark.parametrize("platform", ["disabled", "osmesa"])
def test_a_missing_opengl_library_is_only_a_note(platform: str) -> None:
    environment = {**os.environ, "MUJOCO_GL": platform}
    done = subprocess.run([sys.executable, "-c", LOOK], env=environment, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() in (["rays", "1", "True"], ["osmesa", "0", "False"])
    if platform == "disabled":
        assert done.stdout.startswith("rays")
    assert done.stderr == ""


def test_an_unknown_renderer_is_refused() -> None:
    with pytest.raises(ConfigError, match="'rays', got 'vulkan'"):
        make_world("rotate", renderer="vulkan")


def test_nothing_is_drawn_unless_something_looks(monkeypatch: pytest.MonkeyPatch) -> None:
    from wonderful_team.sims.tabletop import simulated_table as table

    opened = []
    real = table.open_renderer
    monkeypatch.setattr(table, "open_renderer", lambda *a: (opened.append(1), real(*a))[1])
    world = make_world("visual_manipulation@clutter=2@lighting=2", 2)
    for action in world.privileged.oracle():
        world.execute(action)
    assert world.privileged.score().success
    assert world.privileged.truth()["things"]
    assert opened == []
    world.observe()
    assert opened == [1]
    world.close()


@pytest.mark.parametrize("renderer", [None, "rays"])
def test_colours_alone_are_those_of_a_picture_with_depth(renderer: str | None) -> None:
    world = make_world("visual_manipulation@clutter=2@lighting=2", 2, renderer=renderer)
    table = world._table
    drawing, state = table.renderer(), table._state
    for camera in ("top", "front"):
        for alone in (False, True):
            whole = drawing.draw(state, camera, alone=alone).rgb
            assert np.array_equal(drawing.colours(state, camera, alone=alone), whole)
        # All that stands there finds room in a picture.
        assert {table.built.body_id(name) for name in table.things} <= set(np.unique(drawing.bodies(state, camera)))
    world.close()


def test_pictures_of_an_instruction_and_what_they_show_open_one_renderer(monkeypatch: pytest.MonkeyPatch) -> None:
    from wonderful_team.sims.tabletop import showing

    opened, closed = [], []
    real = showing.open_renderer

    def opening(*asked: object) -> object:
        made = real(*asked)
        opened.append(made)
        giving_back = made[0].close
        monkeypatch.setattr(made[0], "close", lambda: (closed.append(made), giving_back()))
        return made

    monkeypatch.setattr(showing, "open_renderer", opening)
    world = make_world("visual_manipulation@lighting=2", 2)
    first = {name: slot.views["top"].rgb for name, slot in world.instruction.slots.items()}
    assert world._table.slot_masks(next(iter(first)), "top")
    assert world._table.slot_masks(next(iter(first)), "front")
    assert len(opened) == 1
    assert closed == []
    world.close()
    world.close()
    assert len(closed) == 1


def test_an_interrupt_while_the_drawing_thread_starts_comes_once_it_has_started(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A pool notes its thread after the start; one that it could not note is waited for without end when the program ends."""
    start = ThreadPoolExecutor._adjust_thread_count

    def interrupted(pool: ThreadPoolExecutor) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        start(pool)

    monkeypatch.setattr(ThreadPoolExecutor, "_adjust_thread_count", interrupted)
    drawing = _DrawingThread()
    with pytest.raises(Interrupted), ends_on_signal(force=True):
        drawing.run(lambda: 1)
    monkeypatch.undo()
    (thread,) = drawing._pool._threads
    assert thread in concurrent.futures.thread._threads_queues
    assert drawing.run(lambda: 2) == 2
    drawing._pool.shutdown()
