"""Functions that were accepted earlier stand beside new code, each in a scope of its own, whatever either of them defines."""

from __future__ import annotations

import pytest

from tests.sandbox.programs import BOXES, ENDLESS, ESCAPES, OVERRIDES, body
from wonderful_team.sandbox import SandboxError, called, run_path
from wonderful_team.sandbox.returned import MAX_ERROR_CHARACTERS

LINE = body("x0, y0, x1, y1 = boxes['T1']", "return [(x0, y0), (x1, y1)]")
BY_NAME = body("return path_1(boxes)")
T1 = ((10.0, 20.0), (30.0, 60.0))


def test_new_code_calls_an_earlier_function_with_boxes_of_its_choice() -> None:
    assert run_path(BY_NAME, BOXES, earlier={"path_1": LINE}) == T1
    other = body("return path_1({'T1': boxes['T2']}) + [(0, 0)]")
    assert run_path(other, BOXES, earlier={"path_1": LINE}) == ((50.0, 20.0), (60.0, 30.0), (0.0, 0.0))


@pytest.mark.parametrize(
    "own",
    [
        "def star(centre, radius, tips=5, inner=0.382, turn_deg=0):\n    return [(1, 1), (2, 2)]",
        "def polygon(*given):\n    return 3",
        "def len(value):\n    return 99",
        "range = 3",
        "max = min = sum = abs = None",
        "import math\nmath = None",
        "path_9 = boxes = None",
        "def _round(*given):\n    return (0, 0)",
        *OVERRIDES,
    ],
)
def test_what_an_earlier_function_defines_reaches_no_new_code(own: str) -> None:
    earlier = {"path_1": f"{own}\n{LINE}"}
    shapes = body(
        "path_1(boxes)",
        "corners = star((50, 60), 20) + polygon((50, 60), 20, 3)",
        "return [(float(len(corners)), float(max(range(3)))), circle((50, 60), 20)[0]]",
    )
    assert run_path(shapes, BOXES, earlier=earlier) == ((15.0, 2.0), (50.0, 40.0))


@pytest.mark.parametrize(
    "own",
    [
        "def star(*given):\n    return []",
        "def polygon(*given):\n    return []",
        "def _round(*given):\n    return (0, 0)",
        "max = range = sum = zip = None",
        "import math\nmath = None",
        "def path_1(boxes):\n    return path(boxes)",
        "corner = None",
    ],
)
def test_what_new_code_defines_reaches_no_earlier_function(own: str) -> None:
    first = "def corner(box):\n    return (max(box[0], 0), box[1])\n" + body("return star(corner(boxes['T1']), 10)")
    earlier = {"path_1": first, "path_2": body("return [point for point in path_1(boxes)][: len('eleven corners')]")}
    alone = run_path(first, BOXES)
    assert len(alone) == 11
    assert run_path(f"{own}\n" + body("return path_2(boxes)"), BOXES, earlier=earlier) == alone


def test_two_functions_with_the_same_names_inside_keep_apart() -> None:
    inside = "def corner():\n    return ({0}, {0})\n\nSIDE = {0}\n" + body("return [corner(), (SIDE, 0)]")
    earlier = {"path_1": inside.format(1), "path_2": inside.format(2)}
    both = "def corner():\n    return (3, 3)\n" + body("return path_1(boxes) + path_2(boxes) + [corner()]")
    assert run_path(both, BOXES, earlier=earlier) == ((1, 1), (1, 0), (2, 2), (2, 0), (3, 3))


def test_functions_that_call_each_other_and_themselves() -> None:
    own = "def path(boxes, n=3):\n    return [(n, 0)] + (path(boxes, n - 1) if n else [])"
    earlier = {"path_1": own, "path_2": body("return path_1(boxes) + [(9, 9)]")}
    assert run_path(body("return path_2(boxes)"), BOXES, earlier=earlier) == ((3, 0), (2, 0), (1, 0), (0, 0), (9, 9))
    # A later function is not there for an earlier one: nothing goes round in a circle.
    with pytest.raises(SandboxError, match="NameError: name 'path_2' is not defined"):
        run_path(
            BY_NAME, BOXES, earlier={"path_1": body("return path_2(boxes)"), "path_2": body("return path_1(boxes)")}
        )
    # New code may take an earlier name and call itself through it; that ends as every endless call does.
    circle = "def path_1(boxes):\n    return path(boxes)\n\n" + BY_NAME
    with pytest.raises(SandboxError, match="RecursionError"):
        run_path(circle, BOXES, earlier={"path_1": LINE})


def test_only_what_is_named_is_run() -> None:
    endless = "while True:\n    pass\n" + LINE
    assert run_path(LINE, BOXES, earlier={"path_1": endless, "path_2": "not python ("}) == T1
    earlier = {"path_1": LINE, "path_2": endless, "path_3": BY_NAME, "path_10": endless}
    assert run_path(body("return path_3(boxes)"), BOXES, earlier=earlier) == T1
    assert list(called(body("return path_3(boxes)"), earlier)) == ["path_1", "path_3"]


@pytest.mark.parametrize("harm", [f"seen = {one}" for one in ESCAPES] + list(ENDLESS))
def test_an_earlier_function_can_do_no_more_than_new_code(harm: str) -> None:
    for code in (f"{harm}\n{LINE}", body(*(f"{harm}".split("; ")), "return [(1, 2), (3, 4)]")):
        points, ended = (), ""
        try:
            points = run_path(BY_NAME, BOXES, earlier={"path_1": code}, timeout_s=0.3)
        except SandboxError as error:
            ended = str(error)
        assert bool(points) != bool(ended)
        assert len(ended) <= MAX_ERROR_CHARACTERS + 200
        assert all(abs(value) <= 1e6 for point in points for value in point)


def test_what_cannot_be_put_beside_says_so_and_an_error_inside_names_the_new_codes_line() -> None:
    with pytest.raises(SandboxError, match="path_1 could not be put beside this code .*: write it without"):
        run_path(BY_NAME, BOXES, earlier={"path_1": "this is not python"})
    needs = body("return [boxes['T7'][:2], (0, 0)]")
    with pytest.raises(SandboxError, match=r"KeyError: '?T7'?\nin line 2: return path_1\(boxes\)"):
        run_path(BY_NAME, BOXES, earlier={"path_1": needs})


@pytest.mark.parametrize("indent", ["\t", "  ", "        "])
def test_code_is_taken_as_it_is_written(indent: str) -> None:
    lines = ["def path(boxes):", f"{indent}text = '''1 2", "3 4'''", f"{indent}rows = text.split('\\n')"]
    lines += [f"{indent}return [tuple(float(one) for one in row.split()) for row in rows]", "", "# the end"]
    assert run_path(BY_NAME, BOXES, earlier={"path_1": "\n".join(lines)}) == ((1, 2), (3, 4))


def test_one_of_more_code_than_may_be_run_is_named() -> None:
    with pytest.raises(SandboxError, match="path_1 has 30.* characters; at most 20000 are run"):
        run_path(BY_NAME, BOXES, earlier={"path_1": f"#{'x' * 30_000}\n{LINE}"})


def test_long_ones_run_too() -> None:
    long = f"# {'x' * 9_000}\n" + LINE + "\n" + "\n".join(f"unused_{k} = {k}" for k in range(500))
    earlier = {f"path_{k}": long for k in range(1, 13)}
    calls = " + ".join(f"path_{k}(boxes)[:1]" for k in range(1, 13))
    assert run_path(body(f"return {calls}"), BOXES, earlier=earlier) == T1[:1] * 12
