"""What coordinates model families speak, and exact conversion to and from pixels of the picture that was sent.

A convention is measured by `probe`; the table here is only the first guess for a family (see `families.py`).
Sources of each row: Google's robotics documentation (Gemini), Anthropic's vision documentation (Claude;
platform.claude.com/docs/en/build-with-claude/vision and …/vision-coordinates), OpenAI's (sizes by `detail`; developers.openai.com/
api/docs/guides/images-vision), zai-org's skill glmv-grounding (GLM-V), MoonshotAI/Kimi-VL #52 and #56, the issue threads of
QwenLM/Qwen3-VL (#676, #721, #866, #1035, #1741), the model cards of Molmo, client documentation (Moondream), public
benchmark code (GPT). Box orders are general knowledge.

Sizes, where they decide the numbers: Claude's and GPT's in the documentation above; Qwen2.5-VL's in preprocessor_config.json of its
weights (min_pixels 3136, max_pixels 12845056, patches of 14 px merged by 2; servers may be started with others, which `probe`
finds). Where a family says shares of width and height (Gemini, Qwen2-VL, Qwen3-VL, GLM-V, Kimi-VL, Molmo, InternVL, Gemma,
Moondream), what it makes of a picture's size does not change what its numbers mean, and no size is stated here. Looked up all the
same: Gemma 3 sees 896 x 896 px (preprocessor_config.json), Gemini at most 3072 x 3072 px (firebase.google.com/docs/vertex-ai/
input-file-requirements); of the others it is unknown: `probe` says what they can point at.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from wonderful_team.core.geometry.arrays import Array, as_points

Order: TypeAlias = Literal["xy", "yx"]
Unit: TypeAlias = Literal["pixels", "thousandths", "percent", "unit"]
Size: TypeAlias = tuple[int, int]

SPANS: dict[Unit, float | None] = {"pixels": None, "thousandths": 1000.0, "percent": 100.0, "unit": 1.0}
"""The number at the far edge of a picture; None: its width or height as the model sees it."""


@dataclass(frozen=True)
class Resize:
    """How a model resizes a picture before it looks at it. Applying it twice changes nothing more.

    Attributes:
        longest_side: Largest width or height [px]; None for no limit.
        shortest_side: Largest value of the shorter of the two [px]; None for no limit.
        max_pixels, min_pixels: Bounds on width x height [px].
        multiple: Width and height become multiples of this [px].
        always: Smaller pictures are enlarged to `longest_side` too.
    """

    longest_side: int | None = None
    max_pixels: int | None = None
    min_pixels: int | None = None
    multiple: int = 1
    always: bool = False
    shortest_side: int | None = None

    def __post_init__(self) -> None:
        bounds = (self.longest_side, self.shortest_side, self.max_pixels, self.min_pixels, self.multiple)
        if any(value is not None and value < 1 for value in bounds):
            raise ValueError(f"resize: every bound must be at least 1, got {bounds}")
        if self.always and self.longest_side is None:
            raise ValueError("resize: always needs a longest_side")

    def size(self, size_px: Size) -> Size:
        """Width and height after the resize, for a picture of `size_px` (width, height)."""
        width, height = size_px
        if self.longest_side is not None and (self.always or max(width, height) > self.longest_side):
            shrink = self.longest_side / max(width, height)
            width, height = max(1, round(width * shrink)), max(1, round(height * shrink))
        if self.shortest_side is not None and min(width, height) > self.shortest_side:
            shrink = self.shortest_side / min(width, height)
            width, height = max(1, round(width * shrink)), max(1, round(height * shrink))
        step = self.multiple
        fitted = (max(step, round(width / step) * step), max(step, round(height / step) * step))
        if self.longest_side is not None and max(fitted) > self.longest_side >= step:
            most = self.longest_side // step * step
            fitted = (min(fitted[0], most), min(fitted[1], most))
        if self.max_pixels is not None and fitted[0] * fitted[1] > self.max_pixels:
            shrink = math.sqrt(width * height / self.max_pixels)
            return _at_least(step, width / shrink, height / shrink, math.floor)
        if self.min_pixels is not None and fitted[0] * fitted[1] < self.min_pixels:
            grow = math.sqrt(self.min_pixels / (width * height))
            return _at_least(step, width * grow, height * grow, math.ceil)
        return fitted


@dataclass(frozen=True)
class Shape:
    """How a family writes points and boxes in JSON.

    Attributes:
        point, box: What the fields that hold one are called.
        point_keys, box_keys: Names of the numbers in an object, in the convention's order; None: a plain array.
    """

    point: str = "point"
    box: str = "box"
    point_keys: tuple[str, str] | None = None
    box_keys: tuple[str, str, str, str] | None = None


@dataclass(frozen=True)
class Convention:
    """What numbers a model uses for places in a picture.

    A model that means the picture pixel p says p * scale + offset_px in its unit, plus offset, in its order. Scale is
    (1, 1) and the offsets are (0, 0) until `probe` has measured others.

    Attributes:
        order: x first, or y first.
        unit: What the numbers count; "pixels" are those of the picture after the model's own resize.
        resize: The model's own resize; None when it counts pixels of the picture as sent, or a share of it.
        shape: How points and boxes are written.
        offset_px: Constant error in pixels of the picture as sent, x first.
        offset: Constant error in the model's own unit, x first.
    """

    name: str
    order: Order = "xy"
    unit: Unit = "pixels"
    resize: Resize | None = None
    offset_px: tuple[float, float] = (0.0, 0.0)
    scale: tuple[float, float] = (1.0, 1.0)
    shape: Shape = Shape()
    offset: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if not all(math.isfinite(value) and value > 0 for value in self.scale):
            raise ValueError(f"convention {self.name!r}: scale must be positive, got {self.scale}")
        if not all(math.isfinite(value) for value in self.offset_px):
            raise ValueError(f"convention {self.name!r}: offset_px must be finite, got {self.offset_px}")
        if not all(math.isfinite(value) for value in self.offset):
            raise ValueError(f"convention {self.name!r}: offset must be finite, got {self.offset}")

    def seen_size(self, size_px: Size) -> Size:
        """Size of the picture as the model sees it (width, height) [px]."""
        return size_px if self.resize is None else self.resize.size(size_px)

    def span(self, size_px: Size) -> tuple[float, float]:
        """The numbers that stand for the right and the bottom edge of a picture of `size_px`."""
        far = SPANS[self.unit]
        width, height = self.seen_size(size_px)
        return (float(width), float(height)) if far is None else (far, far)

    def to_model(self, points_px: ArrayLike, size_px: Size) -> Array:
        """Pixels of the picture sent to the model's numbers.

        Args:
            points_px: x right, y down, shape (N, 2).
            size_px: Width and height of the picture sent.

        Returns:
            Shape (N, 2), in the model's unit and order.
        """
        points = as_points(points_px, 2, "points_px") * self.scale + self.offset_px
        values = points * (np.asarray(self.span(size_px)) / np.asarray(size_px, dtype=float)) + self.offset
        return np.asarray(values[:, ::-1] if self.order == "yx" else values)

    def to_px(self, values: ArrayLike, size_px: Size) -> Array:
        """The model's numbers to pixels of the picture sent; the inverse of `to_model`, shape (N, 2)."""
        numbers = as_points(values, 2, "values")
        points = numbers[:, ::-1] if self.order == "yx" else numbers
        points = (points - self.offset) * (np.asarray(size_px, dtype=float) / np.asarray(self.span(size_px)))
        return np.asarray((points - self.offset_px) / self.scale)


def _at_least(step: int, width: float, height: float, whole: Callable[[float], int]) -> Size:
    """Width and height as multiples of `step`, at least one step each."""
    return max(step, whole(width / step) * step), max(step, whole(height / step) * step)


PIXELS = Convention("pixels")
"""Pixels of the picture as sent, x first: our own convention."""

_QWEN_BOX = Shape(point="point_2d", box="bbox_2d")

CONVENTIONS: dict[str, Convention] = {
    convention.name: convention
    for convention in (
        PIXELS,
        Convention("gemini", "yx", "thousandths", shape=Shape(box="box_2d")),
        Convention("claude", "xy", "pixels", Resize(longest_side=1568, max_pixels=1_176_000)),
        # Up to 2576 px and 4784 tokens of 28 x 28 px, which are begun ones.
        Convention("claude-4.7", "xy", "pixels", Resize(longest_side=2576, max_pixels=3_600_000)),
        Convention("gpt", "xy", "pixels"),
        Convention("gpt-tiles", "xy", "pixels", Resize(longest_side=2000, shortest_side=768)),
        Convention("gpt-patches", "xy", "pixels", Resize(longest_side=2048, max_pixels=1_500_000)),
        Convention("qwen2-vl", "xy", "thousandths", shape=_QWEN_BOX),
        Convention(
            "qwen2.5-vl", "xy", "pixels", Resize(max_pixels=12_845_056, min_pixels=3136, multiple=28), shape=_QWEN_BOX
        ),
        Convention("qwen3-vl", "xy", "thousandths", shape=_QWEN_BOX),
        Convention("glm-v", "xy", "thousandths", shape=Shape(box="bbox_2d")),
        Convention("kimi-vl", "xy", "unit", shape=Shape(box="bbox_2d")),
        Convention("molmo1", "xy", "percent"),
        Convention("molmo2", "xy", "thousandths"),
        Convention("internvl", "xy", "thousandths"),
        Convention("gemma", "xy", "thousandths"),
        Convention(
            "moondream", "xy", "unit", shape=Shape(point_keys=("x", "y"), box_keys=("x_min", "y_min", "x_max", "y_max"))
        ),
    )
}
"""First guesses by family; each row of the table that docs/models.md shows."""
