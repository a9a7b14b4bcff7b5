"""What the simulator knows of its things stays inside it."""

from __future__ import annotations

import gc
import re
import weakref
from pathlib import Path

import pytest

import wonderful_team
from wonderful_team.sims.tabletop import drawing_gl, make_world

INSIDE = re.compile(r"sims\.tabletop\.(textures|patterns|shapes|outlines|fruits|tasks|goals|oracle|scene|model)")


def test_no_one_else_imports_its_tables() -> None:
    source = Path(wonderful_team.__file__).parent
    others = [path for path in source.rglob("*.py") if "sims" not in path.relative_to(source).parts]
    assert others
    guilty = [str(path) for path in others if INSIDE.search(path.read_text(encoding="utf-8"))]
    assert guilty == []


def test_what_a_planner_is_given_names_nothing() -> None:
    world = make_world("visual_manipulation", 3)
    names = [*world.privileged.truth()["things"]]
    shown = repr(world.instruction.text) + repr(list(world.instruction.slots))
    shown += repr([(view.id, view.camera_name) for view in world.observe().views.values()])
    action = world.privileged.oracle()[0]
    shown += repr(dict(world.execute(action).measured))
    assert not [name for name in names if name in shown]
    world.close()


def test_worlds_that_nobody_closed_do_no_harm() -> None:
    for seed in range(4):
        make_world("rotate", seed).observe()
    gc.collect()
    world = make_world("rotate", 1)
    assert world.observe().main.rgb.any()
    world.close()
    world.close()


@pytest.mark.timeout(60)
def test_a_world_may_be_forgotten_while_another_is_drawn() -> None:
    """Garbage is collected at any point of any thread, so also on the one that draws."""
    kept = make_world("rotate", 1)
    kept.observe()
    forgotten = make_world("rotate", 2)
    forgotten.observe()
    renderer = weakref.ref(forgotten._table.renderer())
    forgotten.itself = forgotten  # type: ignore[attr-defined]
    del forgotten
    drawing_gl._THREAD.run(gc.collect)
    assert renderer() is None, "collected on that very thread"
    assert kept.observe().main.rgb.any()
    kept.close()
