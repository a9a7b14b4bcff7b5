"""What every recorded call does: tell its subscribers, and write its page."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from wonderful_team.core import deadline
from wonderful_team.core.protocols import Event, Subscriber
from wonderful_team.errors import BudgetReached, FileNotWrittenError
from wonderful_team.pages import write_page
from wonderful_team.record.recorder import Recorder
from wonderful_team.record.rerun_recording import RerunRecording


def write_page_or_warn(recorder: Recorder) -> Path | None:
    """Write the page. A run may have cost money and moved a robot: a defect of the page must not lose its result."""
    folder = recorder.folder
    try:
        return deadline.to_end("drawing the page", write_page, folder, recorder.at_hand)
    except FileNotWrittenError as error:
        recorder.note_unwritten(error)
    except Exception as error:  # noqa: BLE001  told as a warning; `wonderful-team show` writes the page anew
        warnings.warn(f"the page of {folder} could not be written: {type(error).__name__}: {error}", stacklevel=3)
    return None


def write_rerun_or_note(recording: RerunRecording, recorder: Recorder, path: Path) -> None:
    """Write a recording for Rerun. A run may have cost money: one that cannot be written is noted, and loses nothing else."""
    try:
        deadline.to_end("writing the recording for Rerun", recording.write, path)
    except FileNotWrittenError as error:
        recorder.note_unwritten(error)
    except BudgetReached as error:
        recorder.note_unwritten(FileNotWrittenError(path, str(error)))


def tell(subscribers: Sequence[Subscriber], kind: str, name: str, content: Any) -> None:
    """Pass an event on."""
    for subscriber in subscribers:
        subscriber.on_event(Event(kind, name, content))
