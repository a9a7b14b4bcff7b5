"""Pictures to bytes."""

from __future__ import annotations

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import checked_rgb


def to_png(rgb: Array, *, compression: int = 3) -> bytes:
    """PNG file bytes of an image.

    Args:
        rgb: Shape (H, W, 3), uint8.
        compression: 0 (fast) to 9 (small); 3 is quick and close to the smallest.

    Raises:
        ValueError: Another shape or type.
    """
    image = np.ascontiguousarray(checked_rgb(rgb)[..., ::-1])
    done, data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, compression])
    if not done:
        raise RuntimeError(f"cv2 could not write a PNG of shape {rgb.shape}")
    return bytes(data.tobytes())


def to_jpeg(rgb: Array, quality: int) -> bytes:
    """JPEG file bytes of an image; colours are not thinned out (4:4:4), so that thin lines and small letters stay sharp.

    Args:
        rgb: Shape (H, W, 3), uint8.
        quality: 0 (small) to 100 (close to the image).
    """
    options = [cv2.IMWRITE_JPEG_QUALITY, quality]
    options += [cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444]
    done, data = cv2.imencode(".jpg", cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR), options)
    if not done:
        raise RuntimeError(f"cv2 could not write a JPEG of shape {rgb.shape}")
    return bytes(data.tobytes())
