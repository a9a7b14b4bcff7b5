"""Push exactly so many blocks into a three-sided frame, past a line that they must not touch."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.core.actions import VOCABULARIES
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.shapes import LINE_M, ROOM_M, THREE_SIDED
from wonderful_team.sims.tabletop.tasks.choices import L4, L12, base_textures, kit_textures, one_of

NUMBERS = {"any": 1, "one": 1, "two": 2, "three": 3}
MOST = 3
FRAME_Y_M = 0.36
"""How far from the middle of the table the frame stands, on either side [m]."""
FRAME_JITTER_M, FRAME_SKEW_RAD = 0.02, math.radians(5)
LINE_INSIDE_M = -0.03
"""Where the line lies that must not be exceeded, from the frame's middle towards its open side [m]."""
OUTWARD_M = 0.015
"""How far the zone is shifted out of the open side [m]."""
BLOCKS_APART_M = 0.085
BLOCKS_X_M, BLOCKS_FROM_OPENING_M = (0.3, 0.7), (0.1, 0.5)


@task(
    "sweep_without_exceeding",
    instruction="Sweep {number} {swept_obj} into {bounds} without exceeding {constraint}.",
    horizon=10,
    vocabulary=VOCABULARIES["push"],
    partitions=L12,
)
def sweep_without_exceeding(scene: Scene, rng: np.random.Generator) -> None:
    """Push exactly so many blocks of a texture into the open end of a frame, up to a line inside it."""
    half, depth = ROOM_M[0] / 2, ROOM_M[1] / 2
    low, high = LINE_INSIDE_M + OUTWARD_M, depth + OUTWARD_M
    _sweep(scene, rng, LINE_INSIDE_M, ((-half, low), (half, low), (half, high), (-half, high)))


@task(
    "sweep_without_touching",
    instruction="Sweep {number} {swept_obj} into {bounds} without touching {constraint}.",
    horizon=16,
    vocabulary=VOCABULARIES["push"],
    partitions=L4,
)
def sweep_without_touching(scene: Scene, rng: np.random.Generator) -> None:
    """Push exactly so many blocks of a texture into a frame, round a line across the middle of its open side."""
    half, depth = ROOM_M[0] / 2, ROOM_M[1] / 2
    _sweep(scene, rng, depth + LINE_M[1] / 2, ((-half, -depth), (half, -depth), (half, depth), (-half, depth)))


def _sweep(scene: Scene, rng: np.random.Generator, line_at: float, zone: tuple[tuple[float, float], ...]) -> None:
    swept_cover, other_cover = scene.pick_textures(2, kit_textures(scene))
    frame_cover, line_cover = scene.pick_textures(2, base_textures(scene))
    count = int(rng.integers(1, MOST + 1))
    word = one_of(rng, ["all", *(word for word, number in NUMBERS.items() if number <= count)])
    side = int(scene.layout.choice([-1, 1]))
    jitter_x, jitter_y = (float(v) for v in scene.layout.uniform(-FRAME_JITTER_M, FRAME_JITTER_M, size=2))
    # The open side of the frame looks across the table.
    yaw = side * math.pi / 2 + float(scene.layout.uniform(-FRAME_SKEW_RAD, FRAME_SKEW_RAD))
    at = (0.5 + jitter_x, side * FRAME_Y_M + jitter_y)
    frame = scene.add(THREE_SIDED, frame_cover, at=at, yaw_rad=yaw)
    ahead = (-math.cos(yaw), -math.sin(yaw))
    line = scene.add("line", line_cover, at=(at[0] + line_at * ahead[0], at[1] + line_at * ahead[1]), yaw_rad=yaw)
    opening = side * FRAME_Y_M - side * ROOM_M[1] / 2
    near, far = (opening - side * reach for reach in BLOCKS_FROM_OPENING_M)
    room = (BLOCKS_X_M[0], max(-0.44, min(near, far)), BLOCKS_X_M[1], min(0.44, max(near, far)))
    swept, others = list[Thing](), list[Thing]()
    scene.apart_m = BLOCKS_APART_M
    for _ in range(count):
        swept.append(scene.add("small block", swept_cover, within=room))
        others.append(scene.add("small block", other_cover, within=room))
    wanted = len(swept) if word == "all" else NUMBERS[word]
    scene.count(swept, (frame, zone), exactly=wanted, none_of=others)
    scene.never(swept, over=line)
    scene.show(swept_obj=swept[0], bounds=frame, constraint=line)
    scene.say(number=word)
