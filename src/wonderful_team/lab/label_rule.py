"""The rule by which the paper counts a grounded point: by the label drawn at it, or by its distance from the target's middle.

Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Appendix G.2: "at least half of its area within the object's boundary", or the point
"within a specific range around the target area center". Neither the label's size nor the range is stated: both are arguments here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point

HALF = 0.5


@dataclass(frozen=True)
class LabelRule:
    """When a point counts.

    Attributes:
        radius_px: Of the round label drawn at the point [px of the view].
        range_px: Largest distance from the target's middle that counts as well [px of the view].
    """

    radius_px: float
    range_px: float

    def __post_init__(self) -> None:
        if not self.radius_px > 0 or self.range_px < 0:
            raise ValueError(
                f"radius must be positive and range 0 px or more, got {self.radius_px} and {self.range_px}"
            )

    def share_inside(self, point: Point, mask: Array) -> float:
        """How much of the label's area lies on the object; what sticks out of the view does not.

        Args:
            point: Where the label is drawn [px of the view].
            mask: Which pixels show the object, shape (H, W) bool.
        """
        height, width = mask.shape
        # Four samples along each side of a pixel: a label may be but a few pixels wide.
        reach = np.arange(-self.radius_px, self.radius_px, 0.25) + 0.125
        dx, dy = np.meshgrid(reach, reach)
        inside = np.hypot(dx, dy) <= self.radius_px
        columns = np.floor(point[0] + dx[inside]).astype(int)
        rows = np.floor(point[1] + dy[inside]).astype(int)
        seen = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
        return float(mask[rows[seen], columns[seen]].sum() / len(columns))

    def holds(self, point: Point, mask: Array) -> bool:
        """Whether a point counts for the object that a mask shows."""
        if self.share_inside(point, mask) >= HALF:
            return True
        rows, columns = np.nonzero(mask)
        if not len(rows):
            return False
        middle = (float(columns.mean()) + 0.5, float(rows.mean()) + 0.5)
        return bool(np.hypot(point[0] - middle[0], point[1] - middle[1]) <= self.range_px)
