"""The classical classifier: which of some regions is meant, by words or by a picture of one thing."""

from __future__ import annotations

import numpy as np
import pytest

import wonderful_team as wt
from wonderful_team.agents.scene import SceneShown
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.values import NO_WORKSPACE
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.classifier import ClassicalClassifier
from wonderful_team.offline.detector import ClassicalDetector


def test_words_and_pictures_lead_to_the_same_region() -> None:
    world = wt.make_world("tabletop/visual_manipulation", seed=500)
    seen = world.observe()
    scene = SceneShown(seen, world.instruction, PICK_PLACE, NO_WORKSPACE)
    world.close()
    rgb = seen.main.rgb
    masks = [one.mask_in(seen.main.size_px) for one in ClassicalDetector().detect(rgb, ["object"])]
    (letter, pan) = (
        next(slot.pictures[0] for slot in scene.slots if slot.name == name) for name in ("dragged_obj_1", "base_obj")
    )
    classifier = ClassicalClassifier()
    for words, picture in (("pink letter R", letter), ("red pan", pan)):
        said, shown = classifier.similar(rgb, masks, words), classifier.similar(rgb, masks, picture)
        assert int(np.argmax(said)) == int(np.argmax(shown))
        assert 0.4 <= max(said) <= 1.0
    assert classifier.similar(rgb, masks, "green star") == [0.0] * 3
    # A region that is no thing has no likeness to anything.
    assert classifier.similar(rgb, [np.ones_like(masks[0])], "pink letter R") == [0.0]
    with pytest.raises(NotUnderstoodError, match="zorkmid"):
        classifier.similar(rgb, masks, "zorkmid")
