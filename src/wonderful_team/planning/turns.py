"""How far something is turned, where pictures alone say so: read from a strip of cut-outs turned by numbered angles.

Nothing is asked where the instruction states the angle, where the pixels of the pictures agree with the angle that a step
states, and in `paper`, whose questions are those that were published.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from wonderful_team.agents.scene import SceneShown
from wonderful_team.agents.step_words import turn_words
from wonderful_team.contracts import ReadTurn, TurnChoice
from wonderful_team.core.actions import At, PickPlaceStep, Step
from wonderful_team.core.values import GroundedTarget, GroundingEvent, Instruction, Slot, Target
from wonderful_team.images.turn_marks import seen_from_above
from wonderful_team.images.turned import Shown, reach_px, thing_alone, turn_misfits, turn_strip
from wonderful_team.planning.session import AgentSession

COARSE_DEG = tuple(range(0, 360, 30))
FINE_DEG = tuple(range(-20, 21, 5))
"""Turns of the second round, round the first choice [degrees]."""
CLOSE_DEG = 5.0
"""A stated angle within one step of the fine strip of the one that was read stands."""
AS_GOOD, SLACK = 1.2, 3.0
"""The pictures agree with an angle whose misfit is at most this many times the least one, and so many grey levels more."""
MOST = 45.0
"""Pictures whose best turn still differs by more grey levels than this agree with none."""
SAYS_ANGLE = re.compile(r"°|\bdegrees?\b|\bdeg\b|\bquarter\b|\bhalf\b|\bupside down\b", re.IGNORECASE)
"""Words of an instruction that state an angle."""


@dataclass(frozen=True, eq=False)
class Turning:
    """Pictures that show a turn.

    Attributes:
        shows: Where they come from, in words.
        thing: Before.
        goal: After.
        reach: Half the side of what is cut out [view px].
    """

    shows: str
    thing: Shown
    goal: Shown
    reach: int

    def misfits(self, turns: Sequence[float]) -> np.ndarray:
        """How far the turned thing is from the goal, for each turn [degrees]."""
        return turn_misfits(self.thing, self.goal, self.reach, turns)


@dataclass(frozen=True, eq=False)
class Settled:
    """Steps with the angles that were read; what each target's story and Verification are told of it."""

    steps: tuple[Step, ...]
    grounded: Mapping[str, GroundedTarget]
    told: tuple[str, ...] = ()


async def settle_turns(
    session: AgentSession, scene: SceneShown, steps: tuple[Step, ...], grounded: Mapping[str, GroundedTarget]
) -> Settled:
    """Check every angle that pictures show, and read those that they do not agree with (`lean`, with a Manager)."""
    settled = Settled(steps, grounded)
    if session.config.mode != "lean" or not session.members.manager or SAYS_ANGLE.search(scene.instruction.text):
        return settled
    if not any(isinstance(step, PickPlaceStep) and step.rotate_deg for step in steps):
        return settled
    pair = _pair(scene.instruction)
    read: dict[str, float | None] = {}
    turned: set[str] = set()
    for number, step in enumerate(steps):
        if not isinstance(step, PickPlaceStep) or step.pick in turned:
            # What an earlier step turned lies otherwise than the picture shows it.
            continue
        turned.add(step.pick)
        turning = _turning(scene, step, grounded, pair)
        if turning is None or agrees(turning, step.rotate_deg):
            continue
        if turning.shows not in read:
            read[turning.shows] = await _read(session, grounded[step.pick].target, turning)
        found = read[turning.shows]
        settled = _with(settled, number, step, turning, found)
    if settled.told:
        session.stage("turns", "; ".join(settled.told))
    return settled


def agrees(turning: Turning, stated_deg: float) -> bool:
    """Whether the pictures agree with a stated angle, pixel by pixel: then nobody needs to be asked."""
    least = float(turning.misfits(range(0, 360, 10)).min())
    near = [stated_deg + off for off in (-CLOSE_DEG, -CLOSE_DEG / 2, 0.0, CLOSE_DEG / 2, CLOSE_DEG)]
    stated = float(turning.misfits(near).min())
    return min(least, stated) <= MOST and stated <= AS_GOOD * least + SLACK


def _turning(
    scene: SceneShown, step: PickPlaceStep, grounded: Mapping[str, GroundedTarget], pair: Turning | None
) -> Turning | None:
    """The pictures that show how far a step turns its thing; None when none do.

    A step that turns nothing is left alone: whether it should is a question of the plan, not of an angle.
    """
    if not step.rotate_deg:
        return None
    thing, place = grounded[step.pick], grounded.get(step.place.target)
    if pair is not None:
        return pair
    if thing.box is None or place is None or not isinstance(step.place, At) or place.target.kind != "area":
        return None
    goal = scene.arranged(place.target)
    point = place.points.get("place")
    if goal is None or point is None or not seen_from_above(scene.view):
        return None
    name, view = goal
    shows = f"{thing.target.id} now and its place in {{{name}}}"
    return Turning(shows, Shown(scene.view, thing.box.centre), Shown(view, point), reach_px(thing.box))


def _pair(instruction: Instruction) -> Turning | None:
    """The before and after pair in which the turn shows most plainly; None without one."""
    slots = list(instruction.slots.values())
    befores = [slot for slot in slots if slot.kind == "before"]
    afters = [slot for slot in slots if slot.kind == "after"]
    found = [_alone(before, after) for before, after in zip(befores, afters, strict=False)]
    turnings = [turning for turning in found if turning is not None]
    # A thing that looks the same in several turns shows none.
    return max(turnings, key=_plainness, default=None)


def _plainness(turning: Turning) -> float:
    return float(turn_misfits(turning.thing, turning.thing, turning.reach, range(30, 331, 15)).min())


def _alone(before: Slot, after: Slot) -> Turning | None:
    was, now = next(iter(before.views.values())), next(iter(after.views.values()))
    box, end = thing_alone(was), thing_alone(now)
    if box is None or end is None or not seen_from_above(was):
        return None
    shows = f"{{{before.name}}} and {{{after.name}}}"
    return Turning(shows, Shown(was, box.centre), Shown(now, end.centre), max(reach_px(box), reach_px(end)))


async def _read(session: AgentSession, target: Target, turning: Turning) -> float | None:
    """The angle that the Manager reads off two strips [degrees clockwise]; None when no cut-out lies as the goal does."""
    coarse = await _choose(session, target, turning, COARSE_DEG, fine=False)
    if coarse is None:
        return None
    fine = await _choose(session, target, turning, tuple(coarse + off for off in FINE_DEG), fine=True)
    return coarse if fine is None else fine


async def _choose(
    session: AgentSession, target: Target, turning: Turning, turns: Sequence[float], *, fine: bool
) -> float | None:
    strip = turn_strip(turning.thing, turning.goal, turning.reach, turns, "turns")
    question = ReadTurn(target, strip, tuple(float(turn) for turn in turns), turning.shows, fine)
    choice: TurnChoice = await session.ask(question, stage="act", branch=target.id)
    return None if choice.number is None else float(turns[choice.number - 1])


def _with(settled: Settled, number: int, step: PickPlaceStep, turning: Turning, read_deg: float | None) -> Settled:
    """The steps with a turn as it was read; one that is close enough to what the step states stands."""
    stated = turn_words(step.rotate_deg)
    if read_deg is None:
        said = f"no turn of {step.pick} lies as {turning.shows} show it; {stated}, as stated"
        return _told(settled, settled.steps, step, said)
    off = math.remainder(read_deg - step.rotate_deg, 360.0)
    if abs(off) <= CLOSE_DEG:
        return _told(settled, settled.steps, step, f"{step.pick} turned {stated}, as read from {turning.shows}")
    turn = math.remainder(read_deg, 360.0)
    steps = list(settled.steps)
    steps[number] = replace(step, rotate_deg=turn)
    said = f"{step.pick} turned {turn_words(turn)}, as read from {turning.shows}; stated was {stated}"
    return _told(settled, tuple(steps), step, said)


def _told(settled: Settled, steps: tuple[Step, ...], step: PickPlaceStep, said: str) -> Settled:
    item = settled.grounded[step.pick]
    event = GroundingEvent("turn", said, item.box, tuple(item.points.values()))
    grounded = {**settled.grounded, step.pick: replace(item, history=(*item.history, event))}
    return Settled(steps, grounded, (*settled.told, said))
