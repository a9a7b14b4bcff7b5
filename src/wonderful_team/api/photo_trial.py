"""One photo of a study: a method says where things are, and its boxes are compared with the true ones."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from wonderful_team.api.method import Method, team_config
from wonderful_team.api.observation import Observation
from wonderful_team.api.trial_setup import UsageCounter, fingerprint, prepared
from wonderful_team.core.geometry import Box
from wonderful_team.core.protocols import Detector
from wonderful_team.core.values import GroundedTarget, Instruction, Target, Usage
from wonderful_team.errors import BudgetReached, ConfigError, ModelUnavailableError, WonderfulTeamError
from wonderful_team.evals.photos import Located, PhotoScene, read_photos, score_photo
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialSpec
from wonderful_team.models.client import ModelClient
from wonderful_team.planning import TeamConfig
from wonderful_team.planning.ground_only import find
from wonderful_team.registry.role_models import choice_of
from wonderful_team.runtime.loop import Caller


def run_photo(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Ask a method where everything in one photo is.

    Raises:
        ConfigError: An own method without `locate(observation, words)`.
    """
    started = time.monotonic()
    scene = read_photos(spec.task)[spec.seed]
    words = [asked.words for asked in scene.asked]
    seen, count = Observation.from_files(scene.picture), UsageCounter()
    method = prepared(spec, settings, choice_of(spec.condition.model))
    config = team_config(spec.condition.method, settings.prompts, thorough=bool(settings.extra.get("thorough")))
    by_role = count.by_role
    with Caller() as caller:
        if config is None:
            result = _judged(scene, lambda: _by_own(caller, method, count, seen, words))
        else:
            client = method.client(count)
            detector = method.make_detector() if config.grounding == "detector" else None
            result = _judged(scene, lambda: _by_team(caller, client, config, seen, words, detector))
            by_role = client.budget.by_role
    usage = sum(by_role.values(), Usage())
    return replace(
        result,
        calls=usage.calls,
        tokens=usage.tokens,
        pictures=usage.pictures,
        usd=usage.usd,
        seconds=time.monotonic() - started,
        rounds=count.rounds,
        provenance=tuple(sorted(count.provenance)),
        instruction="; ".join(words),
        versions=fingerprint(spec, settings.extra),
    )


def _judged(scene: PhotoScene, ask: Callable[[], list[Located]]) -> TrialRow:
    """Where things were said to be, scored; what ends a method without an answer is its failure, at the stage it names.

    Raises:
        ConfigError: Wrong use.
        ModelUnavailableError: The provider did not answer: an error, not the method's failure.
    """
    try:
        return score_photo(scene, ask())
    except (ConfigError, ModelUnavailableError):
        raise
    except WonderfulTeamError as error:
        return TrialRow("failure", error.stage or "grounding", str(error))


def _by_team(
    caller: Caller,
    client: ModelClient,
    config: TeamConfig,
    seen: Observation,
    words: Sequence[str],
    detector: Detector | None,
) -> list[Located]:
    targets = [Target(f"T{number}", "object", text) for number, text in enumerate(words, start=1)]
    asked = Instruction("Find: " + "; ".join(words))
    plan = caller.wait_for(find(client, config, seen, asked, targets, detector))
    if plan.status == "budget":
        raise BudgetReached(plan.message)
    return [_of_team(plan.grounded.get(target.id)) for target in targets]


def _of_team(item: GroundedTarget | None) -> Located:
    if item is None or item.status != "found":
        return Located()
    return Located(item.box, next(iter(item.points.values()), None))


def _by_own(
    caller: Caller, method: Method, count: UsageCounter, seen: Observation, words: Sequence[str]
) -> list[Located]:
    policy: Any = method.policy(count)
    if not callable(getattr(policy, "locate", None)):
        raise ConfigError(
            f"method {method.name!r} needs locate(observation, words): for each a box (x0, y0, x1, y1), a point (x, y) "
            "in pixels of the photo, or None"
        )
    answers = list(caller.wait_for(policy.locate(seen, list(words))))
    if len(answers) != len(words):
        raise ConfigError(f"method {method.name!r}: locate gave {len(answers)} answers to {len(words)} descriptions")
    return [located(answer, method.name) for answer in answers]


def located(answer: Any, name: str) -> Located:
    if answer is None:
        return Located()
    numbers = tuple(float(value) for value in (answer.as_tuple if isinstance(answer, Box) else answer))
    if len(numbers) == 4:
        return Located(Box(*numbers))
    if len(numbers) == 2:
        return Located(None, (numbers[0], numbers[1]))
    raise ConfigError(f"method {name!r}: locate gave {numbers}; valid are 4 numbers (a box), 2 (a point) or None")
