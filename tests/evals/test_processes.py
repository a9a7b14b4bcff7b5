"""Ctrl-C reaches every process of a terminal: one that still loads must neither end of it nor say a word."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from typing import Any

import pytest

from wonderful_team.evals.processes import interrupts_held, leave_to_parent

pytestmark = pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="signals cannot be held back here")


def work(begun: Any) -> None:
    """As a worker begins."""
    leave_to_parent("SIGINT")
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())
    begun.send("at work")
    begun.recv()


def test_an_interrupt_while_a_worker_loads_or_works_is_its_parents_to_answer() -> None:
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=work, args=(there,))
    with interrupts_held():
        process.start()
    assert process.pid is not None
    os.kill(process.pid, signal.SIGINT)  # long before its modules are imported
    assert here.poll(30)
    assert here.recv() == "at work"
    os.kill(process.pid, signal.SIGINT)
    time.sleep(0.05)
    here.send("done")
    process.join(30)
    assert process.exitcode == 0
