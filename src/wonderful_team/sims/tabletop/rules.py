"""The rules of a task: phases in order, counts, what must never happen; and how far a history has come."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from wonderful_team.sims.tabletop.goals import Count, Goal, Never, Poses, Verdict, centre_of, off_table
from wonderful_team.sims.tabletop.model import Thing

Order: TypeAlias = Literal["free", "no skipping", "every action"]
"""What a wrong order costs: nothing; a failure when a later phase's goal is reached first; or a failure after
every action that does not reach the next phase."""
Distractors: TypeAlias = Literal["always", "at the end"]
"""When distractors must be away from targets: after every action, or once all goals are met."""


@dataclass(frozen=True)
class RuleState:
    """How far a history has come.

    Attributes:
        phase: Number of the phase that is worked on, from 0.
        counted: Things that were inside the zone of a count at any time, one set per count.
        met: Goals that were met after the last action.
        done: Goals of the phase that count as reached; they stay so where goals last.
        at_start: Goals that were met before the first action.
    """

    verdict: Verdict
    phase: int = 0
    counted: tuple[frozenset[str], ...] = ()
    met: frozenset[Goal] = frozenset()
    done: frozenset[Goal] = frozenset()
    at_start: frozenset[Goal] = frozenset()


@dataclass(frozen=True)
class Rules:
    """Goals of a task and what ends it.

    Attributes:
        phases: Goals that must all be met together, phase after phase.
        distractors: Things that must stay away from every target, and targets from them.
        ends_when_reached: True: reaching everything once is enough. False: the state at the end counts.
        counts: Things to be gathered in a zone, beside the phases.
        nevers: What must not happen, not even during an action.
        order: What a wrong order of the phases costs.
        distractors_matter: When distractors are judged.
        goals_last: Whether a goal stays reached once it was met after an action of its phase, whatever happens to the
            thing later, as in VIMA-Bench; otherwise the goals of a phase must be met together.
    """

    phases: tuple[tuple[Goal, ...], ...]
    distractors: tuple[str, ...]
    horizon: int
    ends_when_reached: bool = True
    counts: tuple[Count, ...] = ()
    nevers: tuple[Never, ...] = ()
    order: Order = "free"
    distractors_matter: Distractors = "always"
    goals_last: bool = False

    @property
    def goals(self) -> tuple[Goal, ...]:
        """The goals of all phases."""
        return tuple(goal for phase in self.phases for goal in phase)

    @property
    def wanted(self) -> frozenset[str]:
        """Names of the things that some goal or count is about."""
        return frozenset({goal.thing for goal in self.goals} | {n for count in self.counts for n in count.things})

    def start(self, poses: Poses, things: Mapping[str, Thing]) -> RuleState:
        """Before the first action; what is right by then is not yet an achievement of a later phase."""
        met = self._met(poses, things)
        done = frozenset() if self.goals_last or not self.phases else met.intersection(self.phases[0])
        empty = RuleState(Verdict("open"), 0, tuple(frozenset() for _ in self.counts), met, done, met)
        return replace(empty, verdict=self._failed_at_rest(empty, poses) or self._reached(empty, poses))

    def after(self, before: RuleState, during: Sequence[Poses], poses: Poses, things: Mapping[str, Thing]) -> RuleState:
        """After one action: `during` are poses on the way, `poses` those at rest. A failure stays a failure."""
        if before.verdict.state == "failure":
            return before
        broken = self._broken(during, poses, things)
        if broken is not None:
            return replace(before, verdict=broken)
        counted, failure = self._gathered(before.counted, poses, things)
        met, phase = self._met(poses, things), before.phase
        done = self._done(before, met)
        now = replace(before, verdict=Verdict("open"), counted=counted, met=met, done=done)
        failure = failure or self._wrong_order(before, now) or self._failed_at_rest(now, poses)
        if failure is not None:
            return replace(now, verdict=failure)
        verdict = self._reached(now, poses)
        if verdict.state == "open" and phase < len(self.phases) - 1 and done.issuperset(self.phases[phase]):
            # Goals that last count from the next action on.
            begun = frozenset() if self.goals_last else met.intersection(self.phases[phase + 1])
            now = replace(now, phase=phase + 1, done=begun)
        return replace(now, verdict=verdict)

    def unmet(self, progress: RuleState) -> str:
        """What is still missing, in words."""
        later = self.phases[progress.phase :]
        missing = [
            f"goals not met: {', '.join(g.thing for g in phase if g not in progress.done)}" for phase in later[:1]
        ]
        if len(later) > 1:
            missing.append(f"phase {progress.phase + 1} of {len(self.phases)}")
        for count, inside in zip(self.counts, progress.counted, strict=True):
            missing.append(f"{len(inside)} of exactly {count.exactly} things in the zone")
        return "; ".join(missing)

    def _met(self, poses: Poses, things: Mapping[str, Thing]) -> frozenset[Goal]:
        return frozenset(goal for goal in self.goals if goal.met(poses, things))

    def _done(self, before: RuleState, met: frozenset[Goal]) -> frozenset[Goal]:
        """The goals of the phase that count as reached."""
        due = frozenset(self.phases[before.phase]) if self.phases else frozenset[Goal]()
        return due & (met | before.done if self.goals_last else met)

    def _broken(self, during: Sequence[Poses], poses: Poses, things: Mapping[str, Thing]) -> Verdict | None:
        """What must not happen at any time."""
        for moment in (*during, poses):
            for never in self.nevers:
                name = never.broken(moment, things)
                if name is not None:
                    return Verdict("failure", f"{name} touched {never.over}")
        return None

    def _gathered(
        self, before: tuple[frozenset[str], ...], poses: Poses, things: Mapping[str, Thing]
    ) -> tuple[tuple[frozenset[str], ...], Verdict | None]:
        """What lies in the zones, or did after an action before; too many, or a stranger, is a failure."""
        counted = tuple(inside | count.inside(poses, things) for count, inside in zip(self.counts, before, strict=True))
        for count, inside in zip(self.counts, counted, strict=True):
            intruder = count.intruder(poses, things)
            if intruder is not None:
                return counted, Verdict("failure", f"{intruder} came into the zone")
            if len(inside) > count.exactly:
                reason = f"{len(inside)} things are in the zone, exactly {count.exactly} may"
                return counted, Verdict("failure", reason)
        return counted, None

    def _wrong_order(self, before: RuleState, now: RuleState) -> Verdict | None:
        if self.order == "free":
            return None
        due = self.phases[before.phase]
        if now.done.issuperset(due):
            return None
        if self.order == "every action":
            return Verdict("failure", f"an action did not bring {due[0].thing} to step {before.phase + 1}")
        # Where a thing stood at the start it may be at any time: that skips nothing.
        for goal in (goal for phase in self.phases[before.phase + 1 :] for goal in phase):
            if goal in now.met and goal not in {*due, *before.met, *before.at_start}:
                return Verdict("failure", f"{goal.thing} reached a later goal before the next one")
        return None

    def _failed_at_rest(self, now: RuleState, poses: Poses) -> Verdict | None:
        remaining = {goal.thing for goals in self.phases[now.phase :] for goal in goals if goal not in now.done}
        remaining |= {name for count in self.counts for name in count.things}.difference(*now.counted)
        for name in sorted(remaining):
            if off_table(poses[name]):
                x, y = centre_of(poses[name])
                return Verdict("failure", f"{name} left the table at ({x:.3f}, {y:.3f}) m")
        reason = self._disturbed(poses) if self.distractors_matter == "always" else ""
        return Verdict("failure", reason) if reason else None

    def _reached(self, now: RuleState, poses: Poses) -> Verdict:
        counts = zip(self.counts, now.counted, strict=True)
        last = now.phase >= len(self.phases) - 1
        if not last or not all(len(inside) == count.exactly for count, inside in counts):
            return Verdict("open")
        if self.phases and not now.done.issuperset(self.phases[-1]):
            return Verdict("open")
        reason = self._disturbed(poses)
        return Verdict("failure", reason) if reason else Verdict("success")

    def _disturbed(self, poses: Poses) -> str:
        """A distractor at a target of any goal, or with something that has a goal; which goals are reached is all one."""
        for goal in self.goals:
            at = centre_of(poses[goal.thing])
            for name in self.distractors:
                other = centre_of(poses[name])
                if math.dist(at, other) < goal.within_m and goal.turned_like(poses, name):
                    return (
                        f"{goal.thing} lies {math.dist(at, other):.3f} m from the distractor {name} "
                        f"(limit {goal.within_m} m)"
                    )
                for target in goal.target_points(poses):
                    if math.dist(target, other) < goal.within_m:
                        return (
                            f"the distractor {name} lies {math.dist(target, other):.3f} m from a target of {goal.thing}"
                        )
        return ""
