"""How long a page takes to open in a headless Chromium, told by the browser itself; over its debugging pipe, so that no port is opened."""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import select
import shutil
import signal
import statistics
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
LONGEST_S = 60.0
_LOADED = "performance.timing.loadEventEnd - performance.timing.navigationStart"


def browser() -> str | None:
    """The program of a Chromium on this machine; None where there is none."""
    return next(filter(None, map(shutil.which, NAMES)), None)


def opening_s(page: Path, times: int = 3) -> float | None:
    """From asking for a page to the end of its load event, the median of so many times [s]; None without a Chromium.

    Raises:
        TimeoutError: The page, or the browser, took more than a minute.
    """
    program = browser()
    if program is None:
        return None
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile, _Pipe(program, Path(profile)) as pipe:
        target = pipe.call("Target.createTarget", url="about:blank")["targetId"]
        session = pipe.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        taken = []
        for _ in range(times):
            pipe.call("Page.navigate", session, url="about:blank")
            pipe.call("Page.navigate", session, url=page.resolve().as_uri())
            taken.append(_loaded_ms(pipe, session) / 1000)
        return statistics.median(taken)


def _loaded_ms(pipe: _Pipe, session: str) -> float:
    until = time.monotonic() + LONGEST_S
    while time.monotonic() < until:
        found = pipe.call("Runtime.evaluate", session, expression=f"[document.URL, {_LOADED}]", returnByValue=True)
        url, loaded_ms = found["result"]["value"]
        if url != "about:blank" and loaded_ms > 0:
            return float(loaded_ms)
        time.sleep(0.02)
    raise TimeoutError(f"a page did not open within {LONGEST_S:g} s")


class _Pipe:
    """A browser with its debugging pipe: it reads commands from its file 3 and writes answers to its file 4."""

    def __init__(self, program: str, profile: Path) -> None:
        commands, self._to = os.pipe()
        self._from, answers = os.pipe()
        words = (
            *(program, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--window-size=1280,900"),
            *("--disable-background-networking", "--remote-debugging-pipe", f"--user-data-dir={profile}"),
        )
        # Out of the way of 3 and 4 first: either may be one of them.
        held = [fcntl.fcntl(one, fcntl.F_DUPFD, 10) for one in (commands, answers)]
        self._process = subprocess.Popen(
            words,
            pass_fds=(3, 4),
            preexec_fn=lambda: [os.dup2(one, as_file) for one, as_file in zip(held, (3, 4), strict=True)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        for one in (commands, answers, *held):
            os.close(one)
        self._number, self._read = 0, b""

    def __enter__(self) -> _Pipe:
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        os.close(self._to)
        os.close(self._from)

    def call(self, method: str, session: str | None = None, **params: Any) -> Any:
        """What the browser answers to a command."""
        self._number += 1
        command = {"id": self._number, "method": method, "params": params}
        if session is not None:
            command["sessionId"] = session
        os.write(self._to, json.dumps(command).encode() + b"\0")
        until = time.monotonic() + LONGEST_S
        while True:
            while b"\0" in self._read:
                line, _, self._read = self._read.partition(b"\0")
                answer = json.loads(line)
                if answer.get("id") == self._number:
                    return answer["result"]
            if not select.select([self._from], [], [], max(0.0, until - time.monotonic()))[0]:
                raise TimeoutError(f"the browser did not answer {method} within {LONGEST_S:g} s")
            more = os.read(self._from, 1 << 16)
            if not more:
                raise TimeoutError("the browser ended")
            self._read += more
