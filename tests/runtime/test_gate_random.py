"""Nothing that breaks a rule of an oracle of its own passes the gate: random plans, edited plans, seeds of Hypothesis."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.runtime.gate_cases import Block, Case, edited, judged, random_case
from tests.runtime.gate_oracle import broken_rules
from wonderful_team.core.actions import At, PickPlace, PickPlaceStep
from wonderful_team.core.values import PlannedAction

WITH_DEPTH, WITHOUT_DEPTH, EDITED = 100, 1500, 300


def wrongly_admitted(cases: list[Case]) -> tuple[int, list[list[str]]]:
    """How many the gate admits, and the rules that those of them break which break any."""
    admitted = [case for case in cases if judged(case).admitted]
    return len(admitted), [rules for case in admitted if (rules := broken_rules(case))]


@pytest.mark.parametrize(("depth", "count"), [(True, WITH_DEPTH), (False, WITHOUT_DEPTH)], ids=["depth", "no depth"])
def test_no_random_plan_outside_the_rules_is_admitted(depth: bool, count: int) -> None:
    cases = [random_case(np.random.default_rng([seed, 7]), depth) for seed in range(count)]
    admitted, wrong = wrongly_admitted(cases)
    assert wrong == []
    # The check means something: many pass, and many do not.
    assert 0.3 * count < admitted < 0.9 * count


def test_no_edited_plan_outside_the_rules_is_admitted() -> None:
    tried, refused = 0, 0
    for seed in range(EDITED):
        rng = np.random.default_rng([seed, 8])
        case = random_case(rng, depth=seed % 8 == 0)
        if not judged(case).admitted:
            continue
        what, changed = edited(case, rng)
        tried += 1
        if judged(changed).admitted:
            assert broken_rules(changed) == [], what
        else:
            refused += 1
    assert tried > EDITED / 3
    assert refused > tried / 3


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32), st.booleans())
def test_no_seed_finds_a_plan_outside_the_rules(seed: int, depth: bool) -> None:
    case = random_case(np.random.default_rng(seed), depth)
    assert not judged(case).admitted or broken_rules(case) == []


def moved(pick: tuple[float, float, float], place: tuple[float, float, float]) -> PlannedAction:
    return PlannedAction(PickPlaceStep("G1", "T0", At("A1")), PickPlace(np.array(pick), np.array(place), 0.0), ())


@pytest.mark.parametrize(
    ("lifted_at", "rules"),
    [
        # Close to the edge of what it stands on, whose top is nearly as high: what is lifted is the thing on top.
        ((0.48, 0.0, 0.10), []),
        # Beside it the tool meets the lower one, which cannot go into where it came from with the upper one on it.
        ((0.48, 0.028, 0.08), ["2: puts it into a block of 0.100 m (seen)"]),
    ],
    ids=["the upper one", "the lower one"],
)
def test_the_oracle_lifts_what_the_tool_meets_first(lifted_at: tuple[float, float, float], rules: list[str]) -> None:
    flat, tall = Block(0.35, -0.25, 0.06, 0.04, 0.02), Block(0.5, 0.0, 0.05, 0.07, 0.08)
    stacked = moved((0.35, -0.25, 0.02), (0.5, 0.0, 0.08))
    put_back = moved(lifted_at, (lifted_at[0], lifted_at[1], lifted_at[2] - 0.02))
    case = Case((flat, tall), (), None, (stacked, put_back), planned=False)
    assert broken_rules(case) == rules
