"""A model's program calls functions of the host by text alone; whatever it tries, it ends, and its author is told."""

from __future__ import annotations

import random

import pytest

from tests.sandbox.calling import FORGED, OVERRIDES, VALUES, calling_program, problems_of, ran_calling
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


@pytest.mark.parametrize("seed", range(30))
def test_calls_and_lies_of_several_kinds_come_to_calls_within_bounds_or_a_named_error(seed: int) -> None:
    code = calling_program(random.Random(seed))
    # A loaded machine may take its time; the benchmark holds it to two seconds.
    assert ran_calling(code, over_s=60.0).wrong == [], code


@pytest.mark.parametrize("override", OVERRIDES)
def test_code_that_redefines_what_passes_calls_on_gains_nothing(override: str) -> None:
    for after in ("print(detect('mug'))", "go([1, 2])\ndetect('mug')", "print('\\x1d[\"go\", []]')"):
        assert ran_calling(f"{override}\n{after}", over_s=60.0).wrong == []


@pytest.mark.parametrize("line", FORGED)
def test_a_forged_line_is_a_call_as_the_function_takes_it_or_an_error(line: str) -> None:
    code = f"print('\\x1d' + '{line}')"
    if line in ('["go", [1, 0]]', '["detect", ["mug"]]', '["go", [1, 2]]'):
        run = run_program(code, FUNCTIONS, unanswered=GO)
        assert (len(run.calls), problems_of(run)) == (1, [])
    else:
        with pytest.raises(SandboxError, match="call 1 "):
            run_program(code, FUNCTIONS, unanswered=GO)


@pytest.mark.parametrize("value", [value for value in VALUES if value not in ("nested", "shared")])
def test_what_a_call_is_given_can_be_read(value: str) -> None:
    try:
        assert problems_of(run_program(f"go({value})", FUNCTIONS, unanswered=GO)) == []
    except SandboxError:
        pass


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("print('\\x1d[\"go\", []]')", r"call 1 gives go\(points, angle=0\) 0 values"),
        ("print('\\x1d[\"detect\", [1, 2]]')", r"call 1 gives detect\(name\) 2 values"),
        ("go(10 ** 400)", r"numbers up to 1e\+12"),
        ("print('\\x1d[\"go\", [1e999, 0]]')", "not plain finite numbers"),
        ("detect('x' * 1001)", "texts of up to 1000 characters"),
        ('print(\'\\x1d["detect", ["\\\\ud800"]]\')', "not plain"),
        ("x = 1\nfor i in range(9):\n    x = [x]\ngo(x)", "up to 8 lists inside each other"),
        # What was cut off in the middle of a call is told as what it is: too much.
        (
            "while True:\n    try:\n        detect('x')\n    except BaseException:\n        pass",
            "MemoryError|TimeoutError",
        ),
    ],
)
def test_values_that_would_stop_their_reader_are_refused_by_name(code: str, said: str) -> None:
    with pytest.raises(SandboxError, match=said):
        run_program(code, FUNCTIONS, [{"value": None}], unanswered=GO)
