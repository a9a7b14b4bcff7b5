"""A table of everyday things with plain names: what `wonderful-team demo` shows."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import CrowdedError, Scene

GAP_M, WITHIN_M = 0.105, 0.06
"""From the purple block's middle to where the banana's should come to lie, and how far off it may be [m]."""
CLEAR_M = 0.2
"""No other thing stands nearer than this to where the banana goes [m]."""


@task(
    "everyday/tidy_up",
    instruction="Put the red block into the blue bowl, then put the banana to the left of the purple block.",
    horizon=4,
)
def tidy_up(scene: Scene, rng: np.random.Generator) -> None:
    """Put a block into one of two bowls, then a banana beside another block; the second bowl stays empty."""
    scene.order = "no skipping"
    other_block = scene.add("block", "purple", within=(0.3, 0.1, 0.7, 0.42))
    spot = (other_block.x_m, other_block.y_m - GAP_M)
    bowl = scene.add("bowl", "blue")
    other = scene.add("bowl", "green")
    red = scene.add("block", "red")
    banana = scene.add("banana", "banana skin", name="banana")
    if any(math.dist((thing.x_m, thing.y_m), spot) < CLEAR_M for thing in (bowl, other, red, banana)):
        raise CrowdedError("something stands where the banana goes")
    scene.goal(red, near=bowl)
    scene.then()
    scene.goal(banana, at=spot, within_m=WITHIN_M)
