"""What the judge is told of the robot's measurements: words, centimetres and degrees, and no position of another frame."""

from __future__ import annotations

import numpy as np

from tests.planning.rounds import photo
from wonderful_team.core.actions import PickPlace
from wonderful_team.core.values import StepReport, SubgoalRun
from wonderful_team.planning.judging import measured_lines

ACTION = PickPlace(np.array([0.5, 0.2, 0.034]), np.array([0.4, -0.2, 0.0]), 0.0)


def lines(**measured: object) -> str:
    report = StepReport(ACTION, True, measured)
    (line,) = measured_lines([SubgoalRun("G1", photo(), photo(), (report,))])
    return line


def test_values_are_told_in_units_of_the_picture() -> None:
    told = lines(held=True, contact_height_m=0.034, tool_m=[0.6, -0.1, 0.3], turned_rad=1.5708, grip="firm")
    assert told == "G1: pick_place executed: held = True, contact height = 3.4 cm, turned = 90 degrees, grip = firm"


def test_what_went_wrong_is_still_told() -> None:
    assert "held = False" in lines(held=False)
