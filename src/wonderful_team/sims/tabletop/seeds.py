"""Where a scene's randomness comes from."""

from __future__ import annotations

import zlib

import numpy as np


def generator(seed: int, purpose: str, attempt: int) -> np.random.Generator:
    """One independent generator per purpose, so that a change in one leaves the others alone."""
    return np.random.default_rng([seed, zlib.crc32(purpose.encode()), attempt])
