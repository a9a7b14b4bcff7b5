"""The one place that imports MuJoCo, in a way that a missing OpenGL library cannot break."""

from __future__ import annotations

import os
import sys
from typing import Any

_WANTED = os.environ.get("MUJOCO_GL", "").lower()


def _import_without_opengl() -> Any:
    """Import MuJoCo with its OpenGL part switched off.

    With MUJOCO_GL=egl or osmesa the import itself fails where that library is missing; the contexts are loaded
    one by one by `find_context` instead, where a failure is only a reason to draw another way.
    """
    if "mujoco" in sys.modules:
        return sys.modules["mujoco"]
    before = os.environ.get("MUJOCO_GL")
    os.environ["MUJOCO_GL"] = "disabled"
    try:
        import mujoco
    finally:
        if before is None:
            del os.environ["MUJOCO_GL"]
        else:
            os.environ["MUJOCO_GL"] = before
    return mujoco


mj: Any = _import_without_opengl()


def find_context(width_px: int, height_px: int) -> tuple[Any, str]:
    """An OpenGL context that can draw without a screen, and its name.

    Tries what MUJOCO_GL names, else EGL and then OSMesa.

    Raises:
        RuntimeError: None works; says why for each.
    """
    if _WANTED in ("off", "false", "0", "disable", "disabled"):
        raise RuntimeError(f"MUJOCO_GL={_WANTED} switches OpenGL off")
    reasons = []
    for name in (_WANTED,) if _WANTED in ("egl", "osmesa") else ("egl", "osmesa"):
        before = os.environ.get("PYOPENGL_PLATFORM")
        try:
            if name == "egl":
                from mujoco.egl import GLContext
            else:
                from mujoco.osmesa import GLContext
            context = GLContext(width_px, height_px)
            context.make_current()
        except Exception as error:  # noqa: BLE001  PyOpenGL fails in many ways where a library is missing
            reasons.append(f"{name}: {type(error).__name__}: {error}")
            _forget_opengl(before)
        else:
            return context, name
    raise RuntimeError("no OpenGL platform works here (" + "; ".join(reasons) + ")")


def _forget_opengl(platform_before: str | None) -> None:
    """Let the next platform start afresh: PyOpenGL binds itself to the first one that is tried."""
    if platform_before is None:
        os.environ.pop("PYOPENGL_PLATFORM", None)
    else:
        os.environ["PYOPENGL_PLATFORM"] = platform_before
    for name in [
        n for n in sys.modules if n.split(".")[0] == "OpenGL" or n.startswith(("mujoco.egl", "mujoco.osmesa"))
    ]:
        del sys.modules[name]
