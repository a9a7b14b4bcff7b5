"""Patches of a mask: connected ones, the window round one, what lies nearest."""

from __future__ import annotations

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array


def kernel(size: int) -> Array:
    """A round structuring element."""
    return np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size)))


def components(mask: Array, least: float) -> list[Array]:
    """Connected patches of at least `least` pixels, largest first, each as a full mask."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    sizes = stats[:, cv2.CC_STAT_AREA]
    order = sorted((k for k in range(1, count) if sizes[k] >= least), key=lambda k: -int(sizes[k]))
    return [labels == k for k in order]


def window(mask: Array, margin: int = 4) -> tuple[slice, slice]:
    """Rows and columns round what a mask shows."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return (
        slice(max(0, int(rows[0]) - margin), int(rows[-1]) + 1 + margin),
        slice(max(0, int(columns[0]) - margin), int(columns[-1]) + 1 + margin),
    )


def placed(part: Array, view: tuple[slice, slice], shape: tuple[int, ...]) -> Array:
    """A window's mask in a full one."""
    full = np.zeros(shape, dtype=bool)
    full[view] = part
    return full


def nearest_in(mask: Array) -> tuple[Array, Array]:
    """Row and column of the pixel of a mask that is nearest to each pixel."""
    _, labels = cv2.distanceTransformWithLabels(
        (~mask).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    rows, columns = np.nonzero(mask)
    place = np.zeros(int(labels.max()) + 1, np.int64)
    place[labels[rows, columns]] = np.arange(len(rows))
    return rows[place[labels]], columns[place[labels]]
