"""Starts a real model server on a model with random weights: llama.cpp's `llama-server` or vLLM, where a variable names it."""

from __future__ import annotations

import contextlib
import os
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import httpx2
from tools.tiny_model import NAME

START_S = 1200.0
"""Longest time for a server to load its model: vLLM needs minutes on a busy machine."""
STOP_S = 30.0


@dataclass(frozen=True)
class Wanted:
    """How a server is started.

    Attributes:
        context: Tokens of a request and its answer together.
        pictures: It takes pictures.
        key: The key that it asks for.
    """

    context: int = 16384
    pictures: bool = True
    key: str | None = None


def _llama_server(program: str, model: Path, wanted: Wanted, port: int) -> list[str]:
    words = [program, "-m", f"{model}/model.gguf", "--alias", NAME, "-c", str(wanted.context), "--seed", "1"]
    words += ["--mmproj", f"{model}/mmproj.gguf"] if wanted.pictures else []
    words += ["--api-key", wanted.key] if wanted.key else []
    return [*words, "--host", "127.0.0.1", "--port", str(port), "-t", "2", "--no-warmup"]


def _vllm(program: str, model: Path, wanted: Wanted, port: int) -> list[str]:
    words = [program, "serve", f"{model}/hf", "--served-model-name", NAME, "--max-model-len", str(wanted.context)]
    words += ["--dtype", "float32", "--enforce-eager", "--seed", "1", "--max-num-seqs", "4"]
    words += [] if wanted.pictures else ["--limit-mm-per-prompt", '{"image": 0, "video": 0}']
    words += ["--api-key", wanted.key] if wanted.key else []
    return [*words, "--host", "127.0.0.1", "--port", str(port)]


@dataclass(frozen=True)
class Kind:
    """A server that can be started here.

    Attributes:
        variable: Environment variable with its executable.
        command: The words that start it.
    """

    variable: str
    command: Callable[[str, Path, Wanted, int], Sequence[str]]

    @property
    def program(self) -> str | None:
        return os.environ.get(self.variable)


KINDS = {
    "llama-server": Kind("WONDERFUL_TEAM_LLAMA_SERVER", _llama_server),
    "vllm": Kind("WONDERFUL_TEAM_VLLM", _vllm),
}


class NotStartedError(Exception):
    """The server ended, or did not answer in time; with the last lines that it wrote."""


@dataclass(frozen=True)
class RealServer:
    """One that runs.

    Attributes:
        url: Its address, with /v1.
        log: The file that it writes to.
    """

    url: str
    log: Path

    @property
    def spec(self) -> str:
        """The model, as `--model` takes it."""
        return f"{self.url}#{NAME}"


@contextlib.contextmanager
def serving(kind: Kind, model: Path, folder: Path, wanted: Wanted) -> Iterator[RealServer]:
    """The server, ready to be asked; it is stopped at the end.

    Raises:
        NotStartedError: It ended, or was not ready in time.
    """
    program = shutil.which(kind.program or "")
    if program is None:
        raise NotStartedError(f"{kind.variable}={kind.program}: no such program")
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port = found.getsockname()[1]
    log = folder / "server.log"
    # Nothing may be downloaded, and the environment of another program tells it nothing.
    offline = {"HF_HUB_OFFLINE": "1", "VLLM_CPU_KVCACHE_SPACE": "1", "VLLM_NO_USAGE_STATS": "1", "DO_NOT_TRACK": "1"}
    with log.open("wb") as file:
        process = subprocess.Popen(
            list(kind.command(program, model, wanted, port)),
            stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT, start_new_session=True,
            env={**os.environ, **offline},
        )  # fmt: skip
    try:
        _wait(process, f"http://127.0.0.1:{port}/health", log)
        yield RealServer(f"http://127.0.0.1:{port}/v1", log)
    finally:
        process.terminate()
        try:
            process.wait(STOP_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _wait(process: subprocess.Popen[bytes], health: str, log: Path) -> None:
    """Until the server says that it can be asked."""
    until = time.monotonic() + START_S
    while time.monotonic() < until and process.poll() is None:
        with contextlib.suppress(httpx2.HTTPError):
            if httpx2.get(health, timeout=5.0, trust_env=False).status_code == 200:
                return
        time.sleep(0.3)
    why = "ended" if process.poll() is not None else f"was not ready within {START_S:.0f} s"
    raise NotStartedError(f"{process.args!r} {why}:\n{log.read_text(errors='replace')[-3000:]}")
