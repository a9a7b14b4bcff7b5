"""Options behind a task's name can be asked for in studies, too, before a single trial is run."""

from __future__ import annotations

import pytest

from wonderful_team.api.known_suites import check_levels
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.evals.suites import OPEN_LOOP, Suite


def suite(task: str) -> Suite:
    return Suite(task, (task,), OPEN_LOOP)


def test_a_study_takes_the_options_of_an_arms_world() -> None:
    check_levels([suite("arms/lid_box/one@nudge=1"), suite("arms/block_in_bowl@depth=2@slip=1")])


def test_it_refuses_what_the_world_would_refuse() -> None:
    with pytest.raises(ConfigError, match="nudge=1 to nudge=3"):
        check_levels([suite("arms/lid_box/one@shove=1")])
    with pytest.raises(UnknownNameError, match="level of tabletop/rotate"):
        check_levels([suite("tabletop/rotate@nudge=1")])


@pytest.mark.parametrize(
    ("task", "why"),
    [
        ("arms/star@slip=1", "the tool is held from the start, so it never happens; valid: no disturbance"),
        ("arms/cap@nudge=1", "nothing has to go from one place to another, so it never happens; valid: slip"),
    ],
)
def test_a_disturbance_that_cannot_happen_is_refused(task: str, why: str) -> None:
    with pytest.raises(ConfigError, match=why):
        check_levels([suite(task)])
    check_levels([suite("arms/shake@slip=1")])
