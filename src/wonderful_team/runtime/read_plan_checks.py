"""What must hold of a plan that was read beforehand, beside what the gate checks of every plan."""

from __future__ import annotations

import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.values import GateCheck, Instruction, Observation, ReadPlan, View
from wonderful_team.images import CHANGED, region_change

CAMERA_PX = 2.0
"""Most that a point of the plan may be seen elsewhere by the camera of now [px]: about what a good calibration leaves."""


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
    name, limit = "instruction of the plan", f"{wanted.plain_text[:200]!r}, the instruction of this run"
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
