"""One trial of a study: names become a method, a model and a world; it is run, scored and counted.

`wonderful_team.evals` knows protocols only; it is handed `run_trial`.
"""

from __future__ import annotations

import contextlib
import hashlib
import shutil
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from wonderful_team import registry
from wonderful_team.api.judgements import Judgements
from wonderful_team.api.method import Method
from wonderful_team.api.photo_trial import run_photo
from wonderful_team.api.rollout import rollout_in_world
from wonderful_team.api.set_trial import run_set
from wonderful_team.api.toy_trial import run_toy
from wonderful_team.api.trial_setup import UsageCounter, fingerprint, method_options, prepared
from wonderful_team.core.deadline import limited
from wonderful_team.core.filesystem import make_private_folder
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.protocols import Policy, SubgoalTruth, World, offers, privileged
from wonderful_team.core.values import Instruction, Observation, Trial, Usage, View
from wonderful_team.errors import ConfigError
from wonderful_team.evals.controls import CONTROLS, make_control
from wonderful_team.evals.perturb import WorldInDisguise, perturbed, read_tier
from wonderful_team.evals.photos import SET
from wonderful_team.evals.toy import is_toy
from wonderful_team.evals.trials import VALID_SUBGOAL, Condition, RunSettings, TrialRow, TrialSpec
from wonderful_team.record.run_folders import TRIALS
from wonderful_team.registry.files import check_names_no_code, is_file_name
from wonderful_team.registry.role_models import REST, choice_of
from wonderful_team.runtime import rollout as roll_out
from wonderful_team.runtime.user_code import GuardedWorld


def run_trial(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Run one trial of a study in this process; a `TrialRunner`."""
    check_code(spec, settings)
    with limited(settings.caps.seconds, apart=True):
        return _trial(spec, settings)


def _trial(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    if spec.task.startswith(SET):
        return run_set(spec, settings)
    if spec.task.endswith(".json"):
        return run_photo(spec, settings)
    if is_toy(spec.task):
        return run_toy(spec, settings)
    started = time.monotonic()
    world = make_scene(spec)
    try:
        count, judgements = UsageCounter(), Judgements(world)
        trial, page = _run(spec, settings, world, count, judgements)
        usage = trial.usage if trial.usage_by_role else sum(count.by_role.values(), Usage())
        by_role = trial.usage_by_role or count.by_role
        return TrialRow(
            outcome=trial.outcome,
            stage=trial.stage,
            reason="; ".join((trial.reason, *getattr(trial, "unwritten", ()))),
            calls=usage.calls,
            tokens=usage.tokens,
            pictures=usage.pictures,
            usd=usage.usd,
            seconds=time.monotonic() - started,
            rounds=count.rounds,
            provenance=tuple(sorted({*count.provenance, *trial.provenance})),
            by_role={role: to_jsonable(one) for role, one in by_role.items()},
            page=page,
            instruction="" if spec.condition.method in CONTROLS else world.instruction.plain_text,
            versions=fingerprint(spec, settings.extra),
            facts=_facts(world) | judgements.facts if trial.outcome in ("success", "failure") else {},
        )
    finally:
        with contextlib.suppress(Exception):
            GuardedWorld(world).close()


def _facts(world: World) -> dict[str, float]:
    """How far a trial came, where its simulator says it; asked after the trial, as its score is."""
    truth = privileged(world)
    return {VALID_SUBGOAL: float(truth.subgoals_reached() > 0)} if offers(truth, SubgoalTruth) else {}


def code_of_names(names: Iterable[str], models: Iterable[str]) -> frozenset[str]:
    """Those of tasks and methods, and of models (one or by role), that are FILE.py:NAME."""
    chosen = [choice_of(model) for model in models]
    single = [name for one in chosen for name in ([one] if isinstance(one, str) else one.values())]
    return frozenset(name for name in (*names, *single) if is_file_name(name))


def check_code(spec: TrialSpec, settings: RunSettings) -> None:
    """Whether a trial names only code that the caller named: what a store's file says never runs by itself.

    Raises:
        ConfigError: It names other code.
    """
    if settings.named_code is None:
        return
    condition = spec.condition
    for name in sorted(code_of_names((spec.task, condition.method), (condition.model,)) - settings.named_code):
        check_names_no_code(name, "the store")


class BlankWorld(WorldInDisguise):
    """A world for policies that never look: the same blank picture at every look, and no drawing."""

    def __init__(self, world: World) -> None:
        super().__init__(world, Instruction("(not looked at)"))
        self._blank = Observation({"top": View("blank", "blank", 0.0, np.zeros((8, 8, 3), np.uint8))})

    def observe(self) -> Observation:
        return self._blank


def make_scene(spec: TrialSpec) -> World:
    """The world of a trial, in the harder tier that the condition says: made by its simulator where that can."""
    tier = spec.condition.perturb
    if not tier:
        return registry.make_world(spec.task, spec.seed)
    kind, level = read_tier(tier)
    if kind in registry.own_tiers(spec.task):
        return registry.make_world(spec.task, spec.seed, tiers={kind: level})
    return perturbed(registry.make_world(spec.task, spec.seed), tier, spec.seed)


def _run(
    spec: TrialSpec, settings: RunSettings, world: World, count: UsageCounter, judgements: Judgements
) -> tuple[Trial, str]:
    truth = privileged(world)
    condition = spec.condition
    if condition.method in CONTROLS:
        control = make_control(condition.method, spec.seed, truth)
        # Controls do not look: nothing is drawn for them.
        blind = BlankWorld(world)
        trial = roll_out(control, blind, scorer=truth, seed=spec.seed, scene=spec.scene, max_age_s=None)
        return trial, ""
    method = prepared(spec, settings, models_of(condition, world), world)
    if settings.record == "none":
        policy: Policy = method.policy(count)
        trial = roll_out(
            policy,
            world,
            scorer=truth,
            seed=spec.seed,
            scene=spec.scene,
            replans=condition.replans,
            reobserve=condition.reobserve,
            subscribers=(judgements,),
            max_age_s=None,
        )
        return trial, ""
    # A folder of its own: trials that run at the same time must not share the pointer to the newest run.
    out = (settings.out or Path("runs")) / TRIALS / hashlib.sha256(spec.key.encode()).hexdigest()[:12]
    # Known before anything is spent: a place that cannot be written to.
    make_private_folder(out)
    failures = settings.record == "failures"
    recorded = rollout_in_world(
        method,
        world,
        replans=condition.replans,
        reobserve=condition.reobserve,
        seed=spec.seed,
        scene=spec.scene,
        out=out,
        subscribers=(count, judgements),
        # With a limit on time there would be none left at its end to write what happened.
        unless_success=failures and settings.caps.seconds is None,
    )
    if failures and recorded.outcome == "success":
        shutil.rmtree(out, ignore_errors=True)
        return recorded, ""
    return recorded, "" if recorded.page is None else str(recorded.page)


def models_of(condition: Condition, world: World) -> Any:
    """One model, or models by role, as a condition names them; truth in the place of what is isolated away."""
    chosen, grounding = choice_of(condition.model), registry.grounding_roles(condition.method)
    if isinstance(chosen, str):
        return model_of(chosen, condition.isolate, world, grounding)
    if not condition.isolate:
        return chosen
    looked_at = condition.isolate == "grounding"
    own = {role: name for role, name in chosen.items() if role != REST and (role in grounding) == looked_at}
    return {**model_of(chosen[REST], condition.isolate, world, grounding), **own}


TRUTH_MODEL = "simulated:perfect"


def model_of(model: str, isolate: str, world: World, grounding: Sequence[str]) -> Any:
    """The model of a condition; `isolate` lets truth answer for the roles that are not looked at: `grounding` are the method's that find
    targets, the others plan.

    Raises:
        ConfigError: Truth cannot answer for this world.
    """
    if not isolate:
        return model
    truth = registry.make_model(TRUTH_MODEL, world=world)
    if isolate == "planning":
        return {**dict.fromkeys(grounding, truth), "*": model}
    return {**dict.fromkeys(grounding, model), "*": truth}


def check_isolation(isolate: str, methods: Sequence[str] = ()) -> None:
    """Whether this part of these methods can be isolated.

    Raises:
        ConfigError: Another word, truth would have to ground where a detector does, or a method that does not ask as one role
            where things are and as another what to do.
    """
    rows = {name: row for name in methods if (row := registry.method_row(name)) is not None}
    looking = [name for name, row in rows.items() if row.detects]
    if isolate == "planning" and looking:
        raise ConfigError(
            f"--isolate planning lets truth ground, and in {looking[0]!r} a detector does: leave one of them out"
        )
    if isolate not in ("planning", "grounding"):
        raise ConfigError(f"--isolate {isolate!r}: valid are planning (truth grounds), grounding (truth plans)")
    for name in rows:
        if not _has_parts(name):
            roles = ", ".join(registry.roles_of(name)) or "none"
            valid = ", ".join(one for one in registry.METHODS if _has_parts(one) and not one.startswith("team:"))
            raise ConfigError(
                f"--isolate {isolate}: method {name!r} does not ask as one role where things are and as another what to do "
                f"(its roles: {roles}), so no part of it can be told the truth alone; valid: {valid}, and the team without members"
            )


def _has_parts(method: str) -> bool:
    grounding, roles = registry.grounding_roles(method), registry.roles_of(method)
    return bool(grounding) and set(grounding) != set(roles)


def check_names(
    methods: Sequence[str], models: Sequence[str], asked: Mapping[str, Any], max_tokens: int | None = None
) -> None:
    """Every name means something, before anything is run.

    Args:
        methods: Names.
        models: Names, or texts of several by role.
        asked: Options of the models, as `Method` takes them.
        max_tokens: The cap that bounds what models of unknown price may cost.

    Raises:
        ConfigError: A name that does not.
    """
    for method in methods:
        if method in CONTROLS:
            continue
        for model in models:
            Method(
                **method_options(asked, method), model=choice_of(model), method=method, max_tokens=max_tokens
            ).policy()
