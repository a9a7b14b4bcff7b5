"""Nodes of a Ray cluster as processes of this machine, each with its own Python without this package; all are ended."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import venv
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
START_S = 120.0
NODE_KEY = "node-canary-7f3a91c2"
"""What the nodes hold in OPENAI_API_KEY."""

TOKEN = {"RAY_AUTH_MODE": "token", "RAY_AUTH_TOKEN": "c0ffee" * 8}
"""Nobody else on this machine may run code on the cluster; whoever connects has these in its environment."""


def bare_python(folder: Path) -> Path:
    """A Python that has the packages of this one, and not the package that is tested."""
    venv.create(folder, with_pip=False)
    site = next((folder / "lib").glob("python3*")) / "site-packages"
    packages = next(path for path in map(Path, sys.path) if (path / "ray" / "__init__.py").is_file())
    (site / "packages.pth").write_text(f"{packages}\n", encoding="utf-8")
    return folder / "bin" / "python"


def runners_alone(folder: Path) -> Path:
    """A copy of the stand-in runners, to be imported without the checkout."""
    there = folder / "tests" / "evals"
    there.mkdir(parents=True)
    for name in ("__init__.py", "evals/__init__.py", "evals/runners.py", "evals/ray_runners.py"):
        shutil.copy(ROOT / "tests" / name, folder / "tests" / name)
    return folder


def _children() -> dict[int, list[int]]:
    found: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError, ValueError):
            parent = int(stat.read_text().rpartition(")")[2].split()[1])
            found.setdefault(parent, []).append(int(stat.parent.name))
    return found


class Node:
    """One node."""

    def __init__(self, python: Path, imports: Path, where: list[str]) -> None:
        self.folder = Path(
            tempfile.mkdtemp(prefix="r", dir="/tmp")
        )  # Ray's sockets have a bound on the length of their path
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        environment |= {"PYTHONPATH": str(imports), "OPENAI_API_KEY": NODE_KEY, "PYTHONUNBUFFERED": "1"}
        words = [str(python), "-m", "ray.scripts.scripts", "start", "--block", "--num-cpus", "1", *where]
        words += ["--temp-dir", str(self.folder), "--object-store-memory", "100000000", "--disable-usage-stats"]
        environment |= {"RAY_worker_niceness": "0", **TOKEN}
        self._said = open(self.folder / "said.txt", "wb")  # noqa: SIM115  closed when the node ends
        self._process = subprocess.Popen(
            words, env=environment, cwd="/", stdout=self._said, stderr=subprocess.STDOUT, start_new_session=True
        )

    def wait(self) -> Node:
        """Until it runs."""
        until = time.monotonic() + START_S
        while "Ray runtime started" not in self.said:
            assert self._process.poll() is None, self.said
            assert time.monotonic() < until, self.said
            time.sleep(0.2)
        return self

    @property
    def said(self) -> str:
        return (self.folder / "said.txt").read_text(encoding="utf-8", errors="replace")

    def pids(self) -> list[int]:
        """Its processes, workers included."""
        children, found = _children(), [self._process.pid]
        for pid in found:
            found += children.get(pid, [])
        return found

    def kill(self) -> None:
        """As a loss of power ends it: all of its processes at once."""
        for pid in self.pids():
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        self._process.wait(10)

    def end(self) -> None:
        """Kill what is left of it, and remove its folder."""
        self.kill()
        self._said.close()
        shutil.rmtree(self.folder, ignore_errors=True)


class Cluster:
    """A head, and whatever nodes are added."""

    def __init__(self, folder: Path) -> None:
        self._python, self._imports = bare_python(folder / "python"), runners_alone(folder / "imports")
        self.nodes: list[Node] = []
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"127.0.0.1:{self.port}"

    def head(self) -> Node:
        """The first node."""
        return self._start(["--head", f"--port={self.port}", "--include-dashboard=false"])

    def add(self) -> Node:
        """One more node."""
        return self._start([f"--address={self.address}"])

    def _start(self, where: list[str]) -> Node:
        node = Node(self._python, self._imports, where)
        self.nodes.append(node)
        return node.wait()

    def python(self, *words: str) -> str:
        """What a Python without this package prints."""
        done = subprocess.run(
            [self._python, *words],
            cwd="/",
            env={"PATH": os.environ["PATH"], **TOKEN},
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout


@contextlib.contextmanager
def cluster(folder: Path, nodes: int) -> Iterator[Cluster]:
    """A cluster of so many nodes, one core each."""
    made = Cluster(folder)
    try:
        made.head()
        for _ in range(nodes - 1):
            made.add()
        yield made
    finally:
        for node in made.nodes:
            node.end()
