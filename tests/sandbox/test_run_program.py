"""A model's program calls functions of the host by text alone; whatever it tries, it ends, and its author is told."""

from __future__ import annotations

import pytest

from tests.sandbox.programs import ESCAPES
from wonderful_team.sandbox import HostCall, SandboxError, run_program

FUNCTIONS = {"detect": "name", "go": "points, angle=0"}
GO = frozenset({"go"})


def test_it_stops_where_an_answer_is_missing_and_goes_on_with_it() -> None:
    code = "found = detect('mug')\nprint(found)\ngo([(found[0]['x'], 2)])"
    first = run_program(code, FUNCTIONS, unanswered=GO)
    assert (first.calls, first.printed, first.waits) == ((HostCall("detect", ("mug",)),), "", True)
    then = run_program(code, FUNCTIONS, [{"value": [{"x": 5}]}], unanswered=GO)
    assert then.calls == (HostCall("detect", ("mug",)), HostCall("go", ([[5, 2]], 0)))
    assert (then.printed, then.waits) == ("[{'x': 5}]", False)


def test_an_error_of_the_host_is_raised_in_the_program_with_its_line() -> None:
    with pytest.raises(SandboxError, match=r"ValueError: no such thing\nin line 2: detect\('x'\)"):
        run_program("a = 1\ndetect('x')", FUNCTIONS, [{"error": "no such thing"}])
    caught = run_program("try:\n    detect('x')\nexcept ValueError as e:\n    print(e)", FUNCTIONS, [{"error": "gone"}])
    assert caught.printed == "gone"


def test_a_program_that_swallows_the_stop_is_answered_all_the_same() -> None:
    run = run_program("try:\n    detect('x')\nexcept:\n    pass\ndetect('y')", FUNCTIONS)
    assert (run.calls, run.waits) == ((HostCall("detect", ("x",)),), True)


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("go(float('nan'))", "not plain finite numbers"),
        ("go(10 ** 5000)", "ValueError"),
        ("x = [1]\nfor i in range(60):\n    x = [x, x]\ngo(x)", "MemoryError|TimeoutError|stopped from outside"),
        ("x = []\nfor i in range(3000):\n    x = [x]\ngo(x)", "RecursionError"),
        ("for i in range(200):\n    go(i)", "at most 100 functions|more than 100 functions"),
        ("print('a' * 100000)", "MemoryError"),
        ("detect()", "missing 1 required positional argument"),
        ("open('/etc/passwd')", "PermissionError|NameError"),
        ("import os\nos.listdir('/')", "line 2|ModuleNotFoundError"),
        ("print('\\x1d[\"open\", []]')", "no function that there is; valid: detect, go"),
        ("x = ", "SyntaxError"),
        ("y" * 20_001, "20001 characters; at most 20000"),
    ],
)
def test_harm_and_nonsense_end_as_errors_for_the_author(code: str, said: str) -> None:
    with pytest.raises(SandboxError, match=said):
        run_program(code, FUNCTIONS, [{"value": None}], unanswered=GO)


@pytest.mark.parametrize("expression", ESCAPES)
def test_nothing_outside_is_reached(expression: str) -> None:
    reached = expression.replace("path.", "detect.").replace("boxes", "{}")
    with pytest.raises(SandboxError):
        run_program(f"print(len({reached}))", FUNCTIONS)


def test_what_is_printed_is_cut_and_never_taken_for_an_answer() -> None:
    run = run_program("for i in range(3000):\n    print(i)", FUNCTIONS)
    assert len(run.printed) < 4_100
    assert "more characters" in run.printed
    # Printing what looks like a call is a call, no more.
    assert run_program("print('\\x1d[\"go\", [1, 2]]')", FUNCTIONS, unanswered=GO).calls == (HostCall("go", (1, 2)),)
