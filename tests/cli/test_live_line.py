"""The line that moves on a terminal: who thinks, gone without a trace, and only where it belongs."""

from __future__ import annotations

import io
import os
import pty
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

from wonderful_team.cli.live_line import CLEAR, LiveLine
from wonderful_team.cli.progress import ProgressLine
from wonderful_team.core.protocols import Event

SLOW = """
import time


class Slow:
    name = "slow"

    def answer(self, request):
        time.sleep(60)
"""


def request(name: str, role: str, sample: int = 0) -> SimpleNamespace:
    return SimpleNamespace(id=name, role=role, sample=sample)


def test_it_names_every_role_that_thinks_and_the_longest_wait() -> None:
    clock = iter([0.0, 2.0, 5.0, 7.0]).__next__
    line = LiveLine(io.StringIO(), clock)
    line._start = lambda: None  # type: ignore[method-assign]  no thread: the test draws
    line.on_event(Event("request", "a", request("a", "manager")))
    line.on_event(Event("request", "b", request("b", "checker")))
    assert re.fullmatch(r". manager, checker thinking, 5\.0 s", line.text())
    line.on_event(Event("answer", "a", (request("a", "manager"), None)))
    assert re.fullmatch(r". checker thinking, 5\.0 s", line.text())
    line.on_event(Event("failed", "b", (request("b", "checker"), None)))
    assert line.text() == ""


def test_a_line_of_progress_never_lands_on_it() -> None:
    stream = io.StringIO()
    line = LiveLine(stream)
    line._start = lambda: None  # type: ignore[method-assign]
    line.on_event(Event("request", "a", request("a", "manager")))
    line._draw()
    line.pause()
    assert stream.getvalue().endswith(CLEAR)
    line.close()
    line._draw()
    assert stream.getvalue().endswith(CLEAR)


def test_nothing_moves_where_stderr_is_no_terminal_or_json_is_wanted() -> None:
    assert ProgressLine()._live is None
    assert ProgressLine(live=False)._live is None


def test_words_of_a_model_cannot_write_on_the_terminal() -> None:
    said: list[str] = []
    ProgressLine(said.append).on_event(Event("stage", "checked", "1 question: \x1b[2K\rPLAN ok\u202e\nadmitted"))
    assert len(said) == 1
    assert said[0].endswith("1 question: \\x1b[2K\\rPLAN ok\\u202e\\nadmitted")


def _on_terminal(words: list[str], folder: Path, *, interrupt: bool) -> tuple[str, int]:
    """Run a command with a terminal as its stderr; returns what the terminal got, and the exit code."""
    parent, child = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "WONDERFUL_TEAM_RUNS": str(folder / "runs")}
    command = [sys.executable, "-m", "wonderful_team", *words]
    # Started in the background, Python would ignore SIGINT.
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=child,
        env=environment,
        cwd=folder,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),  # noqa: PLW1509
    )
    os.close(child)
    told, sent, give_up = "", False, time.monotonic() + 90
    while time.monotonic() < give_up:
        try:
            part = os.read(parent, 4096)
        except OSError:  # the other end is closed
            break
        if not part:
            break
        told += part.decode("utf-8", "replace")
        if interrupt and not sent and told.count("thinking") > 2:
            process.send_signal(signal.SIGINT)
            sent = True
    process.stdout.close()  # type: ignore[union-attr]
    code = process.wait(timeout=30)
    os.close(parent)
    return told, code


def test_on_a_terminal_it_moves_and_ctrl_c_leaves_a_clean_line(tmp_path: Path) -> None:
    (tmp_path / "slow.py").write_text(SLOW, encoding="utf-8")
    words = ["run", "tabletop/rotate", "--seed", "3", "--model", "slow.py:Slow"]
    told, code = _on_terminal(words, tmp_path, interrupt=True)
    assert code == 130
    assert told.count("supervisor thinking") >= 2
    last = told.rpartition("thinking")[2]
    assert CLEAR in last
    assert "interrupted" in last
    assert "thinking" not in last


def test_with_json_nothing_moves(tmp_path: Path) -> None:
    told, code = _on_terminal(["run", "tabletop/rotate", "--seed", "3", "--json"], tmp_path, interrupt=False)
    assert code == 0
    assert "thinking" not in told
    assert "\x1b" not in told
