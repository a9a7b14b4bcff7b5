"""One photo of a study: a method says where things are, and its boxes are compared with the true ones."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, cast

from wonderful_team.api.method import team_config
from wonderful_team.api.observation import Observation
from wonderful_team.api.trial_setup import UsageCounter, fingerprint, prepared
from wonderful_team.core.filesystem import make_private_folder, write_private
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Picture, Point, PointMark
from wonderful_team.core.protocols import World
from wonderful_team.core.values import GroundedTarget, Instruction, Target, Usage
from wonderful_team.core.values import Observation as SeenObservation
from wonderful_team.errors import (
    BudgetReached,
    ConfigError,
    FileNotWrittenError,
    ModelUnavailableError,
    WonderfulTeamError,
)
from wonderful_team.evals.photos import Located, read_photos, score_photo
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialSpec
from wonderful_team.images import to_png, whole
from wonderful_team.images.drawn import drawn
from wonderful_team.models.client import ModelClient
from wonderful_team.planning.ground_only import find
from wonderful_team.record.run_folders import TRIALS
from wonderful_team.registry.role_models import choice_of
from wonderful_team.runtime.loop import Caller


def run_photo(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Ask a method where everything in one photo is.

    Raises:
        ConfigError: An own method without `locate(observation, words)`.
    """
    scene = read_photos(spec.task)[spec.seed]
    words = [asked.words for asked in scene.asked]
    seen = Observation.from_files(scene.picture)
    with Looking(spec, settings, words) as looking:

        def judged() -> TrialRow:
            by_team = looking.config is not None
            found = [_of_team(item) for item in looking.by_team(seen)] if by_team else looking.by_own(seen)
            true = [BoxMark(asked.box, "after", "true") for asked in scene.asked]
            said = [mark for one in found for mark in _marks(one)]
            looking.show(whole(seen.main, "photo"), *true, *said)
            return score_photo(scene, found)

        return looking.row(judged)


class Looking:
    """A method at work on things that are only looked at: it says where they are, and nothing moves.

    Args:
        words: What is asked for.
        world: Whose truth a simulated model answers from.

    Attributes:
        config: How the team works; None for every other method.
    """

    def __init__(
        self, spec: TrialSpec, settings: RunSettings, words: Sequence[str], world: World | None = None
    ) -> None:
        self._started = time.monotonic()
        self._spec, self._settings, self._words = spec, settings, list(words)
        self._count = UsageCounter()
        self.method = prepared(spec, settings, choice_of(spec.condition.model), world)
        thorough = bool(settings.extra.get("thorough"))
        self.config = team_config(spec.condition.method, settings.prompts, thorough=thorough)
        self._shown: Picture | None = None
        self._client = None if self.config is None else self.method.client(self._count)
        self._caller = Caller()

    def __enter__(self) -> Looking:
        self._caller.__enter__()
        return self

    def __exit__(self, *about: Any) -> None:
        self._caller.__exit__(*about)

    def wait_for(self, result: Any) -> Any:
        """The result of a plain or an async call."""
        return self._caller.wait_for(result)

    @property
    def client(self) -> ModelClient:
        """Where the team asks its models."""
        assert self._client is not None  # asked for where there is a team
        return self._client

    def by_team(self, seen: SeenObservation, kind: Literal["object", "area"] = "object") -> list[GroundedTarget | None]:
        """What the team says of each thing, or of each place to put something.

        Raises:
            BudgetReached: A cap was met.
        """
        assert self.config is not None
        targets = [Target(f"T{number}", kind, text) for number, text in enumerate(self._words, start=1)]
        asked = Instruction("Find: " + "; ".join(self._words))
        detector = self.method.make_detector() if self.config.grounding == "detector" else None
        plan = self.wait_for(find(self.client, self.config, seen, asked, targets, detector))
        if plan.status == "budget":
            raise BudgetReached(plan.message)
        return [plan.grounded.get(target.id) for target in targets]

    def by_own(self, seen: SeenObservation) -> list[Located]:
        """What a rival or a user's method says of each thing.

        Raises:
            ConfigError: It has no `locate(observation, words)`, or answers with something else.
        """
        forms = "for each a box (x0, y0, x1, y1), a point (x, y) in pixels of the photo, or None"
        answers = list(self.wait_for(self.offered("locate(observation, words)", forms)(seen, list(self._words))))
        if len(answers) != len(self._words):
            raise ConfigError(
                f"method {self.method.name!r}: locate gave {len(answers)} answers to {len(self._words)} descriptions"
            )
        return [_located(answer, self.method.name) for answer in answers]

    def offered(self, form: str, gives: str) -> Callable[..., Any]:
        """What a rival or a user's method has for such a question.

        Raises:
            ConfigError: It has none.
        """
        policy = self.method.policy(self._count)
        found = getattr(policy, form.partition("(")[0], None)
        if not callable(found):
            raise ConfigError(f"method {self.method.name!r} needs {form}: {gives}")
        return cast(Callable[..., Any], found)

    def show(self, picture: Picture, *marks: BoxMark | PointMark) -> None:
        """What a picture of the hit or the miss shows: marks in pixels of the view."""
        self._shown = picture.marked(*(_in_picture(mark, picture) for mark in marks))

    def _with_picture(self, result: TrialRow) -> TrialRow:
        """The trial with that picture, where the study keeps records of such an outcome; a picture that cannot be written costs no result."""
        record = self._settings.record
        if self._shown is None or record == "none" or (record == "failures" and result.outcome == "success"):
            return result
        name = hashlib.sha256(self._spec.key.encode()).hexdigest()[:12]
        path = (self._settings.out or Path("runs")) / TRIALS / name / "final.png"
        try:
            make_private_folder(path.parent)
            write_private(path, to_png(drawn(self._shown)))
        except FileNotWrittenError as error:
            return replace(result, reason=f"{result.reason}; {error}")
        return replace(result, page=str(path))

    def row(self, judge: Callable[[], TrialRow]) -> TrialRow:
        """The trial; what ends a method without an answer is its failure, at the stage it names.

        Raises:
            ConfigError: Wrong use.
            ModelUnavailableError: The provider did not answer: an error, not the method's failure.
        """
        try:
            result = judge()
        except (ConfigError, ModelUnavailableError):
            raise
        except WonderfulTeamError as error:
            result = TrialRow("failure", error.stage or "grounding", str(error))
        result = self._with_picture(result)
        by_role = self._count.by_role if self._client is None else self._client.budget.by_role
        usage = sum(by_role.values(), Usage())
        return replace(
            result,
            calls=usage.calls,
            tokens=usage.tokens,
            pictures=usage.pictures,
            usd=usage.usd,
            seconds=time.monotonic() - self._started,
            rounds=self._count.rounds,
            provenance=tuple(sorted(self._count.provenance)),
            instruction="; ".join(self._words),
            versions=fingerprint(self._spec, self._settings.extra),
        )


def point_marks(said: Point | None, centre: Point, radius_px: float) -> tuple[BoxMark | PointMark, ...]:
    """What a picture of a hit or a miss shows: the circle as a box, and what was said."""
    x, y = centre
    true = BoxMark(Box(x - radius_px, y - radius_px, x + radius_px, y + radius_px), "after", "true")
    return (true,) if said is None else (true, PointMark(said, "said"))


def middle_of(item: GroundedTarget | None) -> Point | None:
    """Where the team would act."""
    if item is None or item.status != "found":
        return None
    return next(iter(item.points.values()), None) or (None if item.box is None else item.box.centre)


def _of_team(item: GroundedTarget | None) -> Located:
    if item is None or item.status != "found":
        return Located()
    return Located(item.box, next(iter(item.points.values()), None))


def _in_picture(mark: BoxMark | PointMark, picture: Picture) -> BoxMark | PointMark:
    """A mark given in pixels of the view."""
    if isinstance(mark, BoxMark):
        return replace(mark, box=picture.frame.box_to_picture(mark.box))
    return replace(mark, point=picture.frame.point_to_picture(mark.point))


def _marks(one: Located) -> list[BoxMark | PointMark]:
    box = [] if one.box is None else [BoxMark(one.box, "target", "said")]
    return [*box, *([] if one.point is None else [PointMark(one.point, "" if one.box else "said")])]


def _located(answer: Any, name: str) -> Located:
    if answer is None:
        return Located()
    numbers = tuple(float(value) for value in (answer.as_tuple if isinstance(answer, Box) else answer))
    if len(numbers) == 4:
        return Located(Box(*numbers))
    if len(numbers) == 2:
        return Located(None, (numbers[0], numbers[1]))
    raise ConfigError(f"method {name!r}: locate gave {numbers}; valid are 4 numbers (a box), 2 (a point) or None")
