"""What every answer starts from: truth, the eyes, and the plan that truth asks for now."""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from wonderful_team.contracts import ShownSlot, ShownTask
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Picture
from wonderful_team.core.protocols import SceneTruth
from wonderful_team.core.values import GroundTruthView, Instruction, Subgoal, Target, TrueThing
from wonderful_team.errors import UnsupportedQuestion
from wonderful_team.simulated.draft import Meaning, Names, Written, write
from wonderful_team.simulated.error_sampler import ErrorSampler
from wonderful_team.simulated.finding import meaning_of
from wonderful_team.simulated.naming import unique_words
from wonderful_team.simulated.plan import Move, Shove, moves_of
from wonderful_team.simulated.profile import Profile
from wonderful_team.simulated.profiles import PROFILES
from wonderful_team.simulated.seeing import Eyes, Seen

SWAPS = 0.5
"""How often a mistaken plan of several moves swaps two of them; else it leaves one out."""


@dataclass(frozen=True, eq=False)
class Task:
    """A task of which every picture is true: nothing is planned from anything else.

    Attributes:
        plan: What this model plans at first, with the mistakes of its profile.
        right: The plan without mistakes.
    """

    main: Seen
    plan: Written
    right: Written

    def plan_of(self, subgoals: Sequence[Subgoal]) -> Written | None:
        """Which of this model's plans these subgoals are; None when they are another's."""
        return next((plan for plan in (self.plan, self.right) if plan.is_plan(subgoals)), None)


class Context:
    """Truth as one sees it through pictures."""

    def __init__(
        self, truth: SceneTruth, instruction: Instruction | None, name: str, profile: Profile = PROFILES["perfect"]
    ) -> None:
        self.truth, self.instruction, self.name, self.profile = truth, instruction, name, profile
        self.eyes = Eyes(truth)
        self.sampler: ErrorSampler | None = None
        self._plans: tuple[GroundTruthView, Written, Written] | None = None

    def task(self, shown: ShownTask) -> Task | None:
        """The task as its pictures show it; None when one of them is missing, untrue or out of date.

        Raises:
            UnsupportedQuestion: The words are not those that this truth judges.
        """
        self.check_words(shown)
        main = self.eyes.see(shown.main)
        if main is None or not main.current:
            return None
        if any(self.eyes.see(view) is None for view in shown.views[1:]) or not self.slots_true(shown.slots):
            return None
        if self.instruction is not None and set(self.instruction.slots) - set(shown.slot_names):
            return None
        return Task(main, *self.plans(main))

    def check_words(self, shown: ShownTask) -> None:
        """Raises UnsupportedQuestion when the instruction is not the one whose goals truth knows."""
        if self.instruction is not None and shown.instruction != self.instruction.text:
            raise UnsupportedQuestion(
                self.name,
                "instruction",
                f"it knows what is right for {self.instruction.text!r} only, and was asked {shown.instruction!r}",
            )

    def slots_true(self, slots: Iterable[ShownSlot]) -> bool:
        """Whether every picture of these slots is that slot's own and true."""
        return all(
            picture.frame.view_id.startswith(f"slot:{slot.name}:") and self.eyes.see(picture) is not None
            for slot in slots
            for picture in slot.pictures
        ) and all(slot.pictures for slot in slots)

    def plans(self, seen: Seen) -> tuple[Written, Written]:
        """The plan that this model writes, and the right one, in words that fit the newest look at this view."""
        known = self._plans
        if known is not None and known[0] is seen.newest:
            return known[1], known[2]
        things = self.things(seen)
        moves = moves_of(self.truth.oracle(), self.truth, self.instruction)
        pushing = any(isinstance(move, Shove) for move in moves)
        words = Names(unique_words(seen.newest, things), self.shown(things) if pushing else {})
        right = write(moves, words)
        mistaken = self._mistaken(moves, seen)
        own = right if mistaken is moves else write(mistaken, words)
        self._plans = (seen.newest, own, right)
        return own, right

    def shown(self, things: Mapping[str, TrueThing]) -> dict[str, str]:
        """The picture of the instruction that shows a thing alone, by the thing's name."""
        found: dict[str, str] = {}
        for name, slot in {}.items() if self.instruction is None else self.instruction.slots.items():
            if slot.kind == "object":
                view = next(iter(slot.views.values()))
                for sight in self.truth.observation_log(view.id):
                    found.update({thing: name for thing in (sight.things or sight.masks) if thing in things})
        return found

    def _mistaken(self, moves: list[Move], seen: Seen) -> list[Move]:
        """The moves with the profile's mistake in them: the same for the same look."""
        rng = np.random.default_rng([self.profile.seed, zlib.crc32(seen.newest.view.hash.encode())])
        if not moves or rng.random() >= self.profile.wrong_plan:
            return moves
        if len(moves) > 1 and rng.random() < SWAPS:
            return [moves[1], moves[0], *moves[2:]]
        return moves[:-1]

    def taken_for(self, name: str, seen: Seen) -> str:
        """What is taken for a thing by a planner that is shown no picture: another one as often as the profile says, the same for the same look."""
        rng = np.random.default_rng([self.profile.seed, zlib.crc32(f"{seen.newest.view.hash}|{name}".encode())])
        others = [one for one in seen.names if one != name]
        if not others or rng.random() >= self.profile.wrong_thing:
            return name
        return others[int(rng.integers(len(others)))]

    def things(self, seen: Seen) -> Mapping[str, TrueThing]:
        """Everything on the table, in the state of the newest look."""
        known = seen.newest.things
        return known if len(known) else self.truth.things()

    def meaning(
        self, target: Target, seen: Seen, examples: Sequence[ShownSlot], at: Box | None = None
    ) -> Meaning | None:
        """What a target means; None when its words mean nothing here, or a picture that it is like is not true.

        `at` is where the question points [picture px]; it decides between things that fit another's words alike.
        """
        if not self.slots_true(examples):
            return None
        shown = {slot.name for slot in examples}
        own = next((found for plan in self.plans(seen) if (found := plan.meant_by(target)) is not None), None)
        if own is not None:
            return own if set(own.slots) <= shown else None
        pictures = {slot.name: [self.eyes.see(picture) for picture in slot.pictures] for slot in examples}
        sighted = {name: [one for one in found if one is not None] for name, found in pictures.items()}
        tables = frozenset(slot.name for slot in examples if slot.kind != "object")
        return meaning_of(target, seen, self.things(seen), sighted, tables, at)

    def turn_of(self, target: Target) -> float | None:
        """How far the right plan of the newest look turns one of its targets [degrees clockwise]; None when it moves it not."""
        right = None if self._plans is None else self._plans[2]
        meant = None if right is None else right.meant_by(target)
        if right is None or meant is None:
            return None
        turns = [step["rotate_deg"] for step in right.steps if "pick" in step and right.meanings[step["pick"]] is meant]
        return float(turns[0]) if turns else None

    def see(self, picture: Picture) -> Seen | None:
        """What a picture shows; None when it is not true."""
        return self.eyes.see(picture)
