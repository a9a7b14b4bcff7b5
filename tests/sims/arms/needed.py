"""What tests of arms need: the optional part."""

from __future__ import annotations

import pytest

from wonderful_team.errors import MissingExtraError
from wonderful_team.sims.arms import check_ready


def is_ready() -> bool:
    try:
        check_ready()
    except MissingExtraError:
        return False
    return True


needs_arms = pytest.mark.skipif(
    not is_ready(), reason="the optional part arms is not installed: pip install '.[arms]' (docs/installing.md)"
)
