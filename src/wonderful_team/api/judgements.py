"""What a method says became of its actions, against a simulator's truth at that moment: in studies, and never told to the method."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Mapping

import shapely

from wonderful_team.core.actions import Gripper, MoveTo, PickPlace
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import CHECK, Event, SceneTruth, World, offers, privileged
from wonderful_team.core.values import SubgoalRun, TrueThing
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.evals.trials import JUDGED, JUDGED_SUBGOAL
from wonderful_team.runtime.user_code import score_of

SLACK_M = 0.005
"""A point so far beside a thing is on it [m]."""


class Judgements:
    """Counts judgements as they are made; a subscriber. Stays empty where the world has no truth that may be asked at any time.

    Whole attempts are held against the scorer. A single subgoal is held against where the thing lies that it carried: truth is not
    known of subgoals that carry nothing from one place to another, and of those that the robot took nothing for.
    """

    def __init__(self, world: World) -> None:
        truth = privileged(world)
        self._truth = truth if offers(truth, SceneTruth) else None
        self._counts: Counter[str] = Counter()
        self._before: Mapping[str, TrueThing] = {}
        self._now: Mapping[str, TrueThing] = {}
        self._run: SubgoalRun | None = None

    def on_event(self, event: Event) -> None:
        """A judgement says that all is done, or that something is not; nothing has moved since."""
        if self._truth is None:
            return
        # A scorer that breaks ends the trial when its own turn comes.
        with contextlib.suppress(WonderfulTeamError):
            match event.kind:
                case "observe":
                    self._before, self._now = self._now, dict(self._truth.things())
                case "subgoal":
                    self._run = event.content
                case "verdicts" if event.name == CHECK:
                    for verdict in event.content:
                        self._counts[JUDGED_SUBGOAL[verdict.status == "done", self._reached(verdict.subgoal)]] += 1
                case "verdicts":
                    said = all(verdict.status == "done" for verdict in event.content)
                    self._counts[JUDGED[said, score_of(self._truth).success is True]] += 1

    def _reached(self, subgoal: str) -> bool | None:
        """Whether what the subgoal carried lies where it was to be put; None where that is not known."""
        ends = None if self._run is None or self._run.subgoal != subgoal else _carried(self._run)
        if ends is None:
            return None
        name = _object_at(self._before, ends[0])
        if name is None or name not in self._now:
            return None
        thing, place = self._now[name], shapely.Point(ends[1][:2])
        at = shapely.Point(thing.position_m[:2])
        # By itself, or with what it was put into or onto.
        holders = [other for other in self._now.values() if other.name != name and other.kind != "object"]
        areas = [shapely.Polygon(one.outline_m) for one in (thing, *holders)]
        return any(area.covers(place) and area.covers(at) for area in areas)

    @property
    def facts(self) -> dict[str, float]:
        """All counts of a kind; none where nothing of that kind was judged."""
        kinds = (tuple(JUDGED.values()), tuple(JUDGED_SUBGOAL.values()))
        return {
            name: float(self._counts[name]) for names in kinds if any(map(self._counts.get, names)) for name in names
        }


def _carried(run: SubgoalRun) -> tuple[Array, Array] | None:
    """Where a subgoal took a thing and where it put it, as planned, (x, y, z) [m]; None where it did not do just that."""
    taken: Array | None = None
    put: Array | None = None
    at: Array | None = None
    for action in (report.action for report in run.reports):
        match action:
            case PickPlace():
                taken, put = action.pick_m, action.place_m
            case MoveTo():
                at = action.pose.position_m
            case Gripper(state="open") if taken is not None:
                put = at
            case Gripper() if action.state != "open":
                taken = at
    return None if taken is None or put is None else (taken, put)


def _object_at(things: Mapping[str, TrueThing], point_m: Array) -> str | None:
    """The highest thing that can be carried at a place."""
    point = shapely.Point(point_m[:2])
    under = [
        thing
        for thing in things.values()
        if thing.kind == "object" and shapely.Polygon(thing.outline_m).buffer(SLACK_M).covers(point)
    ]
    return max(under, key=lambda thing: thing.height_m).name if under else None
