"""Harder tiers of any world with pictures, scored separately: what is seen or said changes, the task does not.

Our tabletop makes them itself, in its simulator; what stands here serves worlds that cannot.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from wonderful_team.core.actions import Action
from wonderful_team.core.geometry import AffineCamera, PinholeCamera, PlanarCamera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.geometry.cameras import Camera
from wonderful_team.core.protocols import World, facts_of
from wonderful_team.core.values import Instruction, Observation, StepReport, View
from wonderful_team.errors import ConfigError

IN_PICTURE = ("lighting", "camera", "texture")
"""Kinds that work on the pictures of any world; `clutter` needs a world that can put things on its table."""
KINDS = ("clutter", *IN_PICTURE, "paraphrase")
LEVELS = (0, 1, 2, 3)
PHRASES = {
    1: "Please do this: {text}",
    2: "I would like the robot to take care of something on the table. {text} That is all.",
    3: "There is one thing to be done here before we can go on, so read this carefully and do no more than it says: {text}",
}


def read_tiers(words: Sequence[str]) -> tuple[str, ...]:
    """Tiers from "KIND=LEVEL", "KIND=FIRST..LAST" or several with commas; level 0 is the scene as it is, "".

    Raises:
        ConfigError: Another kind or level.
    """
    found: list[str] = []
    for word in (part.strip() for one in words for part in one.split(",")):
        kind, _, levels = word.partition("=")
        first, _, last = levels.partition("..")
        if not word:
            found.append("")
        elif kind not in KINDS or first not in map(str, LEVELS) or (last or first) not in map(str, LEVELS):
            raise ConfigError(
                f"perturbation {word!r}: valid is KIND=0..3, as in lighting=2 or lighting=0..3, with KIND one of {', '.join(KINDS)}"
            )
        else:
            found += [f"{kind}={level}" if level else "" for level in range(int(first), int(last or first) + 1)]
    return tuple(dict.fromkeys(found)) or ("",)


def read_tier(tier: str) -> tuple[str, int]:
    """Kind and level of "KIND=LEVEL"."""
    kind, _, level = tier.partition("=")
    return kind, int(level)


def perturbed(world: World, tier: str, seed: int) -> World:
    """The world as a harder tier shows or says it, by changing its pictures or its words.

    Raises:
        ConfigError: Clutter, which no picture can be given.
    """
    kind, level = read_tier(tier)
    if not level:
        return world
    if kind == "clutter":
        raise ConfigError("perturbation clutter: this world cannot put more things on its table; our tabletop can")
    return PerturbedWorld(world, kind, level, seed)


class WorldInDisguise:
    """A world of which something else is seen or said; actions pass through."""

    def __init__(self, world: World, instruction: Instruction) -> None:
        self._world, self.instruction = world, instruction
        self.vocabulary, self.limits, self.facts = world.vocabulary, world.limits, facts_of(world)
        self.horizon: int | None = getattr(world, "horizon", None)

    def execute(self, action: Action) -> StepReport:
        return self._world.execute(action)

    def stop(self) -> None:
        self._world.stop()

    def close(self) -> None:
        self._world.close()


class PerturbedWorld(WorldInDisguise):
    """Changes what is seen or said of a world; truth passes through as well."""

    def __init__(self, world: World, kind: str, level: int, seed: int) -> None:
        self._kind, self._level = kind, level
        self._rng_seed = [seed, level, KINDS.index(kind)]
        self.privileged = getattr(world, "privileged", None)
        said = world.instruction
        if kind == "paraphrase":
            said = Instruction(PHRASES[level].format(text=said.text), dict(said.slots))
        super().__init__(world, said)

    def observe(self) -> Observation:
        """The views, changed the same way at every look."""
        seen = self._world.observe()
        if self._kind == "paraphrase":
            return seen
        change = {"lighting": self._relit, "camera": self._turned, "texture": self._mottled}[self._kind]
        return replace(seen, views={name: change(view) for name, view in seen.views.items()})

    def _relit(self, view: View) -> View:
        """Exposure, a colour cast, and light that falls off to one side: up to 15, 30, 45 % by level."""
        rng = np.random.default_rng(self._rng_seed)
        strength = 0.15 * self._level
        gain = 1.0 + strength * rng.uniform(-1.0, 0.6)
        cast = 1.0 + 0.5 * strength * rng.uniform(-1.0, 1.0, size=3)
        slope = np.linspace(-1.0, 1.0, view.rgb.shape[1])[None, :, None] * strength * rng.choice([-1.0, 1.0]) / 2
        lit = view.rgb.astype(np.float64) * gain * cast * (1.0 + slope)
        return replace(view, rgb=np.clip(np.rint(lit), 0, 255).astype(np.uint8))

    def _turned(self, view: View) -> View:
        """The camera rolls by 4, 8, 12 degrees and stands as much farther away as keeps the whole view in the picture.

        Its model moves with the picture.
        """
        rng = np.random.default_rng(self._rng_seed)
        width, height = view.size_px
        roll_deg = 4.0 * self._level * float(rng.choice([-1.0, 1.0]))
        longer, shorter = max(width, height), min(width, height)
        turn = math.radians(abs(roll_deg))
        scale = 1.0 / (math.cos(turn) + longer / shorter * math.sin(turn))
        A = cv2.getRotationMatrix2D((width / 2, height / 2), roll_deg, scale)
        # OpenCV puts the centre of the first pixel at 0; here it lies at 0.5.
        for_cv = A.copy()
        for_cv[:, 2] += A[:, :2] @ (0.5, 0.5) - 0.5
        rgb = cv2.warpAffine(view.rgb, for_cv, (width, height), flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        depth_m = None
        if view.depth_m is not None:
            depth_m = cv2.warpAffine(
                view.depth_m, for_cv, (width, height), flags=cv2.INTER_NEAREST, borderValue=float("nan")
            )
        return replace(view, rgb=rgb, depth_m=depth_m, camera=None if view.camera is None else moved(view.camera, A))

    def _mottled(self, view: View) -> View:
        """Every surface carries blotches of other brightness, about 8, 16, 24 % by level, a fortieth of the width apart."""
        rng = np.random.default_rng(self._rng_seed)
        height, width = view.rgb.shape[:2]
        coarse = rng.uniform(-1.0, 1.0, size=(max(2, 40 * height // width), 40)).astype(np.float32)
        blotches = cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC)[:, :, None]
        covered = view.rgb.astype(np.float64) * (1.0 + 0.08 * self._level * blotches)
        return replace(view, rgb=np.clip(np.rint(covered), 0, 255).astype(np.uint8))


def moved(camera: Camera, A: Array) -> Camera:
    """The camera whose pixels are those of `camera` mapped by A, shape (2, 3).

    Raises:
        ConfigError: A camera of another kind.
    """
    whole = np.vstack([A, (0.0, 0.0, 1.0)])
    match camera:
        case PinholeCamera():
            return PinholeCamera(whole @ camera.K, camera.T_base_cam)
        case AffineCamera():
            pixels = A[:, :2] @ camera.matrix[:2]
            pixels[:, 3] += A[:, 2]
            return AffineCamera(np.vstack([pixels, camera.matrix[2]]))
        case PlanarCamera():
            return PlanarCamera(camera.H_table_px @ np.linalg.inv(whole), camera.plane_z_m)
    raise ConfigError(f"perturbation camera: a {type(camera).__name__} cannot be moved; pinhole, affine and planar can")
