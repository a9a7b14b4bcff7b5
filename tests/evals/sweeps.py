"""Sweeps in processes of their own, killed with all their workers as a machine that loses power would."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from tests.evals import runners
from tests.interrupting import listen
from wonderful_team.evals.store import Store

ROOT = Path(__file__).parents[2]
TRIALS = 80
LONGEST_S = 120.0

SWEEP = """
from pathlib import Path
from tests.evals import runners
from wonderful_team.evals.study import run_study
if __name__ == "__main__":
    run_study(runners.toy_plan(20), Path({store!r}), runners.slow, jobs=2)
"""


def start(tmp_path: Path, log: Path) -> subprocess.Popen[bytes]:
    script = tmp_path / "sweep.py"
    script.write_text(SWEEP.format(store=str(tmp_path / "s.db")), encoding="utf-8")
    environment = {**os.environ, "TOY_LOG": str(log), "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'src'}"}
    # A group of its own, so that parent and workers can be killed together, as a machine that loses power would.
    return subprocess.Popen([sys.executable, str(script)], env=environment, start_new_session=True, preexec_fn=listen)


def lines(log: Path) -> list[str]:
    return log.read_text(encoding="utf-8").splitlines() if log.exists() else []


@dataclass
class Killed:
    """What came of one sweep: how often it was killed, whether it then ended, and what must not be."""

    kills: int
    hung: bool = False
    wrong: list[str] = field(default_factory=list)


def killed(folder: Path, seed: int, most: int = 5) -> Killed:
    """Kill a sweep at random moments, let it end, and count what is in its store."""
    log, rng, kills = folder / "log", random.Random(seed), 0
    while kills < most:
        process = start(folder, log)
        before = len(lines(log))
        while process.poll() is None and len(lines(log)) < before + 4:
            time.sleep(0.01)
        time.sleep(rng.uniform(0, 0.25))
        if process.poll() is not None:
            break
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        kills += 1
    last = start(folder, log)
    try:
        code = last.wait(timeout=LONGEST_S)
    except subprocess.TimeoutExpired:
        os.killpg(last.pid, signal.SIGKILL)
        last.wait()
        return Killed(kills, hung=True, wrong=[f"seed {seed}: no end within {LONGEST_S:g} s"])
    with Store(folder / "s.db") as store:
        rows = store.rows()
    began = Counter(line[6:] for line in lines(log) if line.startswith("begin "))
    wrong = {
        f"it ended with {code}": code != 0,
        f"{len(rows)} trials stand in the store": not len(rows) == len({row.spec.key for row in rows}) == TRIALS,
        "a trial has no result": any(row.result is None for row in rows),
        "a result is not the trial's own": any(
            row.result is not None and (row.result.outcome == "success") != runners.wins(row.spec) for row in rows
        ),
        "a trial was never run": set(began) != {row.spec.key for row in rows},
        # Two workers: at most two trials were in flight at each kill, and only those run again.
        f"{sum(began.values()) - TRIALS} trials ran again": sum(began.values()) - TRIALS > 2 * kills,
    }
    return Killed(kills, wrong=[f"seed {seed}: {words}" for words, holds in wrong.items() if holds])
