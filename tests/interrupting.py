"""Programs that are to be interrupted listen to interrupts, also where the tests were started in the background or by nohup."""

from __future__ import annotations

import signal

from wonderful_team.core.interrupts import SIGNALS


def listen() -> None:
    """Before a program starts: shells let what they start in the background ignore interrupts, and children inherit that."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL)
