"""A model's function gives a path, or words that help its author; it cannot reach anything else."""

from __future__ import annotations

import subprocess
import sys
import threading
import time

import pytest

from tests.sandbox.programs import BOXES, ESCAPES, IMPORTS, body
from wonderful_team.errors import PlanError, WonderfulTeamError
from wonderful_team.sandbox import SandboxError, run_path

CIRCLE = """
import math

def path(boxes):
    x0, y0, x1, y1 = boxes["T1"]
    centre = ((x0 + x1) / 2, (y0 + y1) / 2)
    radius = math.hypot(x1 - x0, y1 - y0) / 2
    return [
        (centre[0] + radius * math.cos(k * math.pi / 4), centre[1] + radius * math.sin(k * math.pi / 4))
        for k in range(9)
    ]
"""


def test_a_circle_round_a_box() -> None:
    points = run_path(CIRCLE, BOXES)
    assert len(points) == 9
    assert points[0] == pytest.approx((20 + 500**0.5, 40))
    assert points[2] == pytest.approx((20, 40 + 500**0.5))
    assert points[0] == pytest.approx(points[-1])


def test_integers_and_lists_become_points() -> None:
    assert run_path(body("return [[1, 2], (3, 4.5)]"), BOXES) == ((1.0, 2.0), (3.0, 4.5))


def test_runs_are_fresh_and_repeatable() -> None:
    run_path("seen = 1\n" + body("return [(1, 1), (2, 2)]"), BOXES)
    with pytest.raises(SandboxError, match="NameError.*seen"):
        run_path(body("return [(seen, 1), (2, 2)]"), BOXES)
    noisy = "import random, datetime\n" + body(
        "return [(random.random(), random.random()), (datetime.datetime.now().microsecond, 1)]"
    )
    assert run_path(noisy, BOXES) == run_path(noisy, BOXES)


def test_a_warm_run_takes_milliseconds() -> None:
    run_path(CIRCLE, BOXES)
    start = time.perf_counter()
    for _ in range(20):
        run_path(CIRCLE, BOXES)
    assert (time.perf_counter() - start) / 20 < 0.1


def test_error_is_a_method_failure() -> None:
    assert issubclass(SandboxError, PlanError)
    assert issubclass(SandboxError, WonderfulTeamError)


@pytest.mark.parametrize(
    ("code", "says"),
    [
        ("def path(boxes:\n    return 1", r"SyntaxError(?s:.*)in line 2: return 1"),
        (body("return boxes['T9']"), r"KeyError: T9\nin line 2: return boxes\['T9'\]"),
        (body("x = 1", "return [(x / 0, 1)] * 2"), r"ZeroDivisionError(?s:.*)in line 3"),
        ("x = 3", r"does not define a function path\(boxes\)"),
        ("def path():\n    return 3", r"TypeError: path\(\) takes 0 positional arguments"),
        (body("yield (1, 2)"), "NotImplementedError(?s:.*)plain functions"),
        (body("while True: pass"), "TimeoutError(?s:.*)check the loops"),
        (body("try:", "    while True: pass", "except BaseException:", "    return [(1, 1), (2, 2)]"), "TimeoutError"),
        (body("return sum(range(10**12))"), "TimeoutError"),
        ("import time\n" + body("time.sleep(30)", "return [(1, 1), (2, 2)]"), "TimeoutError(?s:.*)do not wait"),
        (body("return [0] * 10**9"), "MemoryError(?s:.*)few points"),
        (body("return 9 ** 9 ** 9"), "MemoryError"),
        (body("return path(boxes)"), "RecursionError(?s:.*)loop"),
        (body("print('x' * 10**7)", "return [(1, 1), (2, 2)]"), "MemoryError"),
        (body("return"), r"must return a list of \(x, y\), or of \(x, y, up\), it returned None"),
        (body("return {1: 2}"), "must return a list"),
        (body("return []"), "returned 0 points; 2 to 20"),
        (body("return [(1, 2)]"), "returned 1 points; 2 to 20"),
        (body("return [(i, i) for i in range(21)]"), "returned 21 points; 2 to 20"),
        (body("return [(1, 2), (3, 4, 0.5)]"), "point 2 must say up as point 1 does, or neither"),
        (body("return [(1, 2, 0), (3, 4, 1.5)]"), r"point 2 .* up must be finite metres, from -1.0 to 1.0"),
        (body("return [(1, 2, float('nan')), (3, 4, 0)]"), "point 1 .* up must be finite metres"),
        (body("return [(1, 2, 3, 4)] * 2"), r"point 1 must be \(x, y\) or \(x, y, up\)"),
        (body("return [1, 2, 3]"), r"point 1 must be \(x, y\) or \(x, y, up\)"),
        (body("return ['ab', 'cd']"), r"point 1 must be \(x, y\) or \(x, y, up\)"),
        (body("return [('1', '2'), ('3', '4')]"), "point 1 must hold numbers"),
        (body("return [(True, 1), (2, 3)]"), "point 1 must hold numbers"),
        (body("return [(1, 1), (float('nan'), 1)]"), "point 2 is .nan, 1.; x and y must be finite"),
        (body("return [(1, 1), (1, float('-inf'))]"), "point 2 .*finite"),
        (body("return [(10**400, 1), (1, 1)]"), "point 1 is .a very large number, 1."),
        ("#" * 30_000, "30000 characters; at most 20000"),
    ],
)
def test_failures_say_what_to_mend(code: str, says: str) -> None:
    with pytest.raises(SandboxError, match=says):
        run_path(code, BOXES, timeout_s=0.3)


@pytest.mark.parametrize("attempt", ESCAPES)
def test_escapes_fail(attempt: str) -> None:
    with pytest.raises(SandboxError, match="Error"):
        run_path(body(f"return {attempt}, {attempt}"), BOXES)


@pytest.mark.parametrize("lines", IMPORTS)
def test_imports_and_files_are_refused(lines: tuple[str, ...]) -> None:
    with pytest.raises(SandboxError, match="Error"):
        run_path(body(*lines, "return [(1, 1), (2, 2)]"), BOXES)


def test_the_pool_recovers_after_a_killed_worker() -> None:
    with pytest.raises(SandboxError):
        run_path(body("return [float(i) for i in range(10**7)]"), BOXES)
    assert len(run_path(CIRCLE, BOXES)) == 9


def test_what_it_prints_reaches_nobody(capfd: pytest.CaptureFixture[str]) -> None:
    run_path(body("print('hello')", "return [(1, 1), (2, 2)]"), BOXES)
    assert capfd.readouterr() == ("", "")


def test_threads_share_the_pool() -> None:
    lengths: list[int] = []
    threads = [threading.Thread(target=lambda: lengths.append(len(run_path(CIRCLE, BOXES)))) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert lengths == [9] * 6


def test_python_exits_quietly_and_leaves_no_worker() -> None:
    code = (
        "from wonderful_team.sandbox import run_path\n"
        "print(run_path('def path(boxes):\\n    return [(1, 2), (3, 4)]', {}))"
    )
    ended = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, timeout=30)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert ended.stdout.strip() == "((1.0, 2.0), (3.0, 4.0))"


def test_self_containing_lists_are_refused() -> None:
    with pytest.raises(SandboxError, match="point 1 must hold numbers"):
        run_path(body("l = []", "l += [l, l]", "return l"), BOXES)
