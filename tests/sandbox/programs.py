"""Programs as no model should write them: one way to do harm each, and combinations of them by chance."""

from __future__ import annotations

import math
import os
import random
import resource
import time
from dataclasses import dataclass, field
from pathlib import Path

from wonderful_team.core.geometry import Box
from wonderful_team.sandbox import SandboxError, run_path
from wonderful_team.sandbox.returned import MAX_ERROR_CHARACTERS

BOXES = {"T1": Box(10, 20, 30, 60), "T2": Box(50, 20, 60, 30)}
MOST_POINTS = 20


def body(*lines: str) -> str:
    """A function `path` of these lines."""
    return "def path(boxes):\n" + "\n".join(f"    {line}" for line in lines)


ESCAPES = (
    "open('/etc/passwd').read()",
    "open('/tmp/out.txt', 'w').write('x')",
    "__import__('os').system('true')",
    "__import__('subprocess')",
    "().__class__.__mro__[1].__subclasses__()",
    "path.__globals__",
    "path.__code__",
    "__builtins__",
    'eval(\'__import__("os").listdir("/")\')',
    "exec('import socket')",
    "'{0.__class__}'.format(boxes)",
    "[x for x in __loader__.path]",
    "globals()['__builtins__']['open']('/etc/passwd')",
    "getattr(boxes, '__cla' + 'ss__').__base__",
)
"""Expressions that reach for what is outside."""

IMPORTS = (
    ("import os", "os.listdir('/')"),
    ("import os", "os.environ['HOME']"),
    ("import os", "os.system('true')"),
    ("import socket",),
    ("import ctypes",),
    ("import subprocess",),
    ("import sys", "sys.modules['os']"),
    ("import numpy",),
    ("from pathlib import Path", "Path('/etc/passwd').read_text()"),
    ("import builtins", "builtins.open('/etc/passwd')"),
)
"""Statements that reach for what is outside."""

LARGE = (
    body("a = {1: 2}", "for i in range(60):", "    a = {1: a, 2: a}", "return [a, a]"),
    body("a = [1, 2]", "for i in range(60):", "    a = [a, a]", "return a"),
    body("a = (1, 2)", "for i in range(60):", "    a = (a, a)", "return {1: a}"),
    body("return 10**5000"),
    body("return [(10**5000, 1), (1, 1)]"),
    body("return ['x' * 20_000_000, 'y']"),
    body("return list(range(1_000_000))"),
    body("raise ValueError('x' * 10_000_000)"),
    body("a = [1]", "for i in range(60):", "    a = [a, a]", "raise ValueError(str(len(a)) + 'x' * 5_000_000)"),
    "x" * 19_000 + " = y",
    "class Path:\n    def __repr__(self):\n        return 'x' * 5_000_000\n" + body("return Path()"),
)
"""Programs whose value or error text would exhaust whoever reads it."""

OVERRIDES = (
    "isinstance = lambda a, b: True\nlen = lambda a: 2",
    "str = lambda value: 'point inf inf'",
    "_described = 3",
    "float = lambda value: 'nan'",
    "print = lambda text: None",
    "repr = str = lambda value: '\\n' * 1000",
)
"""Redefinitions of the words that describe what is returned."""

ENDLESS = (
    "while True: pass", "sum(range(10**12))", "9 ** 9 ** 9", "path(boxes)", "print('x' * 10**7)", "[0] * 10**9",
    "import time; time.sleep(30)",
)  # fmt: skip
"""Lines that never end, or take all the memory that there is."""

_HIDDEN = ("try:", "    {}", "except BaseException:", "    pass")
_AROUND = (
    ("{}",), _HIDDEN, ("def inner():", "    {}", "inner()"),
    ("for k in range(3):", "    {}"), ("if boxes:", "    {}"), ("try:", "    pass", "finally:", "    {}"),
    ("lambda_ = [1, 2, 3]", "while lambda_:", "    lambda_.pop()", "    {}"),
)  # fmt: skip
_RETURNED = (
    "[(1, 2), (3, 4)]", "[[boxes['T1'][0], 2.5], (3, 4)]", "[[1, 'a'], {}]", "3", "[(float('nan'), 1), (1, 1)]", "[]", "boxes", "[(1, 2)] * 10**6", "None",
    "[(boxes['T1'][0], boxes['T9'][0])]",
)  # fmt: skip


def program(rng: random.Random) -> str:
    """A program in which harm of several kinds is put together."""
    if rng.random() < 0.1:
        return rng.choice(LARGE)
    # Half of them hide what went wrong, and give a path all the same.
    hidden = rng.random() < 0.5
    lines: list[str] = []
    for _ in range(rng.randrange(1, 4)):
        kind = rng.random()
        if kind < 0.5:
            harm = [f"{rng.choice(('seen = ', '', 'return '))}{rng.choice(ESCAPES)}"]
        elif kind < 0.8:
            harm = list(rng.choice(IMPORTS))
        else:
            harm = [rng.choice(ENDLESS)]
        around = _HIDDEN if hidden else rng.choice(_AROUND)
        for line in around:
            spaces = line[: len(line) - len(line.lstrip())]
            lines += [line] if "{}" not in line else [f"{spaces}{one}" for one in harm]
    lines.append(f"return {rng.choice(_RETURNED if rng.random() < 0.8 else ESCAPES)}")
    code = body(*lines)
    if rng.random() < 0.3:
        code = f"{rng.choice(OVERRIDES)}\n{code}"
    if rng.random() < 0.1:
        # Words that a model left out, doubled, or mixed up.
        at, length = rng.randrange(len(code)), rng.randrange(1, 12)
        code = code[:at] + code[at + length :]
    return code


@dataclass
class Ran:
    """What came of one program: how it ended, and what must not be."""

    ended: str
    seconds: float
    wrong: list[str] = field(default_factory=list)


def ran(code: str, timeout_s: float = 0.3, over_s: float = 2.0) -> Ran:
    """Run a program; points or a named error within the limit and a little over, short, with nothing touched outside."""
    planted = Path("/tmp/out.txt")
    there, memory_kb = planted.exists(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    started, text, wrong = time.monotonic(), "", list[str]()
    try:
        points = run_path(code, BOXES, max_points=MOST_POINTS, timeout_s=timeout_s)
        ended = "points"
        if not 2 <= len(points) <= MOST_POINTS or not all(math.isfinite(x) for point in points for x in point):
            wrong.append(f"returned {str(points)[:200]}")
    except SandboxError as error:
        ended, text = "error", str(error)
    seconds = time.monotonic() - started
    checks = {
        f"took {seconds:.1f} s": seconds > timeout_s + over_s,
        f"an error text of {len(text)} characters": len(text) > MAX_ERROR_CHARACTERS + 400,
        "a file was written": planted.exists() and not there,
        "a file was read": "root:" in text or (home := os.environ.get("HOME", "")) != "" and f"{home}'" in text,
        "memory ran up": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory_kb > 512 * 1024,
    }
    return Ran(ended, seconds, wrong + [words for words, holds in checks.items() if holds])
