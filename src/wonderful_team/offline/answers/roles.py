"""Which target of a subgoal is moved and which is the place, read from the subgoal's words and the targets' words."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from wonderful_team.core.values import Subgoal, Target
from wonderful_team.offline.answers.reviewing import named
from wonderful_team.offline.eyes import Eyes
from wonderful_team.offline.goals.aims import Aim, Named
from wonderful_team.offline.goals.deriving import derive
from wonderful_team.offline.language import try_understand

TO_MOVE = frozenset(("pick", "grasp", "push_start"))
TO_RECEIVE = frozenset(("place", "push_end"))


@dataclass(frozen=True, eq=False)
class Task:
    """One thing to do for a subgoal, with the targets that play its parts.

    Attributes:
        aim: What the words come to; None where they cannot be read.
        thing, place: Targets; place is None for turning, going back, and where no target fits.
        stops: Areas where a pushed thing rests on its way to the place, in order.
    """

    subgoal: str
    aim: Aim | None
    thing: Target | None
    place: Target | None
    rotate_deg: float = 0.0
    stops: tuple[Target, ...] = ()

    @property
    def how(self) -> str:
        """How the thing stands to the place afterwards, as Aim.how; "" where the words cannot be read."""
        return self.aim.how if self.aim is not None else ""

    @property
    def to_number(self) -> int | None:
        """Number of the thing that the place is, as far as the words lead to one."""
        return self.aim.to.number if self.aim is not None and self.aim.to is not None else None


def tasks_of(subgoal: Subgoal, targets: Sequence[Target], eyes: Eyes) -> list[Task]:
    """What a subgoal asks for, in order."""
    by_id = {target.id: target for target in targets}
    own = [by_id[name] for name in subgoal.targets if name in by_id] or list(targets)
    understood = try_understand(subgoal.text)
    aims = derive(understood, eyes, strict=False, literal=True).aims if understood is not None else []
    if not aims:
        return [_by_use(subgoal, own)]
    known = [(target, named(target, eyes)) for target in own]
    return [_task(subgoal, aim, known) for aim in aims]


def _task(subgoal: Subgoal, aim: Aim, known: Sequence[tuple[Target, Named | None]]) -> Task:
    thing = _player(aim.thing, known, TO_RECEIVE if aim.kind == "trace" else TO_MOVE, None)
    ways = dict.fromkeys(target for target, who in known if who is not None and who.description.way is not None)
    if aim.kind == "push" and ways:
        *stops, end = ways
        return Task(subgoal.id, aim, thing, end, stops=tuple(stops))
    place = None
    if aim.kind not in ("rotate", "trace") and (aim.how != "origin" or aim.to is not None):
        if aim.how in ("side", "between") or aim.to is None:
            place = _spot(known, thing)
        else:
            place = _player(aim.to, known, TO_RECEIVE, thing)
    return Task(subgoal.id, aim, thing, place, aim.rotate_deg)


def _player(
    wanted: Named, known: Sequence[tuple[Target, Named | None]], use: frozenset[str], taken: Target | None
) -> Target | None:
    """The target that means this thing; else the one whose use fits."""
    free = [(target, who) for target, who in known if taken is None or target.id != taken.id]
    same = [target for target, who in free if who is not None and who.same(wanted)]
    by_use = [target for target, _ in free if set(target.roles) & use]
    return next(iter([target for target in same if target in by_use] or same or by_use), None)


def _spot(known: Sequence[tuple[Target, Named | None]], thing: Target | None) -> Target | None:
    rest = [target for target, _ in known if thing is None or target.id != thing.id]
    areas = [target for target in rest if target.kind == "area"]
    return next(iter(areas or [target for target in rest if set(target.roles) & TO_RECEIVE]), None)


def _by_use(subgoal: Subgoal, own: Sequence[Target]) -> Task:
    """Words that cannot be read: the targets' uses decide, then their order."""
    angle = re.search(r"(-?\d+(?:\.\d+)?)\s*(?:°|deg)", subgoal.text)
    turn = float(angle.group(1)) if angle else 0.0
    if turn and re.search(r"counter|anti", subgoal.text, re.IGNORECASE):
        turn = -turn
    thing = next((target for target in own if set(target.roles) & TO_MOVE), own[0] if own else None)
    place = next((target for target in own if target is not thing and set(target.roles) & TO_RECEIVE), None)
    if place is None and not turn:
        place = next((target for target in own if target is not thing), None)
    return Task(subgoal.id, None, thing, place, turn)
