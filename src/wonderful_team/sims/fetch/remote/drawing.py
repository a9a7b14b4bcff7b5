"""Pictures by MuJoCo's own renderer without a screen: colour and depth from one drawing."""

from __future__ import annotations

from typing import Any

import numpy as np


class Drawing:
    """Draws a model whose off-screen buffer has the size of the pictures."""

    def __init__(self, mujoco: Any, model: Any) -> None:
        self._mj, self._model = mujoco, model
        width, height = int(model.vis.global_.offwidth), int(model.vis.global_.offheight)
        self._window = mujoco.GLContext(width, height)
        self._window.make_current()
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._viewport = mujoco.MjrRect(0, 0, width, height)
        self._scene = mujoco.MjvScene(model, maxgeom=1000)
        for flag in ("mjRND_SHADOW", "mjRND_REFLECTION"):
            self._scene.flags[int(getattr(mujoco.mjtRndFlag, flag))] = 0
        self._option, self._camera = mujoco.MjvOption(), mujoco.MjvCamera()
        self._camera.type = int(mujoco.mjtCamera.mjCAMERA_FIXED)

    def picture(self, data: Any, camera: str) -> tuple[Any, Any]:
        """Colour, shape (H, W, 3), uint8, and distance along the optical axis, shape (H, W), float32 [m]."""
        rgb, share = self._drawn(data, camera)
        extent = self._model.stat.extent
        near, far = self._model.vis.map.znear * extent, self._model.vis.map.zfar * extent
        return rgb, (near * far / (far - (far - near) * share.astype(np.float64))).astype(np.float32)

    def geoms(self, data: Any, camera: str) -> Any:
        """Number of the geometry that each pixel shows, shape (H, W), int64; -1 for none."""
        flags = [int(getattr(self._mj.mjtRndFlag, name)) for name in ("mjRND_SEGMENT", "mjRND_IDCOLOR")]
        self._scene.flags[flags] = 1
        try:
            coded, _ = self._drawn(data, camera)
        finally:
            self._scene.flags[flags] = 0
        segment = coded.astype(np.int64) @ np.array([1, 256, 65536]) - 1
        numbers = np.full(self._scene.ngeom + 1, -1, dtype=np.int64)
        for geom in self._scene.geoms[: self._scene.ngeom]:
            if geom.objtype == int(self._mj.mjtObj.mjOBJ_GEOM):
                numbers[geom.segid] = geom.objid
        return numbers[np.where((segment >= 0) & (segment < self._scene.ngeom), segment, -1)]

    def close(self) -> None:
        """Give back what the graphics card holds."""
        self._context.free()
        self._window.free()

    def _drawn(self, data: Any, camera: str) -> tuple[Any, Any]:
        mj = self._mj
        self._camera.fixedcamid = self._model.camera(camera).id
        mj.mjv_updateScene(
            self._model, data, self._option, None, self._camera, int(mj.mjtCatBit.mjCAT_ALL), self._scene
        )
        mj.mjr_render(self._viewport, self._scene, self._context)
        shape = (self._viewport.height, self._viewport.width)
        rgb, depth = np.empty((*shape, 3), dtype=np.uint8), np.empty(shape, dtype=np.float32)
        mj.mjr_readPixels(rgb, depth, self._viewport, self._context)
        return np.ascontiguousarray(rgb[::-1]), np.ascontiguousarray(depth[::-1])
