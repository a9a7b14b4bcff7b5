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
class Progress:
    """How far a history has come.

    Attributes:
        phase: Number of the phase that is worked on, from 0.
        counted: Things that were inside the zone of a count at any time, one set per count.
        met: Goals that were met after the last action.
    """

    verdict: Verdict
    phase: int = 0
    counted: tuple[frozenset[str], ...] = ()
    met: frozenset[Goal] = frozenset()


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
    """

    phases: tuple[tuple[Goal, ...], ...]
    distractors: tuple[str, ...]
    horizon: int
    ends_when_reached: bool = True
    counts: tuple[Count, ...] = ()
    nevers: tuple[Never, ...] = ()
    order: Order = "free"
    distractors_matter: Distractors = "always"

    @property
    def goals(self) -> tuple[Goal, ...]:
        """The goals of all phases."""
        return tuple(goal for phase in self.phases for goal in phase)

    @property
    def wanted(self) -> frozenset[str]:
        """Names of the things that some goal or count is about."""
        return frozenset({goal.thing for goal in self.goals} | {n for count in self.counts for n in count.things})

    def start(self, poses: Poses, things: Mapping[str, Thing]) -> Progress:
        """Before the first action; what is right by then is not yet an achievement of a later phase."""
        empty = Progress(Verdict("open"), 0, tuple(frozenset() for _ in self.counts))
        met = self._met(poses, things)
        verdict = self._failed_at_rest(empty, poses, things) or self._reached(empty, met, poses)
        return replace(empty, met=met, verdict=verdict)

    def after(self, before: Progress, during: Sequence[Poses], poses: Poses, things: Mapping[str, Thing]) -> Progress:
        """After one action: `during` are poses on the way, `poses` those at rest. A failure stays a failure."""
        if before.verdict.state == "failure":
            return before
        counted, failure = before.counted, None
        for moment in (*during, poses):
            counted, failure = self._watch(counted, moment, things)
            if failure is not None:
                return replace(before, verdict=failure, counted=counted)
        met, phase = self._met(poses, things), before.phase
        now = Progress(Verdict("open"), phase, counted, met)
        failure = self._wrong_order(before, met) or self._failed_at_rest(now, poses, things)
        if failure is not None:
            return replace(now, verdict=failure)
        verdict = self._reached(now, met, poses)
        if verdict.state == "open" and phase < len(self.phases) - 1 and met.issuperset(self.phases[phase]):
            phase += 1
        return replace(now, verdict=verdict, phase=phase)

    def unmet(self, progress: Progress, poses: Poses, things: Mapping[str, Thing]) -> str:
        """What is still missing, in words."""
        later = self.phases[progress.phase :]
        missing = [
            f"goals not met: {', '.join(g.thing for g in phase if not g.met(poses, things))}" for phase in later[:1]
        ]
        if len(later) > 1:
            missing.append(f"phase {progress.phase + 1} of {len(self.phases)}")
        for count, inside in zip(self.counts, progress.counted, strict=True):
            missing.append(f"{len(inside)} of exactly {count.exactly} things in the zone")
        return "; ".join(missing)

    def _met(self, poses: Poses, things: Mapping[str, Thing]) -> frozenset[Goal]:
        return frozenset(goal for goal in self.goals if goal.met(poses, things))

    def _watch(
        self, counted: tuple[frozenset[str], ...], poses: Poses, things: Mapping[str, Thing]
    ) -> tuple[tuple[frozenset[str], ...], Verdict | None]:
        """What is judged at every moment: counts and what must never happen."""
        for never in self.nevers:
            name = never.broken(poses, things)
            if name is not None:
                return counted, Verdict("failure", f"{name} touched {never.over}")
        now = []
        for count, inside in zip(self.counts, counted, strict=True):
            reached = inside | count.inside(poses, things)
            if len(reached) > count.exactly:
                return counted, Verdict(
                    "failure", f"{len(reached)} things are in the zone, exactly {count.exactly} may"
                )
            intruder = count.intruder(poses, things)
            if intruder is not None:
                return counted, Verdict("failure", f"{intruder} came into the zone")
            now.append(reached)
        return tuple(now), None

    def _wrong_order(self, before: Progress, met: frozenset[Goal]) -> Verdict | None:
        if self.order == "free":
            return None
        due = self.phases[before.phase]
        if met.issuperset(due):
            return None
        if self.order == "every action":
            return Verdict("failure", f"an action did not bring {due[0].thing} to step {before.phase + 1}")
        for phase in self.phases[before.phase + 1 :]:
            for goal in phase:
                if goal not in due and goal in met and goal not in before.met:
                    return Verdict("failure", f"{goal.thing} reached a later goal before the next one")
        return None

    def _failed_at_rest(self, now: Progress, poses: Poses, things: Mapping[str, Thing]) -> Verdict | None:
        remaining = [goal for goals in self.phases[now.phase :] for goal in goals]
        placed = {goal.thing for goal in remaining if goal.met(poses, things)}.union(*now.counted)
        for name in sorted(self.wanted - placed):
            if off_table(poses[name]):
                x, y = centre_of(poses[name])
                return Verdict("failure", f"{name} left the table at ({x:.3f}, {y:.3f}) m")
        reason = self._disturbed(remaining, poses) if self.distractors_matter == "always" else ""
        return Verdict("failure", reason) if reason else None

    def _reached(self, now: Progress, met: frozenset[Goal], poses: Poses) -> Verdict:
        counts = zip(self.counts, now.counted, strict=True)
        last = now.phase >= len(self.phases) - 1
        if not last or not all(len(inside) == count.exactly for count, inside in counts):
            return Verdict("open")
        if self.phases and not met.issuperset(self.phases[-1]):
            return Verdict("open")
        reason = self._disturbed(self.phases[-1], poses) if self.phases else ""
        return Verdict("failure", reason) if reason else Verdict("success")

    def _disturbed(self, goals: Sequence[Goal], poses: Poses) -> str:
        for goal in goals:
            at = centre_of(poses[goal.thing])
            for name in self.distractors:
                other = centre_of(poses[name])
                if math.dist(at, other) < goal.within_m:
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
