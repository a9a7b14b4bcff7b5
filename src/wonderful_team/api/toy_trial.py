"""One question about the toy table in a study: where the circle is, or whether a box is good."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

from wonderful_team.api.method import Method, team_config
from wonderful_team.api.photo_trial import located
from wonderful_team.api.trial_setup import UsageCounter, fingerprint, prepared
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import GroundedTarget, Target, Usage
from wonderful_team.errors import BudgetReached, ConfigError, ModelUnavailableError, WonderfulTeamError
from wonderful_team.evals.toy import BOXCHECK, score_point, score_verdict
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialSpec
from wonderful_team.lab.toy import BOX_KINDS, RADIUS_PX, RIGHT, BoxKind, ToyTable, checker_request
from wonderful_team.models.client import ModelClient
from wonderful_team.planning import TeamConfig
from wonderful_team.planning.ground_only import find
from wonderful_team.registry.role_models import choice_of
from wonderful_team.runtime.loop import Caller


def run_toy(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Ask a method one question about a toy table.

    Raises:
        ConfigError: A method that answers no such question, or a task that there is not.
    """
    started = time.monotonic()
    table, count = ToyTable(spec.seed), UsageCounter()
    method = prepared(spec, settings, choice_of(spec.condition.model), table)
    config = team_config(spec.condition.method, settings.prompts)
    client = method.client(count) if config is not None else None
    with Caller() as caller:
        try:
            if spec.task.startswith(BOXCHECK):
                kind = _kind(spec.task)
                box = table.box(kind)
                if client is not None:
                    said = str(caller.wait_for(client.ask(checker_request(table, box))).value.decision)
                else:
                    said = caller.wait_for(
                        _offered(method.policy(count), "judge")(table.observe(), table.target.words, box)
                    )
                result = score_verdict(said, RIGHT[kind])
            elif client is not None and config is not None:
                item = _grounded(caller, client, config, table, method)
                result = score_point(_middle(item), table.target.centre, RADIUS_PX, _rounds(item))
            else:
                policy = method.policy(count)
                found = caller.wait_for(_offered(policy, "locate")(table.observe(), [table.target.words]))
                place = located(found[0], method.name)
                point = place.point or (None if place.box is None else place.box.centre)
                result = score_point(point, table.target.centre, RADIUS_PX)
        except (ConfigError, ModelUnavailableError):
            raise
        except WonderfulTeamError as error:
            result = TrialRow("failure", error.stage or "grounding", str(error))
    by_role = count.by_role if client is None else client.budget.by_role
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
        instruction=table.target.words,
        versions=fingerprint(spec, settings.extra),
    )


def _kind(task: str) -> BoxKind:
    kind = task.removeprefix(BOXCHECK)
    if kind not in BOX_KINDS:
        raise ConfigError(f"task {task!r}: valid are {', '.join(BOXCHECK + one for one in BOX_KINDS)}")
    return kind


def _offered(policy: Any, name: str) -> Any:
    """What a rival or a user's method has for such a question.

    Raises:
        ConfigError: It has none.
    """
    if not callable(getattr(policy, name, None)):
        forms = {"locate": "locate(observation, words)", "judge": "judge(observation, words, box)"}
        raise ConfigError(
            f"method {policy.name!r} needs {forms[name]} for this suite; point, point:axes and the team's methods have it"
        )
    return getattr(policy, name)


def _grounded(
    caller: Caller, client: ModelClient, config: TeamConfig, table: ToyTable, method: Method
) -> GroundedTarget | None:
    detector = method.make_detector() if config.grounding == "detector" else None
    target = Target("T1", "object", table.target.words)
    plan = caller.wait_for(find(client, config, table.observe(), table.instruction, [target], detector))
    if plan.status == "budget":
        raise BudgetReached(plan.message)
    found: GroundedTarget | None = plan.grounded.get("T1")
    return found


def _middle(item: GroundedTarget | None) -> Point | None:
    """Where the team would act."""
    if item is None or item.status != "found":
        return None
    return next(iter(item.points.values()), None) or (None if item.box is None else item.box.centre)


def _rounds(item: GroundedTarget | None) -> list[Point]:
    """The middles of the boxes as they became: first as it was given, then after every change of the Mover that was kept."""
    boxes = [] if item is None else [event.box for event in item.history if event.box is not None]
    middles: list[Point] = []
    for box in boxes:
        if not middles or middles[-1] != box.centre:
            middles.append(box.centre)
    return middles
