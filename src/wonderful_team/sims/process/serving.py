"""Answers questions over the pipe, one after another, until the other side goes away."""

from __future__ import annotations

import os
import queue
import shutil
import signal
import sys
import threading
import traceback
from collections.abc import Mapping
from typing import Any, BinaryIO, Protocol

from .frames import Message, read_message, write_message

SCRATCH = "wonderful-team-simulator-"
"""How the folder for temporary files of this process is called, which the other side made for it alone."""


class Answers(Protocol):
    """A simulator's `Bench`. What it raises with an attribute `kind` is told to the other side as that kind of refusal."""

    def ask(self, what: str, said: Mapping[str, Any], arrays: Mapping[str, Any]) -> Message:
        """Answer one question."""
        ...


def serve(bench: Answers) -> None:
    """Take over standard input and output, and answer.

    The simulator prints to file descriptor 1 from C code; after this it prints to standard error.
    """
    questions, answers = _take_over()
    # Ctrl-C is for the other side, which then closes the pipe.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    waiting: queue.Queue[Message] = queue.Queue()
    threading.Thread(target=_listen, args=(questions, waiting), daemon=True).start()
    while True:
        said, arrays = waiting.get()
        reply, pictures = _answer(bench, said, arrays)
        try:
            write_message(answers, reply, pictures)
        except OSError:
            os._exit(0)
        if said.get("ask") == "close":
            return


def _take_over() -> tuple[BinaryIO, BinaryIO]:
    questions = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    return questions, answers


def _listen(questions: BinaryIO, waiting: queue.Queue[Message]) -> None:
    """Pass questions on; when the other side has gone, end at once, whatever the simulator is doing."""
    try:
        while True:
            waiting.put(read_message(questions))
    except Exception:  # noqa: BLE001  whatever is wrong with the pipe, nobody listens any more
        # The other side wipes this folder too, unless it was killed.
        scratch = os.environ.get("TMPDIR", "")
        if os.path.basename(scratch).startswith(SCRATCH):
            shutil.rmtree(scratch, ignore_errors=True)
        os._exit(0)


def _answer(bench: Answers, said: Any, arrays: Any) -> Message:
    """The reply to one question; whatever goes wrong is told to the other side."""
    try:
        reply, pictures = bench.ask(str(said.get("ask")), said, arrays)
        return dict(reply, ok=True), pictures
    except Exception as error:  # noqa: BLE001  the other side must hear of it, or it would wait for ever
        kind = getattr(error, "kind", None)
        if isinstance(kind, str):
            return {"ok": False, "kind": kind, "error": str(error)}, {}
        traceback.print_exc()
        return {"ok": False, "kind": "crash", "error": f"{type(error).__name__}: {error}"}, {}
