"""`check` of one's own world, task, method, model or detector: names become things, and the right checks are run on them."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np

from wonderful_team import registry
from wonderful_team.api.method import Method
from wonderful_team.api.trial import run_trial
from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.intervals import Rate
from wonderful_team.core.protocols import World, privileged
from wonderful_team.core.text import counted
from wonderful_team.detectors import detect
from wonderful_team.errors import ConfigError, DetectorCodeError, FileNotWrittenError, NotUnderstoodError
from wonderful_team.evals.checking import SEEDS, Findings, check_controls, check_looks, contact_sheet
from wonderful_team.evals.controls import CONTROLS, NO_MODEL
from wonderful_team.evals.trials import Condition, RunSettings, TrialRow, TrialSpec
from wonderful_team.evals.workers import run_safely
from wonderful_team.registry.files import load_from_file
from wonderful_team.runtime.loop import Caller
from wonderful_team.runtime.user_code import GuardedWorld

TRIED_IN = "tabletop/rotate"
"""Where methods, models and detectors are tried."""
LOOKED_FOR = ("red block", "blue block", "yellow block")
"""What a detector is asked for."""


def kind_of(name: str) -> str:
    """What FILE.py:NAME is: world (tasks included), method, model or detector.

    Raises:
        ConfigError: None of them.
    """
    thing = load_from_file(name, "check")
    if inspect.isfunction(thing) and registry.task_made_of(thing) is not None:
        return "world"
    for kind, need in (("world", "observe"), ("method", "decide"), ("model", "answer"), ("detector", "detect")):
        if callable(getattr(thing, need, None)):
            return kind
    raise ConfigError(
        f"{name}: nothing that can be checked; valid: a task made with wonderful_team.task, a world (observe), "
        "a method (decide), a model (answer) or a detector (detect)"
    )


def check(name: str, sheet: Path, seeds: int | None = None) -> Findings:
    """Check FILE.py:NAME; writes the contact sheet of a world.

    Raises:
        ConfigError: It cannot be loaded.
    """
    kind = kind_of(name)
    findings = Findings()
    if kind == "detector":
        _check_detector(name, range(seeds or 1), findings)
    elif kind == "world":
        _check_world(name, sheet, range(seeds or SEEDS), findings)
    else:
        # A model may cost money: one scene unless more are asked for.
        _check_thinking(kind, name, range(seeds or (SEEDS if kind == "method" else 1)), findings)
    return findings


def _check_world(name: str, sheet: Path, seeds: Sequence[int], findings: Findings) -> None:
    def guarded(seed: int) -> World:
        return cast(World, GuardedWorld(registry.make_world(name, seed)))

    tiles = check_looks(guarded, seeds, findings)
    try:
        contact_sheet(tiles, sheet)
        findings.notes.append(f"contact sheet: {sheet}")
    except FileNotWrittenError as error:
        # The checks themselves go on.
        findings.bad.append(f"contact sheet: {error}")
    world = registry.make_world(name, seeds[0])
    try:
        scored = privileged(world) is not None
    finally:
        world.close()
    if not scored:
        findings.notes.append("no truth (an attribute `privileged` with score, truth, oracle): trials stay unscored")
        return
    check_controls({control: _run(name, Condition(control, NO_MODEL), seeds) for control in CONTROLS}, findings)


def _check_detector(name: str, seeds: Sequence[int], findings: Findings) -> None:
    detector = registry.make_detector(name)
    findings.good.append("loads as a detector")
    with Caller() as caller:

        def look(rgb: Array) -> list[tuple[str, Box, float]]:
            found = caller.wait_for(detect(detector, rgb, LOOKED_FOR))
            return [(one.words, one.box, one.score) for one in found]

        try:
            for seed in seeds:
                rgb = _picture(seed)
                first, again = look(rgb), look(rgb)
                findings.notes.append(f"{TRIED_IN}, seed {seed}: {counted(len(first), 'detection')} of {LOOKED_FOR}")
                same = first == again
                findings.add(
                    same, "the same picture gives the same twice", "the same picture gave two different answers"
                )
            empty = look(np.full_like(_picture(seeds[0]), 128))
        except (DetectorCodeError, NotUnderstoodError) as error:
            findings.bad.append(str(error))
            return
    findings.good.append("what it returns are detections that fit the picture and the words")
    findings.add(
        not empty, "it finds nothing in an empty picture", f"it found {len(empty)} in an empty picture: {empty[:3]}"
    )


def _picture(seed: int) -> Array:
    world = registry.make_world(TRIED_IN, seed)
    try:
        return world.observe().main.rgb
    finally:
        world.close()


def _check_thinking(kind: str, name: str, seeds: Sequence[int], findings: Findings) -> None:
    condition = Condition(name, "offline") if kind == "method" else Condition("team", name)
    Method(model=condition.model, method=condition.method).policy()
    findings.good.append(f"loads as a {kind}")
    results = _run(TRIED_IN, condition, seeds)
    broken = [one for one in results if one.outcome == "error"]
    findings.add(
        not broken,
        f"{counted(len(results), 'trial')} in {TRIED_IN} without an error",
        f"{len(broken)} of {counted(len(results), 'trial')} broke: {broken[0].reason if broken else ''}",
    )
    refused = [one for one in results if one.stage == "gate"]
    if refused and len(refused) < len(results):
        # It is there to refuse: a trial is lost by it, as by any other mistake, and nothing is wrong with the code.
        findings.notes.append(
            f"the gate refused a plan in {len(refused)} of {counted(len(results), 'trial')}, such as: {refused[0].reason}"
        )
    else:
        findings.add(
            not refused,
            "the gate admitted its actions",
            f"the gate refused a plan in every trial: {refused[0].reason if refused else ''}",
        )
    scored = [one for one in results if one.outcome in ("success", "failure")]
    won = sum(one.outcome == "success" for one in scored)
    findings.notes.append(
        f"{TRIED_IN}: {Rate(won, len(scored))}, {counted(sum(one.calls for one in results), 'model call')}"
    )
    if kind == "model":
        asked = sum(one.calls for one in results)
        findings.add(asked > 0, f"it answered {counted(asked, 'question')}", "it was asked nothing")
    elif seeds:
        first, again = results[0], _run(TRIED_IN, condition, seeds[:1])[0]
        same = (first.outcome, first.stage) == (again.outcome, again.stage)
        findings.add(
            same, "the same scene ends the same way twice", "the same scene ended in two ways: seed what is random"
        )


def _run(task: str, condition: Condition, seeds: Sequence[int]) -> list[TrialRow]:
    settings: Any = RunSettings(record="none")
    return [run_safely(run_trial, TrialSpec(task, seed, condition), settings) for seed in seeds]
