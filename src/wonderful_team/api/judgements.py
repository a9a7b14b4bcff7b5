"""What a method says became of its actions, against a simulator's truth at that moment: in studies, and never told to the method."""

from __future__ import annotations

import contextlib
from collections import Counter

from wonderful_team.core.protocols import Event, SceneTruth, World, offers, privileged
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.evals.trials import JUDGED
from wonderful_team.runtime.user_code import score_of


class Judgements:
    """Counts judgements as they are made; a subscriber. Stays empty where the world has no truth that may be asked at any time."""

    def __init__(self, world: World) -> None:
        truth = privileged(world)
        self._truth = truth if offers(truth, SceneTruth) else None
        self._counts: Counter[str] = Counter()

    def on_event(self, event: Event) -> None:
        """A judgement says that all is done, or that something is not; nothing has moved since."""
        if event.kind != "verdicts" or self._truth is None:
            return
        said = all(verdict.status == "done" for verdict in event.content)
        # A scorer that breaks ends the trial when its own turn comes.
        with contextlib.suppress(WonderfulTeamError):
            self._counts[JUDGED[said, score_of(self._truth).success is True]] += 1

    @property
    def facts(self) -> dict[str, float]:
        """All four counts; none where nothing was judged."""
        return {name: float(self._counts[name]) for name in JUDGED.values()} if self._counts else {}
