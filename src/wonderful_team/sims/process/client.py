"""The simulator's process: started, asked, and never left behind."""

from __future__ import annotations

import contextlib
import os
import queue
import re
import shutil
import subprocess
import tempfile
import threading
import weakref
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, cast

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.errors import ConfigError, WorldUnavailableError
from wonderful_team.redaction import names_secret
from wonderful_team.sims.process.frames import read_message, write_message
from wonderful_team.sims.process.launch import CANNOT_RUN
from wonderful_team.sims.process.serving import SCRATCH

LAUNCHER = Path(__file__).with_name("launch.py")
ASK_TIMEOUT_S = 120.0
CLOSE_TIMEOUT_S = 3.0
TAIL_LINES = 12


@dataclass(frozen=True)
class Service:
    """What is started.

    Attributes:
        python: The interpreter that has the simulator.
        folder: A package of ours whose `bench.py` answers there.
        missing: The error for an interpreter that lacks what is needed, from the reason.
        noise: What the simulator prints all the time, left out where its last lines are told.
    """

    python: str
    folder: Path
    missing: Callable[[str], ConfigError]
    noise: re.Pattern[str] | None = None


class Simulator:
    """One process with one environment in it.

    Raises:
        ConfigError: The interpreter cannot be started.
    """

    def __init__(self, service: Service) -> None:
        self._service = service
        # The simulator leaves files behind in the folder for temporary ones; this one goes away with it.
        self._scratch = Path(tempfile.mkdtemp(prefix=SCRATCH))
        self._said = self._scratch / "said.log"
        try:
            self._process = self._start()
        except OSError as error:
            shutil.rmtree(self._scratch, ignore_errors=True)
            raise ConfigError(f"{service.python!r} cannot be started: {error.strerror}") from error
        assert self._process.stdin is not None, "asked for a pipe"
        assert self._process.stdout is not None, "asked for a pipe"
        self._in = cast(BinaryIO, self._process.stdin)
        self._answers: queue.Queue[Any] = queue.Queue()
        self._lock = threading.Lock()
        self._listener = threading.Thread(
            target=_listen, args=(cast(BinaryIO, self._process.stdout), self._answers), daemon=True
        )
        self._listener.start()
        self._end = weakref.finalize(self, _end, self._process, self._scratch)

    def _start(self) -> subprocess.Popen[bytes]:
        environment = {name: value for name, value in os.environ.items() if not names_secret(name)}
        environment.update(TMPDIR=str(self._scratch), TEMP=str(self._scratch), TMP=str(self._scratch))
        with self._said.open("wb") as said:
            return subprocess.Popen(
                [self._service.python, str(LAUNCHER), str(self._service.folder)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=said,
                env=environment,
            )

    @property
    def alive(self) -> bool:
        """Whether it can still be asked."""
        return self._end.alive and self._process.poll() is None

    def ask(
        self,
        what: str,
        arrays: Mapping[str, Array] | None = None,
        *,
        timeout_s: float = ASK_TIMEOUT_S,
        **said: Any,
    ) -> tuple[dict[str, Any], dict[str, Array]]:
        """Ask one question and wait for its answer.

        Raises:
            WorldUnavailableError: The process died, hangs, or its simulator failed; says what it printed last.
            ConfigError: The simulator is missing there, or what was asked for does not exist.
        """
        with self._lock:
            if not self._end.alive:
                raise WorldUnavailableError("the simulator's process has ended; make a new world")
            # A process that has just ended is noticed when its answer is awaited.
            with contextlib.suppress(OSError):
                write_message(self._in, {"ask": what, **said}, arrays or {})
            try:
                answer = self._answers.get(timeout=timeout_s)
            except queue.Empty:
                tail = self.tail()
                self._end()
                text = f"the simulator did not answer {what!r} within {timeout_s:g} s and was ended"
                raise _failed(text, tail) from None
            except BaseException:
                # Interrupted: the answer may still come, and nobody could tell it from that to a later question.
                self._end()
                raise
        if isinstance(answer, BaseException):
            tail = self.tail()
            self._end()
            if self._process.returncode == CANNOT_RUN:
                raise self._service.missing(tail)
            raise _failed(f"the simulator's process ended while it was asked {what!r}", tail) from answer
        reply, pictures = answer
        if not reply["ok"]:
            raise self._refused(what, str(reply["kind"]), str(reply["error"]))
        return reply, pictures

    def close(self) -> None:
        """End the process and wipe its folder; safe to call twice."""
        if self.alive:
            with contextlib.suppress(WorldUnavailableError, ConfigError):
                self.ask("close", timeout_s=CLOSE_TIMEOUT_S)
        self._end()

    def tail(self) -> str:
        """The last lines that the simulator printed."""
        try:
            text = self._said.read_text(encoding="utf-8", errors="replace")
        except OSError:
            return ""
        if self._service.noise is not None:
            text = self._service.noise.sub("", text)
        told = [line for line in text.splitlines() if line.strip()]
        return "\n".join(told[-TAIL_LINES:])

    def _refused(self, what: str, kind: str, text: str) -> Exception:
        if kind == "missing":
            return self._service.missing(text)
        if kind == "config":
            return ConfigError(text)
        if kind == "unavailable":
            return WorldUnavailableError(text)
        if kind == "crash":
            return _failed(f"the simulator failed at {what!r}: {text}", self.tail())
        return WorldUnavailableError(f"the simulator refused {what!r}: {text}")


def _failed(text: str, tail: str) -> WorldUnavailableError:
    return WorldUnavailableError(f"{text}; it printed last:\n{tail}" if tail else text)


def _listen(stream: BinaryIO, answers: queue.Queue[Any]) -> None:
    """Pass answers on until the process ends; the end is passed on too."""
    try:
        while True:
            answers.put(read_message(stream))
    except Exception as error:  # noqa: BLE001  whatever ends the talk is told to the one who waits
        answers.put(error)
    finally:
        with contextlib.suppress(OSError):
            stream.close()


def _end(process: subprocess.Popen[bytes], scratch: Path) -> None:
    """Also run when the owner is forgotten and when this program ends."""
    with contextlib.suppress(OSError):
        if process.stdin is not None:
            process.stdin.close()
    try:
        process.wait(timeout=0.5)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    shutil.rmtree(scratch, ignore_errors=True)
