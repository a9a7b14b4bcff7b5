"""What every recorded call does: tell its subscribers, and write its page."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from wonderful_team.core import deadline
from wonderful_team.core.protocols import Event, Subscriber
from wonderful_team.errors import FileNotWrittenError
from wonderful_team.pages import write_page
from wonderful_team.record.recorder import Recorder


def write_page_or_warn(recorder: Recorder) -> Path | None:
    """Write the page. A run may have cost money and moved a robot: a defect of the page must not lose its result."""
    folder = recorder.folder
    try:
        return deadline.to_end("drawing the page", write_page, folder, recorder.coded_pictures)
    except FileNotWrittenError as error:
        recorder.note_unwritten(error)
    except Exception as error:  # noqa: BLE001  told as a warning; `wonderful-team show` writes the page anew
        warnings.warn(f"the page of {folder} could not be written: {type(error).__name__}: {error}", stacklevel=3)
    return None


def tell(subscribers: Sequence[Subscriber], kind: str, name: str, content: Any) -> None:
    """Pass an event on."""
    for subscriber in subscribers:
        subscriber.on_event(Event(kind, name, content))
