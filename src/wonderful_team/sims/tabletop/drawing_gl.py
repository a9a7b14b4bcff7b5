"""Drawing with OpenGL, without a screen. All of it happens on one thread of its own, whoever asks."""

from __future__ import annotations

import atexit
import contextlib
import weakref
from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.interrupts import held
from wonderful_team.sims.tabletop.engine import find_context, mj
from wonderful_team.sims.tabletop.model import FLOOR_GROUP, TABLE_GROUP, THING_GROUP, WHITE_GROUP, BuiltModel
from wonderful_team.sims.tabletop.renderer import Drawn

T = TypeVar("T")
_GROUPS = {False: (THING_GROUP, TABLE_GROUP, FLOOR_GROUP), True: (THING_GROUP, WHITE_GROUP)}
"""What is drawn: all that stands there, or things alone."""
MOST_STROKES = 4000
"""Of a pen, beside the geoms of the model: room for them takes time to make, so that a model without a pen gets none."""
SPARE_GEOMS = 100
"""For what MuJoCo may add of its own."""


class _DrawingThread:
    """The thread that owns the process's one OpenGL context: contexts belong to the thread that made them."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(max_workers=1, thread_name_prefix="tabletop-drawing")
        self._to_free: deque[Any] = deque()
        self._context: Any = None
        self._failure: str | None = None
        self.name = ""

    def run(self, work: Callable[[], T]) -> T:
        def after_freeing() -> T:
            self._free_waiting()
            return work()

        # The pool starts its thread at the first piece of work, and notes only then that it has to be told of the program's end: an
        # interrupt in between left a thread that the end waited for without end.
        with held():
            submitted = self._pool.submit(after_freeing)
        return submitted.result()

    def free_later(self, context: Any) -> None:
        """Free what a renderer holds before anything is drawn next.

        The garbage collector calls this at any point of any thread, the drawing thread included: it must not wait.
        """
        self._to_free.append(context)

    def free_now(self) -> None:
        """Free what waits for it; at the end of the process the graphics card has done so already."""
        with contextlib.suppress(RuntimeError):
            self.run(lambda: None)

    def _free_waiting(self) -> None:
        while self._to_free:
            self._to_free.popleft().free()

    def ensure_context(self) -> None:
        """Open the context once; a failure is remembered, because trying again costs and changes nothing."""
        if self._failure is not None:
            raise RuntimeError(self._failure)
        if self._context is None:
            try:
                # Drawing goes to MuJoCo's own off-screen buffer, so the context's size does not matter.
                self._context, self.name = find_context(64, 64)
            except RuntimeError as error:
                self._failure = str(error)
                raise
            atexit.register(self._context.free)


_THREAD = _DrawingThread()


class OpenGLRenderer:
    """Draws a model through MuJoCo's own renderer.

    Raises:
        RuntimeError: No OpenGL platform works here.
    """

    def __init__(self, built: BuiltModel) -> None:
        self._built = built
        _THREAD.run(_THREAD.ensure_context)
        self.name = _THREAD.name
        self._context: Any = None
        self._give_back: Callable[[], object] = lambda: None

    def _open(self) -> None:
        """Hand the model to the graphics card, which takes milliseconds: once something of it is drawn."""
        model = self._built.model
        strokes = 0 if self._built.decorate is None else MOST_STROKES
        self._scene = mj.MjvScene(model, maxgeom=int(model.ngeom) + SPARE_GEOMS + strokes)
        self._scene.flags[mj.mjtRndFlag.mjRND_SHADOW] = int(self._built.look.light.shadows)
        self._scene.flags[mj.mjtRndFlag.mjRND_REFLECTION] = 0
        self._scene.flags[mj.mjtRndFlag.mjRND_SKYBOX] = 0
        self._option = mj.MjvOption()
        self._camera = mj.MjvCamera()
        self._camera.type = mj.mjtCamera.mjCAMERA_FIXED
        self._context = mj.MjrContext(model, mj.mjtFontScale.mjFONTSCALE_100)
        mj.mjr_setBuffer(mj.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._viewport = mj.MjrRect(0, 0, int(model.vis.global_.offwidth), int(model.vis.global_.offheight))
        # A world that nobody closed gives its memory back on the right thread, too.
        self._give_back = weakref.finalize(self, _THREAD.free_later, self._context)

    def draw(self, state: Any, camera: str, *, alone: bool = False) -> Drawn:
        return self._run(lambda: self._render(state, camera, _GROUPS[alone]))

    def colours(self, state: Any, camera: str, *, alone: bool = False) -> Array:
        return self._run(lambda: self._colours(state, camera, _GROUPS[alone]))

    def bodies(self, state: Any, camera: str) -> Array:
        def work() -> Array:
            self._scene.flags[mj.mjtRndFlag.mjRND_SEGMENT] = 1
            self._scene.flags[mj.mjtRndFlag.mjRND_IDCOLOR] = 1
            try:
                coded = self._colours(state, camera, _GROUPS[False])
            finally:
                self._scene.flags[mj.mjtRndFlag.mjRND_SEGMENT] = 0
                self._scene.flags[mj.mjtRndFlag.mjRND_IDCOLOR] = 0
            segment = coded.astype(np.int64) @ np.array([1, 256, 65536]) - 1
            bodies = np.zeros(self._scene.ngeom + 1, dtype=np.int32)
            for geom in self._scene.geoms[: self._scene.ngeom]:
                if geom.objtype == mj.mjtObj.mjOBJ_GEOM:
                    bodies[geom.segid] = self._built.model.geom_bodyid[geom.objid]
            return bodies[np.where((segment >= 0) & (segment < self._scene.ngeom), segment, -1)]

        return self._run(work)

    def _run(self, work: Callable[[], T]) -> T:
        def when_open() -> T:
            if self._context is None:
                self._open()
            return work()

        return _THREAD.run(when_open)

    def _render(self, state: Any, camera: str, groups: tuple[int, ...]) -> Drawn:
        self._shade(state, camera, groups)
        rgb, depth = self._empty(), np.empty(self._shape, dtype=np.float32)
        mj.mjr_readPixels(rgb, depth, self._viewport, self._context)
        model = self._built.model
        near, far = model.vis.map.znear * model.stat.extent, model.vis.map.zfar * model.stat.extent
        share = depth[::-1].astype(np.float64)
        if int(model.cam_projection[self._camera.fixedcamid]) == int(mj.mjtProjection.mjPROJ_PERSPECTIVE):
            metres = near * far / (far - (far - near) * share)
        else:
            metres = near + (far - near) * share
        return Drawn(np.ascontiguousarray(rgb[::-1]), np.ascontiguousarray(metres.astype(np.float32)))

    def _colours(self, state: Any, camera: str, groups: tuple[int, ...]) -> Array:
        """Without depth, which takes a fifth of the time."""
        self._shade(state, camera, groups)
        rgb = self._empty()
        mj.mjr_readPixels(rgb, None, self._viewport, self._context)
        return np.ascontiguousarray(rgb[::-1])

    @property
    def _shape(self) -> tuple[int, int]:
        return self._viewport.height, self._viewport.width

    def _empty(self) -> Array:
        return np.empty((*self._shape, 3), dtype=np.uint8)

    def _shade(self, state: Any, camera: str, groups: tuple[int, ...]) -> None:
        """Draw into the buffer that pictures are read from."""
        model = self._built.model
        self._option.geomgroup[:] = 0
        self._option.geomgroup[list(groups)] = 1
        self._camera.fixedcamid = mj.mj_name2id(model, mj.mjtObj.mjOBJ_CAMERA, camera)
        mj.mjv_updateScene(model, state, self._option, None, self._camera, mj.mjtCatBit.mjCAT_ALL, self._scene)
        if self._built.decorate is not None:
            self._built.decorate(self._scene)
        mj.mjr_setBuffer(mj.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        mj.mjr_render(self._viewport, self._scene, self._context)

    def close(self) -> None:
        """Give back what the graphics card holds; safe to call twice."""
        self._give_back()
        _THREAD.free_now()
