"""Programs that call the host's functions as no model should write them: what they do, lie about and hide, and combinations by chance."""

from __future__ import annotations

import math
import os
import random
import resource
import time
from pathlib import Path
from typing import Any

from tests.sandbox.programs import ENDLESS, ESCAPES, IMPORTS, Ran
from wonderful_team.sandbox import ProgramRun, SandboxError, run_program
from wonderful_team.sandbox.program import MAX_CALLS, MAX_DEPTH, MAX_NUMBER, MAX_PRINTED_CHARACTERS, MAX_TEXT_CHARACTERS
from wonderful_team.sandbox.returned import MAX_ERROR_CHARACTERS

FUNCTIONS = {"detect": "name", "go": "points, angle=0"}
KEPT = frozenset({"go"})
"""Calls of these are kept and need no answer."""

GOOD = ("print(detect('mug'))", "go([(1, 2)])", "detect('mug'); go([[3, 4.5]], 90)")
"""Calls as they should be."""

VALUES = (
    "'x' * 10_000_000", "'x' * 2_000", "10 ** 5000", "10 ** 400", "-10 ** 13", "float('nan')", "float('-inf')", "lambda: 1", "{1, 2}", "b'x'", "detect",
    "'\\x00\\x1b[2J\\x1d'", "[[i] * 50 for i in range(200)]", "{(1, 2): 3}", "{'id': [1]}", "nested", "shared", "'mug'", "[(1, 2)]",
)  # fmt: skip
"""What a call is given."""

FORGED = (
    '["go", []]', '["go", [1]]', '["go", [1, 2, 3]]', '["detect", []]', '["detect", [1, 2]]', '["open", ["/etc/passwd"]]', '["_call", ["go", []]]', "[]", "3", "",
    '["go", {"points": 1}]', '[["go"], [1, 2]]', '[null, [1, 2]]', '["go", [1e999, 0]]', '["go", [NaN, 0]]', '["go", [-Infinity, 0]]', '["go", [1, 2], 3]',
    '["go", [\' + "9" * 4000 + \', 0]]', '["go", [\' + "[" * 900 + "]" * 900 + \', 0]]', '["go", [\' + "[" * 30000 + \', 0]]', '["detect", ["\\\\ud800"]]',
    '["go", [{"\\\\udfff": 1}, 0]]', '["go", [1, 0]]', '["detect", ["mug"]]', "{", '["go", [1,',
)  # fmt: skip
"""What stands behind the mark on a line that a program prints itself."""

OVERRIDES = (
    "_call = lambda name, given: 7", "_made = _asked = []", "_answers += [{'value': 3}] * 99", "_answers.clear()", "_answers = 3", "_unanswered.append('detect')",
    "_unanswered = None", "print = lambda *said: None", "len = lambda a: -1", "detect = go", "def go(*a, **b):\n    return _call('open', ['/etc/passwd'])",
    "class _Json:\n    def dumps(self, given):\n        return '[\"go\", []]'\n_json = _Json()", "ValueError = KeyboardInterrupt", "KeyboardInterrupt = ValueError",
)  # fmt: skip
"""Redefinitions of what passes calls on."""

_LOOPS = ("for k in range(3000):", "while True:", *["for k in range(5):"] * 3)
_HIDDEN = ("try:", "    {}", "except BaseException:", "    pass")
_BEFORE = "nested = shared = [1]\nfor _ in range(60):\n    nested = [nested]\nfor _ in range(14):\n    shared = [shared, shared]\n"


def calling_program(rng: random.Random) -> str:
    """A program in which calls, lies about calls and harm are put together."""
    lines: list[str] = []
    for _ in range(rng.randrange(1, 5)):
        kind = rng.random()
        if kind < 0.3:
            harm = [rng.choice(GOOD)]
        elif kind < 0.55:
            harm = [f"{rng.choice(('', 'seen = '))}{rng.choice(('detect', 'go'))}({rng.choice(VALUES)})"]
        elif kind < 0.7:
            harm = [f"print('\\x1d' + '{rng.choice(FORGED)}')"]
        elif kind < 0.9:
            harm = [f"print(len({rng.choice(ESCAPES)}))"] if rng.random() < 0.5 else list(rng.choice(IMPORTS))
        else:
            harm = [rng.choice(ENDLESS)]
        # Most of them hide what went wrong, and go on.
        if rng.random() < 0.7:
            harm = [
                f"    {one}" if "{}" in line else line for line in _HIDDEN for one in (harm if "{}" in line else [line])
            ]
        if rng.random() < 0.4:
            harm = [rng.choice(_LOOPS), *(f"    {one}" for one in harm)]
        lines += harm
    # Calls after the end: what follows a call that was never answered, and a program that has failed.
    lines += rng.choice(
        ((), ("go(1)",), ("print('mug')", "detect('mug')"), ("raise ValueError('x' * 10_000_000)",), ())
    )
    code = "\n".join(lines)
    code = code.replace("path(boxes)", "detect('again')").replace("path.", "detect.").replace("boxes", "{}")
    code = f"{_BEFORE}{code}" if "nested" in code or "shared" in code else code
    if rng.random() < 0.3:
        code = f"{rng.choice(OVERRIDES)}\n{code}"
    if rng.random() < 0.1:
        at, length = rng.randrange(len(code)), rng.randrange(1, 12)
        code = code[:at] + code[at + length :]
    return code


def ran_calling(code: str, timeout_s: float = 0.3, over_s: float = 2.0) -> Ran:
    """Run a program whose calls are answered as a method answers them; it comes to kept calls or a named error, both within bounds."""
    planted = Path("/tmp/out.txt")
    there, memory_kb = planted.exists(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    started, runs, text, wrong = time.monotonic(), 0, "", list[str]()
    answers: list[dict[str, Any]] = []
    ended = "calls"
    try:
        while True:
            runs += 1
            run = run_program(code, FUNCTIONS, answers, unanswered=KEPT, timeout_s=timeout_s)
            wrong += problems_of(run)
            text += run.printed
            if not run.waits or runs > MAX_CALLS:
                break
            answers.append({"value": [{"x": 5}]} if len(answers) % 3 else {"error": "no such thing"})
    except SandboxError as error:
        ended, text = "error", text + str(error)
        wrong += (
            [f"an error text of {len(str(error))} characters"] if len(str(error)) > MAX_ERROR_CHARACTERS + 400 else []
        )
    seconds = time.monotonic() - started
    checks = {
        f"took {seconds:.1f} s for {runs} runs": seconds > runs * (timeout_s + over_s),
        "was run more often than it may call": runs > MAX_CALLS,
        "a file was written": planted.exists() and not there,
        "a file was read": "root:" in text or (home := os.environ.get("HOME", "")) != "" and f"{home}'" in text,
        "memory ran up": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory_kb > 512 * 1024,
    }
    return Ran(ended, seconds, wrong + [words for words, holds in checks.items() if holds])


def problems_of(run: ProgramRun) -> list[str]:
    """What a run's calls and output must not be: whoever reads them would fail."""
    wrong = [f"{len(run.calls)} calls"] if len(run.calls) > MAX_CALLS else []
    wrong += [f"printed {len(run.printed)} characters"] if len(run.printed) > MAX_PRINTED_CHARACTERS + 60 else []
    for call in run.calls:
        known = FUNCTIONS.get(call.function)
        if known is None or len(call.arguments) != len(known.split(",")):
            wrong.append(f"a call of {str(call.function)[:40]!r} with {len(call.arguments)} values")
        wrong += [f"{call.function} is given {words}" for one in call.arguments for words in _unreadable(one)]
    return wrong


def _unreadable(value: Any, depth: int = 0) -> list[str]:
    if depth > MAX_DEPTH:
        return [f"more than {MAX_DEPTH} lists inside each other"]
    if isinstance(value, list | dict):
        inside = value if isinstance(value, list) else [one for pair in value.items() for one in pair]
        return [words for one in inside for words in _unreadable(one, depth + 1)]
    if isinstance(value, str):
        try:
            value.encode()
        except UnicodeEncodeError:
            return ["half a character"]
        return [f"a text of {len(value)} characters"] if len(value) > MAX_TEXT_CHARACTERS else []
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            fits = math.isfinite(value) and abs(value) <= MAX_NUMBER
        except OverflowError:
            fits = False
        return [] if fits else ["a number that is none of a table"]
    return [] if value is None or isinstance(value, bool) else [f"a {type(value).__name__}"]
