"""Small drawn tables for tests: coloured shapes on a plain table, and questions about them."""

from __future__ import annotations

import cv2
import numpy as np

from wonderful_team.contracts import DraftPlan, PlanDraft, ShownSlot, ShownTask
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Request, View
from wonderful_team.images import whole
from wonderful_team.offline import OfflineModel

COLOURS = {
    "red": (205, 40, 40), "green": (50, 160, 60), "blue": (45, 90, 200), "yellow": (235, 205, 50),
    "purple": (140, 70, 170), "orange": (240, 140, 30), "grey": (128, 128, 128),
}  # fmt: skip
SIZE = (640, 320)
KINDS = PICK_PLACE.step_kinds


def table(*things: tuple[str, str, int, int, int]) -> View:
    """A table with things (shape, colour, x, y, radius) [px]; shapes: square, disc, ring, star, triangle, bar."""
    rgb = np.full((SIZE[1], SIZE[0], 3), (222, 218, 208), dtype=np.uint8)
    for shape, colour, x, y, radius in things:
        draw(rgb, shape, COLOURS[colour], (x, y), radius)
    return View("top", "top", 0.0, rgb)


def draw(rgb: Array, shape: str, colour: tuple[int, int, int], at: tuple[int, int], radius: int) -> None:
    x, y = at
    match shape:
        case "square":
            cv2.rectangle(rgb, (x - radius, y - radius), (x + radius, y + radius), colour, -1)
        case "bar":
            cv2.rectangle(rgb, (x - radius, y - radius // 3), (x + radius, y + radius // 3), colour, -1)
        case "disc":
            cv2.circle(rgb, at, radius, colour, -1, cv2.LINE_AA)
        case "ring":
            cv2.circle(rgb, at, radius - radius // 6, colour, radius // 3, cv2.LINE_AA)
        case "triangle":
            points = _round(x, y, [(radius, -90), (radius, 30), (radius, 150)])
            cv2.fillPoly(rgb, [points], colour, cv2.LINE_AA)
        case "star":
            points = _round(x, y, [(radius * (1 if k % 2 == 0 else 0.42), -90 + 36 * k) for k in range(10)])
            cv2.fillPoly(rgb, [points], colour, cv2.LINE_AA)
        case _:
            raise ValueError(f"shape {shape!r} is not drawn here")


def _round(x: int, y: int, polar: list[tuple[float, float]]) -> Array:
    return np.array([(x + r * np.cos(np.radians(a)), y + r * np.sin(np.radians(a))) for r, a in polar], dtype=np.int32)


def picture(view: View) -> Picture:
    return whole(view, "top view")


def slot(name: str, shape: str, colour: str) -> ShownSlot:
    """An instruction's picture: one thing alone on white."""
    rgb = np.full((160, 160, 3), 255, dtype=np.uint8)
    draw(rgb, shape, COLOURS[colour], (80, 80), 40)
    return ShownSlot(name, "object", (whole(View(f"slot:{name}", "top", 0.0, rgb), name),))


def task(text: str, view: View, *slots: ShownSlot) -> ShownTask:
    return ShownTask(text, (picture(view),), slots)


def ask(question: object, *, sample: int = 0) -> object:
    """The offline model's settled answer to a question."""
    request = Request("test", "plan", "any", question, (), question.output(), sample=sample)  # type: ignore[attr-defined]
    return OfflineModel().answer(request).value


def draft(text: str, view: View, *slots: ShownSlot, advice: tuple[str, ...] = ()) -> PlanDraft:
    answer = ask(DraftPlan(task(text, view, *slots), KINDS, True, advice))
    assert isinstance(answer, PlanDraft)
    return answer
