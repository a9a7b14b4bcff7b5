"""What a thing is lifted off stays where it is: the thing cannot be put into it."""

from __future__ import annotations

import numpy as np
import pytest

from tests.runtime.gate_cases import CAMERA, Block, Case, judged
from tests.runtime.gate_oracle import broken_rules
from wonderful_team.core.actions import At, PickPlace, PickPlaceStep
from wonderful_team.core.values import NumberSource, PlannedAction

SMALL, LARGE = Block(0.5, 0.1, 0.05, 0.05, 0.06), Block(0.5, -0.25, 0.09, 0.09, 0.05)


def moved(
    number: int, start: tuple[float, float, float], end: tuple[float, float, float], place: str, named: bool
) -> PlannedAction:
    ends = (("pick", "T1", start), ("place", place, end))
    sources = tuple(
        NumberSource(role, target, tuple(map(float, CAMERA.project([at])[0])), at, "made by hand")  # type: ignore[arg-type]
        for role, target, at in ends
    )
    step = PickPlaceStep(f"G{number}", "T1", At(place))
    return PlannedAction(step, PickPlace(np.array(start), np.array(end), 0.0), sources if named else ())


@pytest.mark.parametrize("named", [True, False], ids=["by name", "by numbers alone"])
@pytest.mark.parametrize(("aside_m", "admitted"), [(0.03, False), (0.05, False), (0.14, True)])
def test_a_thing_is_not_put_into_what_it_is_lifted_off(aside_m: float, admitted: bool, named: bool) -> None:
    stacked = moved(1, (0.5, -0.25, 0.05), (0.5, 0.1, 0.06), "T0", named)
    lifted = moved(2, (0.5, 0.1, 0.11), (0.5, 0.1 + aside_m, 0.0), "A1", named)
    case = Case((SMALL, LARGE), (), None, (stacked, lifted), planned=named)
    assert bool(broken_rules(case)) is not admitted
    assert judged(case).admitted is admitted
