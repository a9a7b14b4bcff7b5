"""Requests about one picture, for tests of what goes over the wire."""

from __future__ import annotations

import numpy as np

from wonderful_team import contracts as c
from wonderful_team.agents import build_request
from wonderful_team.core.pictures import Axes, Picture
from wonderful_team.core.values import Request, Target, View
from wonderful_team.images import whole

TARGETS = (Target("T1", "object", "red disc"), Target("T2", "area", "free spot", use=("place",)))


def picture(size: tuple[int, int] = (640, 480), name: str = "main view", axes: bool = False) -> Picture:
    """A grey gradient of that size."""
    width, height = size
    rgb = np.zeros((height, width, 3), np.uint8)
    rgb[..., 0] = np.linspace(0, 255, width)[None, :]
    rgb[..., 1] = np.linspace(0, 255, height)[:, None]
    shown = whole(View(name, name, 0.0, rgb), name, min_side_px=1, max_side_px=10_000)
    return shown.marked(Axes()) if axes else shown


def reading(view: Picture, context: tuple[Picture, ...] = ()) -> Request:
    """A ReadScene request about a picture."""
    question = c.ReadScene(TARGETS, ("G1: put the disc there",), view, context)
    return build_request(question, id="ground/read", stage="ground")


def answer_px(view: Picture) -> dict[str, object]:
    """A right answer in pixels of the picture."""
    width, height = view.size_px
    return {
        "reasoning": "",
        "targets": [
            {
                "id": "T1",
                "found": True,
                "box": {"x0": 0.1 * width, "y0": 0.2 * height, "x1": 0.3 * width, "y1": 0.6 * height},
                "points": [{"role": "pick", "point": {"x": 0.2 * width, "y": 0.4 * height}}],
            },
            {"id": "T2", "found": False, "box": None, "points": []},
        ],
    }
