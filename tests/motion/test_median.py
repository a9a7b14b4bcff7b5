"""The middle of a few numbers is numpy's."""

from __future__ import annotations

import numpy as np
import pytest

from wonderful_team.motion.deprojector import _median


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_it_is_numpys_to_the_last_bit(kind: type) -> None:
    rng = np.random.default_rng(5)
    for count in range(1, 60):
        values = (rng.random((count, 1)) * 7).astype(kind)
        assert _median(values) == float(np.median(values))
