"""Shapes that a helper function may call: what they give, inside the sandbox, and that the prompt names every one of them."""

from __future__ import annotations

import inspect
import math

import pytest

from tests.sandbox.programs import BOXES, body
from wonderful_team.agents.supervisor import FUNCTION
from wonderful_team.sandbox import SandboxError, run_path, shapes

OFFERED = [name for name, one in inspect.getmembers(shapes, inspect.isfunction) if not name.startswith("_")]


def returned(expression: str) -> tuple[tuple[float, ...], ...]:
    return run_path(body(f"return {expression}"), BOXES)


def test_all_shapes_are_named_to_whoever_writes_a_function() -> None:
    assert sorted(OFFERED) == ["arc", "circle", "polygon", "raster", "shake", "spiral", "star"]
    for name in OFFERED:
        parameters = ", ".join(inspect.signature(getattr(shapes, name)).parameters)
        assert f"{name}({parameters})" in FUNCTION


def test_closed_shapes_start_at_the_top_and_end_where_they_began() -> None:
    for expression, corners in (
        ("polygon((50, 60), 20, 4)", 4),
        ("star((50, 60), 20)", 10),
        ("circle((50, 60), 20)", 19),
    ):
        points = returned(expression)
        assert len(points) == corners + 1
        assert points[0] == pytest.approx((50, 40))
        assert points[-1] == pytest.approx(points[0])
        assert points[1][0] > 50, "clockwise as the picture shows it"
    reach = [math.dist(point, (50, 60)) for point in returned("star((50, 60), 20, tips=5, inner=0.4)")]
    assert reach == pytest.approx([20, 8] * 5 + [20])


def test_open_shapes() -> None:
    assert returned("arc((0, 0), 10, 0, 90, points=3)")[-1] == pytest.approx((10, 0))
    radii = [math.dist(point, (5, 5)) for point in returned("spiral((5, 5), 20, turns=2)")]
    assert radii == pytest.approx([20 * k / 19 for k in range(20)])
    assert returned("raster((0, 0, 10, 8), lanes=3, margin=1)") == ((1, 1), (9, 1), (9, 4), (1, 4), (1, 7), (9, 7))


def test_a_shake_goes_up_and_down_in_the_air() -> None:
    points = returned("shake((20, 40), 0.08, times=3)")
    assert [point[:2] for point in points] == [(20, 40)] * 7
    assert [point[2] for point in points] == [0, 0.08] * 3 + [0]


@pytest.mark.parametrize(
    ("expression", "says"),
    [
        ("polygon((0, 0), 5, 2)", "polygon: sides must be 3 or more, got 2"),
        ("star((0, 0), 5, inner=2)", "inner between 0 and 1"),
        ("arc((0, 0), 5, 0, 90, points=1)", "arc: points must be 2 or more"),
        ("spiral((0, 0), 5, points=0)", "spiral: points must be 2 or more"),
        ("raster((0, 0, 5, 5), lanes=1)", "raster: lanes must be 2 or more"),
        ("shake((0, 0), 0.1, times=0)", "shake: times must be 1 or more"),
        ("raster((0, 0, 5, 5), lanes=30)", "returned 60 points; 2 to 20 are allowed"),
        ("circle((0, 0), 1e9)", "finite pixels"),
    ],
)
def test_wrong_numbers_say_what_is_valid(expression: str, says: str) -> None:
    with pytest.raises(SandboxError, match=says):
        returned(expression)


def test_a_function_of_its_own_takes_the_place_of_a_shape_in_its_own_run_only() -> None:
    own = "def circle(centre, radius):\n    return [(1, 2), (3, 4)]\n" + body("return circle((0, 0), 1)")
    assert run_path(own, BOXES) == ((1.0, 2.0), (3.0, 4.0))
    assert len(returned("circle((0, 0), 1)")) == 20
