"""Drawing by ray casting, where no OpenGL library is to be had."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.tabletop import textures
from wonderful_team.sims.tabletop.cameras import FAR_M, Lens
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.model import (
    FLOOR_GROUP,
    FLOOR_RGB,
    TABLE_GROUP,
    TABLE_RGB,
    THING_GROUP,
    BuiltModel,
)
from wonderful_team.sims.tabletop.renderer import Drawn

BOUNDS_FACTOR = 3.0
SHADOW_BIAS_M = 0.002
"""How much nearer to the light something must lie to throw a shadow [m]."""


class RayRenderer:
    """Draws a model by casting one ray per pixel; edges are not smoothed."""

    name = "rays"

    def __init__(self, built: BuiltModel) -> None:
        self._built = built
        # Rays skip a body outside the bounds of what it collides with; what is seen may be a little larger.
        self._model = copy.copy(built.model)
        self._model.bvh_aabb[:, 3:] *= BOUNDS_FACTOR
        self._tiles = {
            geom: textures.texture(name).astype(np.float64) * brightness
            for geom, (name, brightness) in built.covers.items()
        }

    def draw(self, state: Any, camera: str, *, alone: bool = False) -> Drawn:
        lens = self._built.lenses[camera]
        geoms, distance, normals, points = self._cast(
            state, lens, (THING_GROUP,) if alone else (THING_GROUP, TABLE_GROUP, FLOOR_GROUP)
        )
        light = self._built.look.light
        lit = self._lit(state, points) if light.shadows and not alone else np.ones(geoms.shape)
        rgb = np.full((*geoms.shape, 3), 255.0)
        for geom in np.unique(geoms[geoms >= 0]):
            here = geoms == geom
            facing = np.clip(-(normals[here] @ light.direction), 0, 1)[:, None] * lit[here][:, None]
            shade = np.array(light.ambient) + np.array(light.diffuse) * facing
            rgb[here] = self._colours(state, int(geom), points[here], normals[here]) * shade
        depth = np.where(geoms >= 0, distance, np.nan)
        return Drawn(np.clip(np.rint(rgb), 0, 255).astype(np.uint8), depth.astype(np.float32))

    def colours(self, state: Any, camera: str, *, alone: bool = False) -> Array:
        return self.draw(state, camera, alone=alone).rgb

    def bodies(self, state: Any, camera: str) -> Array:
        groups = (THING_GROUP, TABLE_GROUP, FLOOR_GROUP)
        geoms = self._cast(state, self._built.lenses[camera], groups)[0]
        return np.where(geoms >= 0, self._built.model.geom_bodyid[geoms], 0).astype(np.int64)

    def close(self) -> None:
        """Nothing is held."""

    def _cast(self, state: Any, lens: Lens, groups: tuple[int, ...]) -> tuple[Array, Array, Array, Array]:
        """Geom, depth, surface normal and point of what each pixel sees; shapes (H, W), (H, W), (H, W, 3), (H, W, 3)."""
        start, rays = lens.rays()
        geoms, reach, normals = self._shot(state, start, rays, groups)
        points = start + rays * reach[..., None]
        depth = (points - lens.position_m) @ lens.forward
        return geoms, depth, normals, points

    def _lit(self, state: Any, points: Array) -> Array:
        """1 where the light reaches a point, 0 in a shadow, shape (H, W)."""
        start = np.array([0.5, 0.0, 0.0]) - FAR_M * self._built.look.light.direction
        way = points - start
        length = np.linalg.norm(way, axis=-1)
        _, reach, _ = self._shot(state, start, way / length[..., None], (THING_GROUP, TABLE_GROUP))
        return np.where((reach < 0) | (reach > length - SHADOW_BIAS_M), 1.0, 0.0)

    def _shot(self, state: Any, start: Array, rays: Array, groups: tuple[int, ...]) -> tuple[Array, Array, Array]:
        """Geom, distance and surface normal of what each ray meets, shapes (H, W), (H, W), (H, W, 3); -1 for nothing."""
        height, width = rays.shape[:2]
        count = width * height
        geoms, reach, normals = np.full(count, -1, dtype=np.int32), np.empty(count), np.zeros((count, 3))
        chosen = np.zeros(6, dtype=np.uint8)
        chosen[list(groups)] = 1
        mj.mj_multiRay(
            self._model, state, start, rays.ravel(), chosen, 1, -1, geoms, reach, normals.ravel(), count, mj.mjMAXVAL
        )
        return geoms.reshape(height, width), reach.reshape(height, width), normals.reshape(height, width, 3)

    def _colours(self, state: Any, geom: int, points: Array, normals: Array) -> Array:
        """Colours of one geom at points of its surface, unshaded, shape (N, 3)."""
        tile = self._tiles.get(geom)
        if tile is None:
            named = mj.mj_id2name(self._built.model, mj.mjtObj.mjOBJ_GEOM, geom)
            return np.tile(np.array(TABLE_RGB if named == "table" else FLOOR_RGB, dtype=float), (len(points), 1))
        body = int(self._built.model.geom_bodyid[geom])
        turn = state.xmat[body].reshape(3, 3)
        local, facing = (points - state.xpos[body]) @ turn, normals @ turn
        across = np.where(
            (np.abs(facing[:, 2]) > 0.3)[:, None],
            np.column_stack([local[:, 1], -local[:, 0]]),
            np.column_stack([facing[:, 0] * local[:, 1] - facing[:, 1] * local[:, 0], local[:, 2]]),
        )
        at = np.floor((across / textures.TILE_M + 0.5) % 1.0 * tile.shape[0]).astype(int) % tile.shape[0]
        return np.asarray(tile[at[:, 1], at[:, 0]])
