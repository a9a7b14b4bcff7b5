"""A plan that was read beforehand, with what it was made from: its picture, its page, and when."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from wonderful_team.errors import ConfigError
from wonderful_team.geometry import Box
from wonderful_team.images import CHANGED, load_picture, region_change
from wonderful_team.runtime.approval import file_hash
from wonderful_team.runtime.plan_file import read_plan
from wonderful_team.runtime.stored import stored_observation
from wonderful_team.types import GateCheck, Instruction, Observation, Plan, View

CAMERA_PX = 2.0
"""Most that a point of the plan may be seen elsewhere by the camera of now [px]: about what a good calibration leaves."""


@dataclass(frozen=True, eq=False)
class ReadPlan:
    """A plan that was read: it runs as it is, or nothing moves.

    Attributes:
        plan: What was read.
        observation: The picture that it was made from; without it the scene must be the same pixel for pixel.
        page: The page that was read; None without one.
        same_clock: The picture's time was told by the clock of the world in which it is going to run. The clock of an
            earlier run says nothing of now: then the regions that the plan relies on decide, whatever the time.
    """

    plan: Plan
    observation: Observation | None = None
    page: Path | None = None
    same_clock: bool = True

    @property
    def page_hash(self) -> str:
        """SHA-256 of the page; "" without one."""
        return file_hash(self.page)


def read_run_plan(folder: Path) -> ReadPlan:
    """The plan of a recorded run, with the picture it was made from where the folder holds it unchanged.

    Raises:
        ConfigError: The folder holds no plan of ours, or its record cannot be read.
    """
    folder = Path(folder)
    plan = read_plan(folder)
    page = folder / "page.html"
    return ReadPlan(plan, read_plan_scene(folder, plan), page if page.is_file() else None, same_clock=False)


def read_plan_scene(folder: Path, plan: Plan) -> Observation | None:
    """The observation that `plan` was made from, as its run folder keeps it.

    Returns:
        None when the folder does not hold that picture, unchanged.

    Raises:
        ConfigError: The folder's record cannot be read.
    """
    file = Path(folder) / "record.json"
    try:
        record: Any = json.loads(file.read_text(encoding="utf-8"))
        named = [seen["hash"] for seen in record["planner"]["observations"]]
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise ConfigError(f"{file}: cannot be read: {error}") from error
    for number, name in enumerate(named):
        if name == plan.scene_hash:
            observation = _stored(Path(folder), record, number)
            return observation if observation is not None and observation.is_called(plan.scene_hash) else None
    return None


def _stored(folder: Path, record: Any, number: int) -> Observation | None:
    """With camera and depth where the record keeps them, else the pixels alone."""
    try:
        return stored_observation(folder, record, number)
    except (ConfigError, KeyError, TypeError, ValueError):
        pass
    try:
        seen = record["planner"]["observations"][number]
        pictures = {name: load_picture(folder / record["files"][key]) for name, key in seen["views"].items()}
        return Observation({name: View(name, name, 0.0, rgb) for name, rgb in pictures.items()})
    except (ConfigError, KeyError, TypeError, ValueError):
        return None


def read_plan_checks(read: ReadPlan, wanted: Instruction, now: Observation, strict: bool) -> list[GateCheck]:
    """What must hold of a plan that was read, beside what the gate checks of every plan.

    Args:
        read: The plan.
        wanted: The instruction of the world in which it is going to run.
        now: The scene just before motion.
        strict: Refuse a plan that Verification did not approve.
    """
    plan = read.plan
    checks = [
        GateCheck(None, "status of the plan", plan.status == "planned", plan.status[:40], "planned"),
        _same_instruction(plan.instruction, wanted),
        *_camera_checks(read, now),
    ]
    if strict:
        said = "approved" if plan.verified else "not approved"
        checks.append(GateCheck(None, "Verification (strict)", plan.verified, said, "approved"))
    return checks


def _same_instruction(planned: Instruction, wanted: Instruction) -> GateCheck:
    name, limit = "instruction of the plan", f"as asked for: {wanted.plain_text[:200]!r}"
    if planned.text != wanted.text:
        return GateCheck(None, name, False, repr(planned.plain_text[:200]), limit)
    for slot in dict.fromkeys((*planned.slots, *wanted.slots)):
        ours, theirs = planned.slots.get(slot), wanted.slots.get(slot)
        if ours is None or theirs is None or list(ours.views) != list(theirs.views):
            return GateCheck(None, name, False, f"other pictures for {slot!r}", limit)
        if not all(_same_picture(ours.views[key], theirs.views[key]) for key in ours.views):
            return GateCheck(None, name, False, f"another picture for {slot!r}", limit)
    return GateCheck(None, name, True, "the same words and pictures", limit)


def _camera_checks(read: ReadPlan, now: Observation) -> list[GateCheck]:
    """The plan's metres mean the same pixels to the camera of the plan and to the one of now."""
    then = None if read.observation is None else read.observation.main.camera
    points = [s.position_m for planned in read.plan.actions for s in planned.sources if s.position_m is not None]
    if then is None or now.main.camera is None or not points:
        return []
    limit = f"at most {CAMERA_PX:g} px"
    try:
        apart = np.abs(then.project(np.array(points)) - now.main.camera.project(np.array(points)))
    except ValueError as error:
        return [GateCheck(None, "camera of the plan", False, str(error)[:80], limit)]
    most = float(apart.max())
    ok = bool(np.isfinite(apart).all()) and most <= CAMERA_PX
    value = f"the plan's points lie {most:.1f} px apart in both cameras"
    return [GateCheck(None, "camera of the plan", ok, value, limit, f"{CAMERA_PX - most:+.1f} px")]


def _same_picture(one: View, other: View) -> bool:
    if one.size_px != other.size_px:
        return False
    return one.hash == other.hash or region_change(one.rgb, other.rgb, Box(0, 0, *one.size_px)) < CHANGED
