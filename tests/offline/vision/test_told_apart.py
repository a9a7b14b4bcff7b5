"""Things that are easily confused: letters, forms of one family, a ring in a bowl, grey pictures, rims with a texture."""

from __future__ import annotations

import pytest

from wonderful_team.agents.scene import SceneShown
from wonderful_team.core.pictures import with_pictures
from wonderful_team.offline.answers.drafting import draft
from wonderful_team.offline.eyes import Eyes, eyes_of_task
from wonderful_team.offline.goals.aims import Aims
from wonderful_team.offline.language import describe
from wonderful_team.offline.vision import in_plain_light
from wonderful_team.sims.tabletop import make_world


def drafted(task: str, seed: int) -> tuple[Eyes, Aims]:
    """What is seen of a task's scene, and what its own instruction comes to there."""
    world = make_world(task, seed=seed)
    try:
        scene = SceneShown(world.observe(), world.instruction, world.vocabulary, world.limits)
    finally:
        world.close()
    shown = with_pictures(scene.task, in_plain_light)
    return eyes_of_task(shown), draft(shown, with_targets=True)[1]


@pytest.mark.parametrize(
    ("task", "seed", "shape"),
    [
        ("visual_manipulation", 750018, "square"),  # a pink block that fills its picture, whose light is plain
        ("manipulate_old_neighbor", 750013, "pentagon"),  # into a thin striped frame
        ("novel_adj", 750007, "pentagon"),  # a grey stand-in beside a grey tray
        ("novel_adj_and_noun", 750019, "flower"),  # a hexagon is no flower
    ],
)
def test_what_pictures_show_is_found(task: str, seed: int, shape: str) -> None:
    eyes, result = drafted(task, seed)
    assert not result.question
    thing = eyes.thing(result.aims[0].thing.number)
    assert thing is not None
    assert thing.look.shape == shape


def test_what_shows_through_a_ring_in_a_bowl_is_the_bowl() -> None:
    eyes, result = drafted("pick_in_order_then_restore", 750005)
    ring = eyes.thing(result.aims[0].thing.number)
    assert ring is not None
    assert ring.look.shape == "ring"
    assert not ring.holds(ring.centre)
    assert ring.holds(ring.steady_point())


@pytest.mark.parametrize(
    ("task", "seed", "is_here", "is_not"),
    [
        ("manipulate_old_neighbor", 564005, "letter G", "letter C"),
        ("rotate", 770002, "letter M", "letter W"),
        ("pick_in_order_then_restore", 771005, "letter V", "letter A"),
        ("same_shape", 770008, "blue ring right of the block", "blue ring left of the block"),
    ],
)
def test_what_is_named_is_what_is_seen(task: str, seed: int, is_here: str, is_not: str) -> None:
    eyes, _ = drafted(task, seed)
    assert eyes.find(describe(is_here))
    assert not eyes.find(describe(is_not))
