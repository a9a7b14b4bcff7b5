"""Programs that are to be interrupted listen to interrupts, also where the tests were started in the background."""

from __future__ import annotations

import signal


def listen() -> None:
    """Before a program starts: shells let what they start in the background ignore interrupts, and children inherit that."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
