"""Checked, read-only arrays: the one way arrays enter the frozen types."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]


def frozen_array(value: ArrayLike, shape: tuple[int | None, ...], name: str, dtype: Any = np.float64) -> Array:
    """Copy `value` into a read-only array of the given shape.

    Args:
        value: Anything numpy can turn into an array.
        shape: Expected shape; None leaves that axis free.
        name: What to call it in the message.
        dtype: Element type of the copy.

    Raises:
        ValueError: The shape differs, or a float value is not finite.
    """
    array = np.array(value, dtype=dtype)
    if array.shape != shape and not _fits(array.shape, shape):
        expected = tuple("any" if want is None else want for want in shape)
        raise ValueError(f"{name}: expected shape {expected}, got {array.shape}")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        raise ValueError(f"{name}: every value must be finite, got {array.tolist()}")
    array.setflags(write=False)
    return array


def _fits(shape: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    return len(shape) == len(wanted) and all(
        want is None or want == have for want, have in zip(wanted, shape, strict=True)
    )


def as_points(value: ArrayLike, width: int, name: str) -> Array:
    """Return `value` as float64 points, shape (N, width); a single point becomes (1, width)."""
    array = np.atleast_2d(np.asarray(value, dtype=np.float64))
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{name}: expected points of shape (N, {width}), got {array.shape}")
    return array
