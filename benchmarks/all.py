"""The figures of speed and growth in one table, with the aim beside each: CPU time of our own work, whatever else the machine does.

    python -m benchmarks.all --quick            # three minutes of CPU
    python -m benchmarks.all --only record      # rows whose name holds a word
    python -m benchmarks.all                    # more scenes and repetitions

Every row runs in a process of its own (a fresh heap, nothing warm from the row before). A local server that answers is not
counted. Compare two versions by running this in both, in turn: ratios hold on a loaded machine, single figures less so.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import multiprocessing
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import warnings
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from wonderful_team.evals.processes import one_thread_each

if TYPE_CHECKING:
    from tests.servers.server import WireServer


@dataclass(frozen=True)
class Row:
    """One figure.

    Attributes:
        measure: From "quick" to the value in words.
        as_worker: Measured as a study's worker runs it: on one core, with no threads beside it.
    """

    name: str
    aim: str
    measure: Callable[[bool], str]
    as_worker: bool = False


def request_ms(size: tuple[int, int], quick: bool) -> str:
    """Draw and encode, and the whole of a request, as means over three kinds of question."""
    from benchmarks.request_cost import QUESTIONS, measure

    costs = [asyncio.run(measure("openai-chat", one, size, 5 if quick else 15)) for one in QUESTIONS]
    part = statistics.mean(cost.draw_ms + cost.encode_ms for cost in costs)
    return f"{part:.1f} / {statistics.mean(cost.total_ms for cost in costs):.1f} ms"


def plan_ms(method: str, quick: bool) -> str:
    """CPU of whole plans for a photo over a server, record and page included, by request."""
    import wonderful_team as wt
    from benchmarks.request_cost import photo
    from tests.planning.stub_model import stub_script
    from tests.servers.brains import AgentSession, Tapped, typed_brain
    from tests.servers.server import Rules, WireServer
    from tests.servers.wiring import WIRES

    script, session, wire = stub_script(), AgentSession(), WIRES["openai-chat"]
    brain = typed_brain(session, lambda request: script[request.contract](request), wire.speech)
    used, requests = 0.0, 0
    with WireServer(brain, Rules(), remember=False) as server, tempfile.TemporaryDirectory() as out:
        for turn in range(3 if quick else 8):
            model = Tapped(wire.provider(server, deadline_s=60.0), session)
            view = photo((640, 480), turn)
            before = _own_cpu_s(server)
            made = wt.Team(model=model, method=method, out=out, cache="off", allow_unpriced=True).plan(
                view.rgb, "put the one into the other"
            )
            if turn:  # the first one loads and compiles
                used += _own_cpu_s(server) - before
                requests += made.usage.calls
    return f"{1000 * used / requests:.0f} ms"


def _own_cpu_s(server: WireServer) -> float:
    """CPU time of this process without the threads of the server that answers [s]."""
    serving = [one for one in threading.enumerate() if one is server._thread or one.name.startswith("asyncio_")]
    return time.process_time() - sum(map(_thread_cpu_s, serving))


def _thread_cpu_s(thread: threading.Thread) -> float:
    assert thread.ident is not None
    return time.clock_gettime(time.pthread_getcpuclockid(thread.ident))


def trial_s(model: str, quick: bool) -> str:
    """CPU of one scene of each task: set up, planned, run and scored, without a record."""
    from benchmarks.perfect import VIMA_TASKS, Job, by_team

    jobs = [
        Job(f"tabletop/{task}", seed, "lean", "full", model, 0, None, "", "")
        for task in VIMA_TASKS
        for seed in range(300000, 300001 if quick else 300004)
    ]
    by_team(jobs[0])
    before = time.process_time()
    solved = sum(by_team(job)[0] for job in jobs)
    return f"{(time.process_time() - before) / len(jobs):.2f} s ({solved}/{len(jobs)} solved)"


def kept_trial_s(quick: bool) -> str:
    """The same as `bench` runs it by default: a record is written of trials that do not succeed."""
    from benchmarks.perfect import VIMA_TASKS
    from wonderful_team.api.trial import run_trial
    from wonderful_team.evals.trials import Condition, RunSettings, TrialSpec

    condition = Condition("team", "simulated:perfect")
    specs = [
        TrialSpec(f"tabletop/{task}", seed, condition)
        for task in VIMA_TASKS
        for seed in range(900000, 900001 if quick else 900004)
    ]
    with tempfile.TemporaryDirectory() as out:
        settings = RunSettings(record="failures", out=Path(out))
        run_trial(specs[0], settings)
        before = time.process_time()
        solved = sum(run_trial(spec, settings).outcome == "success" for spec in specs)
        return f"{(time.process_time() - before) / len(specs):.2f} s ({solved}/{len(specs)} solved)"


def settings_trial_s(quick: bool) -> str:
    """CPU of a trial where nine settings run on each scene in turn, as a study orders them: 81 trials, or 324."""
    from wonderful_team.api.trial import run_trial
    from wonderful_team.evals.suites import ABLATED
    from wonderful_team.evals.trials import Condition, RunSettings, TrialSpec

    methods = ("team", "team:paper", *(f"team:s{number}" for number in range(1, 8)))
    specs = [
        TrialSpec(f"tabletop/{task}", seed, Condition(method, "simulated:perfect"))
        for seed in range(700000, 700001 if quick else 700004)
        for task in ABLATED
        for method in methods
    ]
    with tempfile.TemporaryDirectory() as out:
        settings = RunSettings(record="none", out=Path(out))
        for method in methods[:2]:
            run_trial(TrialSpec("tabletop/rotate", 1, Condition(method, "simulated:perfect")), settings)
        before = time.process_time()
        solved = sum(run_trial(spec, settings).outcome == "success" for spec in specs)
        return f"{(time.process_time() - before) / len(specs):.2f} s ({solved}/{len(specs)} solved)"


def opening_s(quick: bool) -> str:
    """CPU of opening a study's store by the study, which checks all of it, and by each of its workers."""
    from benchmarks.store_growth import made_up
    from wonderful_team.evals.store import Store

    size = 20_000 if quick else 100_000
    with tempfile.TemporaryDirectory() as folder:
        path = made_up(size, Path(folder))
        marks = [time.process_time()]
        for checked in (False, True):
            Store(path, checked=checked).close()
            marks.append(time.process_time())
    study, worker = (1e6 / size * (after - before) for before, after in zip(marks, marks[1:], strict=False))
    return f"{study:.1f} s / {worker:.1f} s for a million, from {size:,}"


def oracle_ms(quick: bool) -> str:
    """CPU of an oracle's episode: set up, physics, scoring; nothing is drawn."""
    from benchmarks.perfect import VIMA_TASKS, Job, by_oracle

    jobs = [
        Job(f"tabletop/{task}", seed, "lean", "full", "", 0, None, "", "")
        for task in VIMA_TASKS
        for seed in range(300000, 300002 if quick else 300010)
    ]
    by_oracle(jobs[0])
    before = time.process_time()
    solved = sum(by_oracle(job) for job in jobs)
    return f"{1000 * (time.process_time() - before) / len(jobs):.0f} ms ({solved}/{len(jobs)} solved)"


def arm_s(quick: bool) -> str:
    """CPU of an episode on the arm by the oracle, nothing drawn: over ten tasks, and of the slowest."""
    from benchmarks.arm_episodes import TASKS, means_s

    means, solved, count = means_s(TASKS, range(5000, 5001 if quick else 5003))
    slowest = max(means, key=lambda task: means[task])
    return f"{statistics.mean(means.values()):.1f} s, {slowest} {means[slowest]:.1f} s ({solved}/{count} solved)"


def blocks_s(count: int, quick: bool) -> str:
    """CPU of a plan by `offline` for "every red block into the bowl"."""
    import wonderful_team as wt
    from benchmarks.growth import blocks

    with tempfile.TemporaryDirectory() as out:
        start = time.process_time()
        wt.Team(model="offline", out=out).plan(blocks(1)[::-1].copy(), "put the red block into the blue bowl")
        before = time.process_time()
        made = wt.Team(model="offline", out=out).plan(blocks(count), "put every red block into the blue bowl")
        seconds = time.process_time() - before
    picked = {str(getattr(step.step, "pick", "")) for step in made.plan.actions}
    return f"{seconds:.1f} s, after {before - start:.1f} s to load ({made.plan.status}, {len(picked)} picked)"


_FIRST = """
import sys, time, numpy, wonderful_team as wt
wt.Team(model="offline", out=sys.argv[1]).plan(numpy.load(sys.argv[2]), "put the red block into the blue bowl")
print(time.process_time())
"""


def first_plan_s(quick: bool) -> str:
    """CPU of a new process that plans once by `offline`, imports included; our modules are compiled once before."""
    import numpy as np

    from benchmarks.growth import blocks

    with tempfile.TemporaryDirectory() as out:
        photo = Path(out) / "photo.npy"
        np.save(photo, blocks(1))
        written = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        command = [sys.executable, "-c", _FIRST, out, str(photo)]
        used = [
            float(
                subprocess.run(
                    command,
                    env={**written, "PYTHONPYCACHEPREFIX": str(Path(out) / "compiled")},
                    check=True,
                    capture_output=True,
                    text=True,
                ).stdout
            )
            for _ in range(4 if quick else 10)
        ]
    return f"{statistics.median(used[1:]):.2f} s"


def record_ms(quick: bool) -> str:
    """What one more request costs the record, from the first hundred to the thousandth."""
    from benchmarks.request_cost import PLAN, photo
    from tests.models.providers.asking import TARGETS
    from wonderful_team.agents import build_request
    from wonderful_team.contracts import ReadScene
    from wonderful_team.core.protocols import Event
    from wonderful_team.core.values import Answer
    from wonderful_team.images import whole
    from wonderful_team.record.recorder import Recorder

    picture, marks = whole(photo((640, 480), 0), "top view"), []
    total = 300 if quick else 1000
    with tempfile.TemporaryDirectory() as name, Recorder(Path(name) / "run") as recorder:
        for number in range(total):
            request = build_request(ReadScene(TARGETS, PLAN, picture), id=f"0/ground/{number:04d}", stage="ground")
            before = time.process_time()
            recorder.on_event(Event("request", request.id, request))
            recorder.on_event(Event("answer", request.id, (request, Answer({"reasoning": "as it is"}))))
            recorder.on_event(Event("stage", "look", "a line of the story"))
            marks.append(time.process_time() - before)
    first, last = (1000 * statistics.median(part) for part in (marks[20:60], marks[-40:]))
    return f"{first:.2f} -> {last:.2f} ms at request {total}"


def growth(way: str, quick: bool) -> str:
    """What a long or large run comes to: CPU, memory at most, its page and how long that takes to open."""
    from benchmarks.growth import WAYS

    return WAYS[way](quick)


def token_shares(quick: bool) -> str:
    """Input tokens of whole plans against the reference implementation's, as it was counted when it was run last."""
    from benchmarks.reference_tokens import compare, shares

    return " / ".join(f"{share:.3f}" for share in shares(*compare()))


def ray_ratio(quick: bool) -> str:
    """Two Ray workers against two processes; wall time, so that an idle machine matters."""
    from benchmarks.ray_speed import compare

    return compare(2 if quick else 6, 24 if quick else 60)


def cores_ratio(quick: bool) -> str:
    """Two processes against one; wall time too."""
    from benchmarks.ray_speed import compare_cores

    return compare_cores(2 if quick else 6, 24 if quick else 60)


ROWS = (
    Row("request 640x480: draw + encode / in all", "5 / 12 ms", lambda quick: request_ms((640, 480), quick)),
    Row("request 1920x1080: draw + encode / in all", "- / 25 ms", lambda quick: request_ms((1920, 1080), quick)),
    Row("plan, CPU a request, record and page included, team", "35 ms", lambda quick: plan_ms("team", quick)),
    Row(
        "plan, CPU a request, record and page included, team:paper", "35 ms", lambda quick: plan_ms("team:paper", quick)
    ),
    Row("oracle episode, CPU", "50 ms", oracle_ms),
    Row("arm, oracle's episode, nothing drawn, CPU", "5 s", arm_s),
    Row("simulated:perfect trial, CPU", "0.18 s", lambda quick: trial_s("simulated:perfect", quick), as_worker=True),
    Row("simulated:perfect trial, records of failures, CPU", "-", kept_trial_s, as_worker=True),
    Row("simulated:perfect trial, nine settings on a scene, CPU", "0.18 s", settings_trial_s, as_worker=True),
    Row("opening a store, by the study / by each worker", "-", opening_s),
    Row("offline, 20 red blocks into the bowl, CPU", "4 s", lambda quick: blocks_s(20, quick)),
    Row("offline, 50 red blocks into the bowl, CPU", "12 s", lambda quick: blocks_s(50, quick)),
    Row("offline, a process that plans once, CPU", "1.0 s", first_plan_s),
    Row("text + picture tokens / the reference's, paper / lean", "0.25 / 0.08", token_shares),
    Row("one more request in a record", "constant", record_ms),
    Row("20 replans and more, offline", "600 MB, 1 s", lambda quick: growth("replans", quick)),
    Row("100 looks and 20 replans, offline", "600 MB, 1 s", lambda quick: growth("looks", quick)),
    Row("12 megapixels and 50 things, offline", "600 MB, 1 s", lambda quick: growth("photo", quick)),
    Row("Ray, two workers, start not counted / --jobs 2", "0.95", ray_ratio),
    Row("two workers / one, start not counted", "1.9", cores_ratio),
)


def _measured(number: int, quick: bool) -> str:
    warnings.simplefilter("ignore")
    return ROWS[number].measure(quick)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="fewer scenes and repetitions")
    parser.add_argument("--only", default="", help="rows whose name holds this")
    options = parser.parse_args()
    chosen = [number for number, row in enumerate(ROWS) if options.only in row.name]
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores; CPU time of our own work\n")
    print(f"{'figure':<60}{'aim':>12}   now")
    spawn = multiprocessing.get_context("spawn")
    for number in chosen:
        threads = one_thread_each() if ROWS[number].as_worker else contextlib.nullcontext()
        with threads, ProcessPoolExecutor(1, spawn) as alone:  # not a Pool: its processes may start none of their own
            now = alone.submit(_measured, number, options.quick).result()
        print(f"{ROWS[number].name:<60}{ROWS[number].aim:>12}   {now}", flush=True)


if __name__ == "__main__":
    main()
