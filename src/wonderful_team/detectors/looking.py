"""One look of a detector at a view as a method takes it: bounded by the run's time, and told to subscribers."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any, Protocol

from wonderful_team.core.protocols import Detector
from wonderful_team.core.values import Detection, DetectorRun, View
from wonderful_team.detectors.asking import WITHIN_S, detect, identity_of, name_of
from wonderful_team.errors import DetectorCodeError, NotUnderstoodError, WonderfulTeamError


class _Budget(Protocol):
    @property
    def seconds_left(self) -> float | None: ...

    def time_is_up(self, during: str) -> WonderfulTeamError: ...


async def look(
    detector: Detector, view: View, words: Sequence[str], budget: _Budget, tell: Callable[[str, str, Any], None]
) -> tuple[Detection, ...]:
    """What a detector finds in a view.

    Args:
        detector: Who looks.
        view: What it is given.
        words: What to look for.
        budget: Of the run.
        tell: Tells subscribers of an event: kind, name, content.

    Raises:
        NotUnderstoodError: It refuses some of the words.
        DetectorCodeError: It broke, or returned what are no detections.
        BudgetReached: The cap on seconds was met.
    """
    asked, started = tuple(dict.fromkeys(words)), time.monotonic()
    error: DetectorCodeError | NotUnderstoodError | None = None
    left, found = budget.seconds_left, tuple[Detection, ...]()
    try:
        found = await detect(
            detector, view.rgb, asked, within_s=WITHIN_S if left is None else min(WITHIN_S, max(left, 0.001))
        )
    except DetectorCodeError as broke:
        if left is not None and not budget.seconds_left:
            raise budget.time_is_up(f"looking with detector {name_of(detector)!r}") from broke
        error = broke
    except NotUnderstoodError as refused:
        error = refused
    said = {} if error is None else {"failed" if isinstance(error, DetectorCodeError) else "refused": str(error)}
    run = DetectorRun(identity_of(detector), view, asked, found, time.monotonic() - started, **said)
    tell("detector", run.detector["name"], run)
    if error is not None:
        raise error
    return found
