"""A table that simulated models are asked about."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.simulated.tables import Set, set_table


@pytest.fixture(scope="module")
def table() -> Iterator[Set]:
    with set_table("visual_manipulation", 500) as made:
        yield made
