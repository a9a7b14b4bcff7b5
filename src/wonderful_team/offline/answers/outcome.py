"""JudgeSubgoal, JudgeOutcome and Replan: where things are now against where they should be."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from wonderful_team.contracts import Advice, JudgeOutcome, JudgeSubgoal, Outcome, Replan, SubgoalOutcome, VerdictDraft
from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.pictures import BoxMark, Picture
from wonderful_team.core.values import Target
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.answers.handled_outcome import judge_led, judge_shaken
from wonderful_team.offline.answers.roles import Task, tasks_of
from wonderful_team.offline.description import Description
from wonderful_team.offline.eyes import Eyes, eyes_of, eyes_of_task
from wonderful_team.offline.goals.aims import Aim
from wonderful_team.offline.goals.deriving import already, derive
from wonderful_team.offline.goals.instruction import read_task
from wonderful_team.offline.pushing.sweeping import sweep_of, swept
from wonderful_team.offline.vision import Thing, strip_presence
from wonderful_team.offline.vision.changes import gap_px
from wonderful_team.offline.vision.turning import turned_deg

ALIKE = 0.55
"""Likeness of colours from which a thing after may be the thing before (0 to 1)."""
STAYED = 0.5
"""A thing that moved by less than this many of its radii has stayed."""
GAINED = 0.4
"""Share of a thing's own area by which its colours must have grown at its place."""
ANGLE_SLACK_DEG = 15.0
"""How far a measured turn may differ from the one asked for."""


def answer_outcome(question: JudgeOutcome) -> Outcome:
    """A verdict per subgoal from the pictures; what the robot reported explains failures."""
    before = eyes_of_task(question.task)
    after = eyes_of(question.after[0], question.task.slots)
    judge = _Judge(question, before, after)
    verdicts = []
    for subgoal in question.subgoals:
        parts = [judge.task(task) for task in tasks_of(subgoal, question.targets, before)]
        order = ("not_done", "undone", "unclear", "done")
        status, evidence = min(parts, key=lambda part: order.index(part[0]))
        cause = judge.cause(subgoal.id, evidence) if status in ("not_done", "undone") else None
        verdicts.append(VerdictDraft(subgoal=subgoal.id, status=status, cause=cause, evidence=evidence))
    done = sum(item.status == "done" for item in verdicts)
    return Outcome(
        reasoning=f"{done} of {len(verdicts)} subgoals show as reached in the picture after.", verdicts=verdicts
    )


def answer_subgoal(question: JudgeSubgoal) -> SubgoalOutcome:
    """What became of one subgoal, and whether what the later ones use lies where it lay, from the pictures."""
    before = eyes_of_task(question.task)
    judge = _Judge(question, before, eyes_of(question.after[0], question.task.slots))
    own = question.subgoal
    parts = [judge.task(task) for task in tasks_of(own, question.targets, before)]
    order = ("not_done", "undone", "unclear", "done")
    status, evidence = min(parts, key=lambda part: order.index(part[0]))
    missed = status in ("not_done", "undone")
    changed = "; ".join(judge.strayed(question))
    return SubgoalOutcome(
        reasoning="Compared where things show before and after.",
        status="not_done" if missed else "done" if status == "done" else "unclear",
        evidence=evidence,
        cause=judge.cause(own.id, evidence) if missed else None,
        rest_holds=not changed,
        what_changed=changed,
    )


class _Judge:
    """Compares two pictures."""

    def __init__(self, question: JudgeOutcome | JudgeSubgoal, before: Eyes, after: Eyes) -> None:
        self.question, self.before, self.after = question, before, after
        self.boxes = {
            mark.label.split()[0]: mark.box
            for mark in question.task.main.marks
            if isinstance(mark, BoxMark) and mark.label
        }
        self.claimed: set[int] = set()

    def task(self, task: Task) -> tuple[str, str]:
        """Status and evidence of one task."""
        thing = self._was(task.thing, task.aim.thing.number if task.aim is not None else None)
        if thing is None or task.thing is None:
            return "unclear", "the thing does not show in the picture before"
        if task.aim is not None and "inside" in task.aim.legs:
            return self._swept(task.aim, thing)
        if task.aim is not None and task.aim.kind == "trace":
            pictures = (self.question.task.main, self.question.after[0])
            return judge_led(task.aim, *pictures, thing.box, self._measured(task.subgoal))
        now, name = self._now(thing), task.thing.words
        if task.aim is not None and task.aim.kind == "shake" and now is not None:
            stands = _at_origin(f"the {name} stands {{}} radii from where it was", now, thing)
            return judge_shaken(name, stands, self._measured(task.subgoal))
        place = self._was(task.place, task.to_number)
        if now is None:
            return self._merged(name, thing, place if task.how in ("in", "on", "") else None)
        if task.rotate_deg and task.place is None:
            return self._turned(name, task.rotate_deg, thing, now)
        if task.place is None:
            return _at_origin(f"the {name} lies {{}} radii from where it was", now, thing)
        if task.how == "origin":
            if place is None:
                return "unclear", f"the {task.place.words} does not show in the picture before"
            told = f"the {name} lies {{}} radii from where the {task.place.words} was"
            return _at_origin(told, now, thing, place)
        return self._at_place(task.how, name, task.place, place, thing, now)

    def strayed(self, question: JudgeSubgoal) -> Iterator[str]:
        """The things that later subgoals use and this one does not, and that do not lie where they lay."""
        names = {name for subgoal in question.later for name in subgoal.targets} - set(question.subgoal.targets)
        for target in question.targets:
            was = self._was(target, None) if target.id in names and target.kind == "object" else None
            if was is None:
                continue
            now = self._now(was)
            if now is None and any(doubt.startswith(f"{target.id} ") for doubt in question.doubts):
                yield f"the {target.words} does not show any more"
            elif now is not None and self._moved(was, now) >= STAYED:
                yield f"the {target.words} {self._told_move(was, now)}"

    def _swept(self, aim: Aim, was: Thing) -> tuple[str, str]:
        """Whether a thing lies wholly in the place it was pushed to; alike things in there count once each."""
        name = aim.thing.words
        of = self.after.number
        sweep = None if aim.to is None else sweep_of(aim.to, aim.off, aim.limit, lambda item: of(item.description))
        if aim.to is None or sweep is None:
            return "unclear", f"where the {name} was pushed to does not show"
        like = [thing for thing in self.after.scene.things if _alike(was, thing)]
        if any(self._moved(was, thing) < STAYED for thing in like):
            return "not_done", f"the {name} has not moved"
        stood = [thing.centre for thing in self.before.scene.things if thing.number != was.number]
        near = STAYED * was.radius_px
        new = [
            thing
            for thing in like
            if thing.number not in self.claimed and all(gap_px(at, thing.centre) >= near for at in stood)
        ]
        there = swept(self.after.scene, sweep, [thing.number for thing in new])
        if there:
            self.claimed.add(there[0])
            return "done", f"the {name} lies wholly in the {aim.to.words} now"
        nearest = min((self._moved(was, thing) for thing in new), default=None)
        where = "does not show any more" if nearest is None else f"moved {nearest:.1f} of its radii"
        return "not_done", f"the {name} does not lie wholly in the {aim.to.words}: it {where}"

    def cause(self, subgoal: str, evidence: str) -> str:
        """What the robot reported of it, else what the picture shows."""
        bad = [line for line in self._measured(subgoal) if "not executed" in line or "fault" in line or "False" in line]
        return bad[0] if bad else evidence

    def _measured(self, subgoal: str) -> list[str]:
        """What the robot reported of a subgoal."""
        return [line for line in self.question.measured if line.startswith(f"{subgoal}:")]

    def _was(self, target: Target | None, number: int | None) -> Thing | None:
        """The thing that a target was, by its drawn box, else by its words."""
        if target is None:
            return None
        box = self.boxes.get(target.id)
        if box is not None:
            best = max(self.before.scene.things, key=lambda thing: thing.box.iou(box), default=None)
            if best is not None and best.box.iou(box) > 0.3:
                return best
        return self.before.thing(number)

    def _now(self, was: Thing) -> Thing | None:
        """The same thing in the picture after: alike in colours, outline and size; the nearer one of equals."""
        best, most = None, 0.0
        for thing in self.after.scene.things:
            if not _alike(was, thing):
                continue
            colours = float(was.look.histogram @ thing.look.histogram)
            size = min(was.area_px, thing.area_px) / max(was.area_px, thing.area_px)
            rating = colours * (0.4 + 0.6 * size) - 0.01 * min(self._moved(was, thing), 10.0)
            if rating > most:
                best, most = thing, rating
        return best

    def _merged(self, name: str, was: Thing, place: Thing | None) -> tuple[str, str]:
        """A thing that does not stand out any more may lie on its place: its colours then show there and not before."""
        if place is None:
            return "unclear", f"the {name} does not show in the picture after"
        before, after = self.question.task.main, self.question.after[0]
        gained = colours_in(after, place.box, was) - colours_in(before, place.box, was)
        left = colours_in(after, was.box, was)
        if gained >= GAINED * was.area_px / place.box.area and left < GAINED:
            return "done", f"{gained:.0%} of the place shows the colours of the {name} now"
        return "unclear", f"the {name} does not show in the picture after, nor its colours at the place"

    def _at_place(
        self, how: str, name: str, target: Target, place: Thing | None, was: Thing, now: Thing
    ) -> tuple[str, str]:
        there = None if place is None else self._now(place) or place
        spot, where = self.boxes.get(target.id) if there is None else there.box, target.words
        if spot is None:
            moved = self._moved(was, now)
            return ("unclear", f"the place {where} does not show; the thing moved {moved:.1f} radii")
        if how in ("in", "on", "side", "between", ""):
            inside = (
                there is not None
                and there is not place
                and there is not now
                and (now.on == there.number or there.covers(now.centre))
            )
            if inside or spot.contains(now.centre):
                return "done", f"the {name} is {'in' if how != 'on' else 'on'} the {where} now"
            return "not_done", f"the {name} is not at the {where}: it {self._told_move(was, now)}"
        dx, dy = now.centre[0] - spot.centre[0], now.centre[1] - spot.centre[1]
        near = gap_px(now.centre, spot.centre) <= 1.25 * (max(spot.width, spot.height) + 2 * now.radius_px)
        side = {"left": -dx, "right": dx, "above": -dy, "below": dy}.get(how)
        ok = near if side is None else side > 0 and side >= 0.7 * max(abs(dx), abs(dy))
        words = f"the {name} is {'' if ok else 'not '}{how} of the {where}; it {self._told_move(was, now)}"
        return ("done" if ok else "not_done"), words

    def _turned(self, name: str, asked_deg: float, was: Thing, now: Thing) -> tuple[str, str]:
        if self._moved(was, now) > 2.0:
            return "not_done", f"the {name} was carried {self._moved(was, now):.1f} radii away"
        measured = turned_deg(self.question.task.main, was, self.question.after[0], now, asked_deg)
        if measured is None:
            return "unclear", f"the {name} looks the same however it is turned"
        ok = abs((measured - asked_deg + 180) % 360 - 180) <= ANGLE_SLACK_DEG
        text = f"the {name} shows turned by {measured:.0f} degrees clockwise, asked for {asked_deg:g}"
        return ("done" if ok else "not_done"), text

    @staticmethod
    def _moved(was: Thing, now: Thing) -> float:
        return gap_px(now.centre, was.centre) / max(was.radius_px, 1.0)

    def _told_move(self, was: Thing, now: Thing) -> str:
        moved = self._moved(was, now)
        return "has not moved" if moved < STAYED else f"moved {moved:.1f} of its radii"


def _at_origin(told: str, now: Thing, *stood: Thing) -> tuple[str, str]:
    """Whether a thing lies where the last of these stood, in radii of the largest of them."""
    away = gap_px(now.centre, stood[-1].centre) / max(1.0, *(thing.radius_px for thing in stood))
    return "done" if away <= 1.0 else "not_done", told.format(f"{away:.1f}")


def _alike(was: Thing, thing: Thing) -> bool:
    """Whether a thing after may be the thing before, by its colours and size."""
    size = min(was.area_px, thing.area_px) / max(was.area_px, thing.area_px)
    return float(was.look.histogram @ thing.look.histogram) >= ALIKE and size >= 0.3


def colours_in(picture: Picture, box: Box, thing: Thing) -> float:
    """Share of a box of a picture that shows a thing's colours, 0 to 1."""
    width, height = picture.size_px
    x0, y0 = max(0, int(box.x0)), max(0, int(box.y0))
    x1, y1 = min(width, max(x0 + 1, int(box.x1))), min(height, max(y0 + 1, int(box.y1)))
    rgb = np.ascontiguousarray(picture.rgb[y0:y1, x0:x1])
    part = Picture("part", rgb, Frame.whole("part", (x1 - x0, y1 - y0)))
    return strip_presence(part, Description("thing", ""), {}, target=thing).share


def answer_replan(question: Replan) -> Advice:
    """Stop when all is done or nothing is left to try; else say what to do differently."""
    open_ones = [item for item in question.verdicts if item.status in ("not_done", "undone")]
    unclear = [item for item in question.verdicts if item.status == "unclear"]
    if not open_ones and (not unclear or _nothing_left(question)):
        return Advice(reasoning="Every subgoal shows as reached.", decision="done", cause="", advice="")
    first = (open_ones or unclear)[0]
    texts = {subgoal.id: subgoal.text for subgoal in question.subgoals}
    cause = f"{first.subgoal} '{texts.get(first.subgoal, '')}': {first.cause or first.evidence or 'it is not clear'}"
    if question.replans_left <= 0:
        return Advice(reasoning="No replan is left.", decision="give_up", cause=cause, advice="")
    names = ", ".join(item.subgoal for item in (open_ones or unclear))
    return Advice(
        reasoning=f"{len(open_ones)} subgoals are not reached, {len(unclear)} unclear.",
        decision="replan",
        cause=cause,
        advice=f"Plan again from the picture as it is now; still open: {names}. {cause}",
    )


def _nothing_left(question: Replan) -> bool:
    """Whether the instruction asks for nothing more in the picture as it is now."""
    try:
        understood = read_task(question.task)
    except NotUnderstoodError:
        return False
    eyes = eyes_of_task(question.task)
    return not [
        aim
        for aim in derive(understood, eyes, strict=False).aims
        if aim.kind != "rotate" and not (aim.to is not None and not aim.legs and already(eyes, aim.thing, aim.to))
    ]
