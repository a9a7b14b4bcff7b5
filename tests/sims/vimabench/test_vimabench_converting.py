"""Our actions to the benchmark's and back: numbers that its action space holds, and a push that stays the same push."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wonderful_team.core.actions import PickPlace, Push
from wonderful_team.sims.vimabench.converting import (
    HIGH_XY_M,
    LOW_XY_M,
    PUSH_LIMITS,
    SHORTEST_M,
    Converted,
    converted,
    pick_of,
    push_of,
)

X = st.floats(LOW_XY_M[0], HIGH_XY_M[0])
Y = st.floats(LOW_XY_M[1], HIGH_XY_M[1])
PUSH_X = st.floats(PUSH_LIMITS.low_m[0], PUSH_LIMITS.high_m[0])
PUSH_Y = st.floats(PUSH_LIMITS.low_m[1], PUSH_LIMITS.high_m[1])


def within(done: Converted) -> bool:
    """Whether the benchmark's action space would hold it."""
    low, high = np.array(LOW_XY_M, np.float32), np.array(HIGH_XY_M, np.float32)
    for name, value in done.arrays.items():
        assert value.dtype == np.float32
        if name.endswith("position") and not ((low <= value).all() and (value <= high).all()):
            return False
        if name.endswith("rotation") and not (np.abs(value) <= 1).all():
            return False
    return True


@given(X, Y, X, Y, st.floats(-10, 10))
def test_a_pick_inside_the_table_converts_and_comes_back(x: float, y: float, u: float, v: float, yaw: float) -> None:
    action = PickPlace(np.array([x, y, 0.03]), np.array([u, v, 0.0]), yaw)
    done = converted(action)
    assert isinstance(done, Converted)
    assert within(done)
    assert done.arrays["pose0_rotation"].tolist() == [0, 0, 0, 1]
    assert done.arrays["pose1_rotation"][:2].tolist() == [0, 0]
    back = pick_of({name: value.tolist() for name, value in done.arrays.items()})
    assert back.pick_m[:2] == pytest.approx([x, y], abs=1e-6)
    assert back.place_m[:2] == pytest.approx([u, v], abs=1e-6)
    assert math.remainder(back.yaw_rad - yaw, 2 * math.pi) == pytest.approx(0.0, abs=1e-5)


@given(PUSH_X, PUSH_Y, PUSH_X, PUSH_Y)
def test_a_push_keeps_its_start_and_its_way_and_says_where_it_stops(x: float, y: float, u: float, v: float) -> None:
    action = Push(np.array([x, y, 0.0]), np.array([u, v, 0.0]))
    done = converted(action)
    if isinstance(done, str):
        assert any(word in done for word in ("no direction", "out of reach", "fit"))
        return
    assert within(done)
    assert done.end_m is not None
    first, last = (done.arrays[f"pose{k}_position"].astype(float) for k in (0, 1))
    asked = action.end_m[:2] - action.start_m[:2]
    travelled = done.end_m - action.start_m[:2]
    # Never without length, never the other way, never further than asked.
    assert np.linalg.norm(last - first) > 0.03
    assert SHORTEST_M - 1e-9 <= np.linalg.norm(travelled) <= np.linalg.norm(asked) + 1e-9
    assert abs(travelled[0] * asked[1] - travelled[1] * asked[0]) < 1e-9
    assert travelled @ asked > 0
    back = push_of({name: value.tolist() for name, value in done.arrays.items()})
    assert back.start_m[:2] == pytest.approx(action.start_m[:2], abs=2e-4)
    assert back.end_m[:2] == pytest.approx(done.end_m, abs=2e-4)


def test_a_push_in_the_middle_is_whole_and_one_to_the_edge_is_cut_short() -> None:
    whole = converted(Push(np.array([0.4, -0.2, 0.0]), np.array([0.6, -0.2, 0.0])))
    assert isinstance(whole, Converted)
    assert whole.end_m == pytest.approx([0.6, -0.2])
    # Its spatula starts 2 cm behind the first point that it is told, and stops 5 cm before the second.
    assert whole.arrays["pose0_position"] == pytest.approx([0.42, -0.2])
    assert whole.arrays["pose1_position"] == pytest.approx([0.65, -0.2])
    cut = converted(Push(np.array([0.4, -0.2, 0.0]), np.array([0.75, -0.2, 0.0])))
    assert isinstance(cut, Converted)
    assert cut.end_m == pytest.approx([0.70, -0.2])


def test_a_push_may_start_just_over_the_edge_and_come_in() -> None:
    done = converted(Push(np.array([0.77, 0.1, 0.0]), np.array([0.6, 0.1, 0.0])))
    assert isinstance(done, Converted)
    assert done.arrays["pose0_position"] == pytest.approx([0.75, 0.1])


@pytest.mark.parametrize(
    ("start", "end", "said"),
    [
        ((0.5, 0.0), (0.5, 0.0), "no direction"),
        ((0.5, 0.0), (0.5, 0.6), "out of reach"),
        ((0.74, 0.0), (0.76, 0.0), "out of reach"),
        ((0.71, 0.0), (0.75, 0.0), "fit"),
    ],
)
def test_a_push_that_cannot_be_made_says_why(start: tuple[float, float], end: tuple[float, float], said: str) -> None:
    done = converted(Push(np.array([*start, 0.0]), np.array([*end, 0.0])))
    assert isinstance(done, str)
    assert said in done


def test_rounding_is_clipped_and_more_is_refused() -> None:
    almost = converted(PickPlace(np.array([0.75 + 5e-5, 0.0, 0.0]), np.array([0.25 - 5e-5, 0.5, 0.0])))
    assert isinstance(almost, Converted)
    assert almost.arrays["pose0_position"].tolist() == [0.75, 0.0]
    assert converted(PickPlace(np.array([0.752, 0.0, 0.0]), np.array([0.3, 0.5, 0.0]))) == (
        "pick x = 0.752 m is out of reach [0.25, 0.75] m"
    )
