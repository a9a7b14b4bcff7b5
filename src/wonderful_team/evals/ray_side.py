"""The process that talks to Ray for a study. It holds no store, and nothing but time is lost when it ends.

Ray ends the process that is connected to it, at once and without an exception, when the cluster's head is gone for a minute;
it also sets handlers for signals and prints. So that process is one of its own.
"""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import os
import secrets
import socket
import threading
import time
import uuid
from collections import deque
from dataclasses import dataclass, field
from typing import Any

from wonderful_team.evals.processes import THREADS, leave_to_parent
from wonderful_team.evals.ray_actors import Hello, Places, TrialWorker
from wonderful_team.evals.ray_messages import (
    Cause,
    Connected,
    Ended,
    Failed,
    Lost,
    Order,
    Ready,
    Result,
    Run,
    Stop,
    Unfit,
)
from wonderful_team.evals.trials import TrialRow
from wonderful_team.redaction import redact

LOCAL = "local"
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")
"""A terminal, or `timeout`, tells the whole group; this process ends when the other one says so, or is gone."""
STARTS_THAT_FAIL = 3
"""So many workers in a row died before they ended a trial: then no more are started."""
LOSSES_IN_A_ROW = 10
"""So many workers in a row, beyond one for each that is left, died before any trial ended: then no more are started."""
PROBE_S = 3.0
"""How often the head is looked after, and how long it has to answer [s]."""
PROBES_THAT_FAIL = 5
"""So often in a row the head does not answer: then it is gone. Ray itself gives up after a minute."""
DEATH_KNOWN_S = 20.0
"""How long the cluster has to notice that a node is gone [s]."""
LOCAL_OBJECTS_BYTES = 200_000_000
"""Memory for what passes between the processes of a cluster that is started here."""


def talk_to_ray(order: Order, link: Any) -> None:
    """Entry of the process."""
    leave_to_parent(*SIGNALS)
    said = os.open(order.said, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    for stream in (1, 2):
        os.dup2(said, stream)
    _set_up(order.address)
    ray = importlib.import_module("ray")
    try:
        _connect(ray, order)
    except Exception as error:  # noqa: BLE001  ray raises bare exceptions when versions differ or a node does not start
        link.send(Failed(f"--ray {order.address}: {_line(error)}", wrong_use=True))
        return
    leave_to_parent(*SIGNALS)  # Ray has set handlers of its own
    asyncio.run(_Side(ray, order, link).run())
    ray.shutdown()


def _set_up(address: str) -> None:
    """Ray reads its settings when it is imported."""
    # Ray's own uv hook and usage statistics are none of a study's business.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    os.environ.setdefault("RAY_ENABLE_UV_RUN_RUNTIME_ENV", "0")
    if address != LOCAL:
        return
    # Ray lets its workers step back behind everything else on the machine; our own processes do not.
    os.environ.setdefault("RAY_worker_niceness", "0")
    if not any(name in os.environ for name in ("RAY_AUTH_MODE", "RAY_AUTH_TOKEN", "RAY_AUTH_TOKEN_PATH")):
        # Ray would write a token into the home folder, which changes how clusters are started from then on.
        os.environ |= {"RAY_AUTH_MODE": "token", "RAY_AUTH_TOKEN": secrets.token_hex(32)}


def _connect(ray: Any, order: Order) -> None:
    where: dict[str, Any] = {"address": order.address}
    if order.address == LOCAL:
        workers = min(order.workers or os.cpu_count() or 1, order.most)
        where |= {"num_cpus": workers, "include_dashboard": False, "object_store_memory": LOCAL_OBJECTS_BYTES}
    shipped = {"working_dir": str(order.folder), "env_vars": dict(THREADS)}
    ray.init(log_to_driver=False, runtime_env=shipped, **where)


@dataclass(eq=False)
class _Worker:
    actor: Any
    name: str
    node: str = ""
    running: dict[int, Run] = field(default_factory=dict)


class _Side:
    """Keeps workers busy with what is asked for, replaces those that die, and tells what becomes of it."""

    def __init__(self, ray: Any, order: Order, link: Any) -> None:
        self._ray, self._order, self._link = ray, order, link
        self._workers: list[_Worker] = []
        self._waiting: deque[Run] = deque()
        self._starting = self._failed_starts = self._losses = 0
        self._doubted: set[str] = set()
        self._tasks: set[asyncio.Task[None]] = set()
        self._ended = asyncio.Event()
        self._saying = threading.Lock()
        self._places: Any = None
        self._deaths = (
            ray.exceptions.RayActorError,
            ray.exceptions.WorkerCrashedError,
            ray.exceptions.OutOfMemoryError,
            ray.exceptions.ObjectLostError,
            ray.exceptions.NodeDiedError,
        )

    async def run(self) -> None:
        """Until it is told to stop, or whoever tells it is gone."""
        threading.Thread(target=self._listen, args=(asyncio.get_running_loop(),), daemon=True).start()
        cpus = int(self._ray.cluster_resources().get("CPU", 0))
        workers = max(1, min(self._order.workers or cpus, self._order.most))
        self._say(Connected(sum(bool(node["Alive"]) for node in self._ray.nodes()), cpus, workers))
        if self._order.calls_at_once is not None:
            self._places = self._pinned(Places).remote(self._order.calls_at_once)
        threading.Thread(target=self._watch_head, daemon=True).start()
        for _ in range(workers):
            self._start()
        await self._ended.wait()
        most = 0
        if self._places is not None:
            with contextlib.suppress(Exception):
                most = int(await asyncio.wait_for(self._places.most.remote(), PROBE_S))
        self._say(Ended(most))

    def _pinned(self, kind: type[Any]) -> Any:
        """An actor on this very node: it lives as long as the study, whichever other node dies."""
        strategies = importlib.import_module("ray.util.scheduling_strategies")
        here = strategies.NodeAffinitySchedulingStrategy(self._ray.get_runtime_context().get_node_id(), soft=False)
        return self._ray.remote(num_cpus=0, max_concurrency=1_000_000, scheduling_strategy=here)(kind)

    def _listen(self, loop: asyncio.AbstractEventLoop) -> None:
        while True:
            try:
                message = self._link.recv()
            except (EOFError, OSError):
                message = Stop()
            with contextlib.suppress(RuntimeError):  # the loop has ended
                loop.call_soon_threadsafe(self._hear, message)
            if isinstance(message, Stop):
                return

    def _hear(self, message: Run | Stop) -> None:
        if isinstance(message, Stop):
            self._ended.set()
            return
        self._waiting.append(message)
        self._hand_out()

    def _say(self, message: object) -> None:
        with self._saying, contextlib.suppress(OSError):  # nobody hears it any more
            self._link.send(message)

    def _spawn(self, work: Any) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    @property
    def _slots(self) -> int:
        return self._order.at_once * len(self._workers)

    # -- workers -------------------------------------------------------------------------------------------------------

    def _start(self) -> None:
        self._starting += 1
        name = uuid.uuid4().hex[:8]
        # Room to answer beside its trials.
        made = self._ray.remote(num_cpus=1, max_concurrency=self._order.at_once + 1, scheduling_strategy="SPREAD")
        actor = made(TrialWorker).remote(self._order.runner, self._order.parcel, self._places, name)
        self._spawn(self._welcome(_Worker(actor, name)))

    async def _welcome(self, worker: _Worker) -> None:
        try:
            hello: Hello = await worker.actor.hello.remote()
        except Exception as error:  # noqa: BLE001  whatever keeps a worker from starting is told
            self._starting -= 1
            self._failed_starts += 1
            if self._is_death(error) and self._failed_starts < STARTS_THAT_FAIL:
                self._start()
            else:
                self._unfit(_last_line(error))
            return
        self._starting -= 1
        if hello.fault:
            self._ray.kill(worker.actor)
            self._unfit(f"{hello.host} ({hello.node}): {hello.fault}")
            return
        worker.node = f"{hello.host} ({hello.node})"
        self._workers.append(worker)
        self._say(Ready(hello, self._slots))
        self._hand_out()

    def _is_death(self, error: Exception) -> bool:
        """Whether a worker died of itself, rather than of what it was told to do at its start."""
        return isinstance(error, self._deaths) and "creation task" not in str(error) and "to import" not in str(error)

    def _unfit(self, why: str) -> None:
        self._say(Unfit(why))
        if not self._workers and not self._starting:
            self._say(Failed(f"no worker of the cluster can run this study: {why}", wrong_use=True))

    def _hand_out(self) -> None:
        while self._waiting and self._workers:
            worker = min(self._workers, key=lambda one: len(one.running))
            if len(worker.running) >= self._order.at_once:
                return
            job = self._waiting.popleft()
            worker.running[job.number] = job
            self._spawn(self._run(worker, job))

    async def _run(self, worker: _Worker, job: Run) -> None:
        try:
            row, folder = await worker.actor.run.remote(job.spec, job.settings)
        except self._deaths as error:
            self._lose(worker, error)
            return
        except Exception as error:  # noqa: BLE001  what cannot be sent or read back is an error of this trial, ours
            row, folder = TrialRow("error", "crash", redact(_line(error)), usd=None), b""
        self._failed_starts = self._losses = 0
        if worker.running.pop(job.number, None) is not None:
            self._say(Result(job.number, row, folder))
            self._hand_out()

    def _lose(self, worker: _Worker, error: Exception) -> None:
        if worker not in self._workers:
            return
        self._workers.remove(worker)
        with contextlib.suppress(Exception):
            self._ray.kill(worker.actor)  # what is cut off from us must not go on asking models
        if self._places is not None:
            self._places.lost.remote(worker.name)
        self._say(Lost(tuple(worker.running), worker.node, self._slots))
        if worker.node not in self._doubted:
            self._doubted.add(worker.node)
            self._spawn(self._find_cause(worker.node, error))
        self._losses += 1
        if self._losses < LOSSES_IN_A_ROW + len(self._workers):
            self._start()
        else:
            self._unfit(f"workers die one after another, at last: {_line(error)}")

    async def _find_cause(self, node: str, error: Exception) -> None:
        """Tell once whether a node died, or a worker of it alone; an actor that is out of reach may be either."""
        patient = isinstance(error, self._ray.exceptions.ActorUnavailableError)
        until = time.monotonic() + (DEATH_KNOWN_S if patient else PROBE_S)
        died = False
        while not died and time.monotonic() < until:
            await asyncio.sleep(0.5)
            nodes = await asyncio.to_thread(self._ray.nodes)
            died = not any(one["Alive"] and one["NodeID"][:8] in node for one in nodes)
        self._doubted.discard(node)
        self._say(Cause(node, died, _line(error)))

    # -- the head ------------------------------------------------------------------------------------------------------

    def _watch_head(self) -> None:
        """In a thread of its own: without a head, calls of Ray block whoever makes them."""
        host, _, port = self._ray.get_runtime_context().gcs_address.rpartition(":")
        failed = 0
        while failed < PROBES_THAT_FAIL:
            time.sleep(PROBE_S)
            failed = 0 if answers(host, int(port), PROBE_S) else failed + 1
        self._say(Failed(f"the head of the Ray cluster at {host}:{port} no longer answers"))
        os._exit(1)  # to take leave of a head that is gone takes Ray a minute


def answers(host: str, port: int, within_s: float) -> bool:
    """Whether somebody takes connections there."""
    try:
        with socket.create_connection((host.strip("[]"), port), within_s):
            return True
    except OSError:
        return False


def _line(error: BaseException) -> str:
    words = " ".join(str(error).split())
    return redact(f"{type(error).__name__}: {words[:400]}" if words else type(error).__name__)


def _last_line(error: BaseException) -> str:
    """What went wrong at a worker's start: Ray puts the worker's whole traceback into its message."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return redact(f"{type(error).__name__}: {lines[-1][:400]}" if lines else type(error).__name__)
