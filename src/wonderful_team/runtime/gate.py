"""The one safety gate: every action of every policy passes it, simulated or real. All problems are reported at once."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wonderful_team.actions import Action, PickPlace, RotateGripper, Vocabulary
from wonderful_team.geometry import Box, Camera
from wonderful_team.geometry.arrays import Array
from wonderful_team.jsonable import to_jsonable
from wonderful_team.runtime.approval import Approval, Declined, approval_checks, approved_id
from wonderful_team.runtime.freshness import MAX_AGE_S, freshness_checks, watched
from wonderful_team.runtime.keep_out import distance, region_m, region_px, table_height_m
from wonderful_team.runtime.sweep import carry_height_m, swept_path_m, swept_path_px, tool_after
from wonderful_team.types import GateCheck, GateReport, KeepOut, Limits, Observation, Plan, PlannedAction

TOOL_RADIUS_M = 0.01
"""Half-width of what moves [m]: a path may not come nearer than this to a keep-out region; a finger's width."""
TOLERANCE_M = 1e-6
"""Rounding allowed at the workspace's border [m]."""


def check_gate(
    actions: Sequence[PlannedAction],
    *,
    vocabulary: Vocabulary,
    limits: Limits,
    plan: Plan | None,
    then: Observation | None,
    now: Observation,
    approval: Approval | Declined | None = None,
    approval_required: bool = False,
    page: str = "",
    expected_plan_id: str | None = None,
    must_run: bool = False,
    excused: Sequence[Box] = (),
    max_age_s: float | None = MAX_AGE_S,
    tool_radius_m: float = TOOL_RADIUS_M,
) -> GateReport:
    """Check actions before anything moves.

    Args:
        actions: What is going to run, in order.
        vocabulary: What the world runs.
        limits: What it allows.
        plan: Where the actions come from, or None for a method that acts without one.
        then: The picture that the plan was made from; None when it is not at hand.
        now: The scene just before motion.
        approval: A person's consent, checked whenever it is given.
        approval_required: Refuse without consent.
        page: Hash of the page that shows the plan; a consent must name it.
        expected_plan_id: Id of the plan that was read; another plan is refused.
        must_run: Refuse actions that have no metres; otherwise a plan in pixels is checked in pixels.
        excused: Parts of the main view [px] that the plan's own earlier actions changed.
        max_age_s: Oldest picture that may be acted upon [s]; None for no limit.
        tool_radius_m: Half-width of what moves, kept clear of keep-out regions [m].

    Returns:
        Every check with its value, limit and margin; `admitted` when none failed.
    """
    checks = _plan_checks(actions, plan, expected_plan_id)
    picture = (then or now).hash
    checks += approval_checks(approved_id(plan, actions), picture, page, approval, approval_required)
    regions = (*limits.keep_out, *(plan.keep_out if plan is not None else ()))
    tool_m = now.robot.tool_m if now.robot is not None else None
    for index, planned in enumerate(actions):
        found = [_word_check(planned, vocabulary)]
        if planned.action is None:
            found += _pixel_checks(planned, now, regions, limits, must_run)
        else:
            found += _metre_checks(planned.action, now.main.camera, regions, limits, tool_m, tool_radius_m)
            if now.main.camera is None:
                found += _pixel_regions(planned, regions)
            tool_m = tool_after(planned.action, tool_m)
        checks += [replace(check, action=index) for check in found]
    checks += freshness_checks(
        then,
        now,
        watched(actions, plan, now.main) if then is not None else (),
        scene_hash=plan.scene_hash if plan is not None else None,
        excused=excused,
        max_age_s=max_age_s,
    )
    return GateReport(tuple(checks))


def _plan_checks(actions: Sequence[PlannedAction], plan: Plan | None, expected_id: str | None) -> list[GateCheck]:
    checks = []
    if expected_id is not None:
        have = plan.id if plan is not None else "no plan"
        value, limit = f"plan {have[:12]}", f"plan {expected_id[:12]}"
        checks.append(GateCheck(None, "plan that was read", have == expected_id, value, limit))
    if plan is not None:
        ours, theirs = _texts(actions), _texts(plan.actions)
        same = ours == theirs
        value = f"{len(actions)} action{'s' * (len(actions) != 1)}" + ("" if same else ", not those of the plan")
        checks.append(GateCheck(None, "actions of the plan", same, value, f"the {len(theirs)} of plan {plan.id[:12]}"))
    if not actions:
        checks.append(GateCheck(None, "actions", False, "0", "at least 1"))
    return checks


def _texts(actions: Sequence[PlannedAction]) -> list[str]:
    return [json.dumps(to_jsonable((planned.step, planned.action)), sort_keys=True) for planned in actions]


def _word_check(planned: PlannedAction, vocabulary: Vocabulary) -> GateCheck:
    if planned.action is None:
        kind, valid = planned.step.kind, vocabulary.step_kinds
    else:
        kind, valid = planned.action.kind, vocabulary.kinds
    return GateCheck(None, "vocabulary", kind in valid, kind, ", ".join(valid))


def _metre_checks(
    action: Action,
    camera: Camera | None,
    regions: Sequence[KeepOut],
    limits: Limits,
    tool_m: Array | None,
    tool_radius_m: float,
) -> list[GateCheck]:
    path = swept_path_m(action, limits, tool_m)
    checks = [_finite_check(action, path)]
    if path is None or not checks[0].ok:
        return checks
    # The way from where the tool stands is the world's own doing: only what the action asks for must lie inside.
    asked = path[1:] if tool_m is not None and len(path) > 1 and action.kind in ("move_to", "trajectory") else path
    checks += [_axis_check(asked, axis, limits) for axis in range(2)]
    if action.kind != "navigate":
        checks.append(_axis_check(asked, 2, limits))
    if isinstance(action, PickPlace):
        checks.append(_carry_check(action, limits))
    for region in regions:
        shape = region_m(region, camera, table_height_m(limits))
        if shape is None and camera is not None:
            checks.append(GateCheck(None, f"keep-out {region.name}", False, "meets no table", "a region on the table"))
        elif shape is not None:
            gap = distance(path, shape)
            ok = gap > 0.0 and gap >= tool_radius_m
            value = "enters it" if gap == 0 else f"{gap:.3f} m away"
            limit = f"at least {tool_radius_m:.3f} m"
            checks.append(GateCheck(None, f"keep-out {region.name}", ok, value, limit, f"{gap - tool_radius_m:+.3f} m"))
    return checks


def _finite_check(action: Action, path: Array | None) -> GateCheck:
    numbers = [] if path is None else [path.ravel()]
    numbers += [np.array([action.yaw_rad])] if isinstance(action, PickPlace | RotateGripper) else []
    flat = np.concatenate(numbers) if numbers else np.zeros(0)
    bad = int((~np.isfinite(flat)).sum())
    value = f"{len(flat) - bad} of {len(flat)} finite"
    return GateCheck(None, "numbers", bad == 0, value, "all finite")


def _axis_check(path: Array, axis: int, limits: Limits) -> GateCheck:
    low, high = limits.low_m[axis], limits.high_m[axis]
    values = path[:, axis]
    least, most = float(values.min()), float(values.max())
    margin = min(least - low, high - most)
    shown = f"{least:.3f} m" if least == most else f"{least:.3f} to {most:.3f} m"
    name = "height" if axis == 2 else f"workspace {'xy'[axis]}"
    return GateCheck(None, name, margin >= -TOLERANCE_M, shown, f"[{low:.3f}, {high:.3f}] m", f"{margin:+.3f} m")


def _carry_check(action: PickPlace, limits: Limits) -> GateCheck:
    carry = carry_height_m(action, limits)
    ends = max(action.pick_m[2], action.place_m[2])
    room = float(carry - ends)
    return GateCheck(
        None, "carrying height", room > 0, f"{carry:.3f} m", f"above both ends ({ends:.3f} m)", f"{room:+.3f} m"
    )


def _pixel_checks(
    planned: PlannedAction, now: Observation, regions: Sequence[KeepOut], limits: Limits, must_run: bool
) -> list[GateCheck]:
    checks = [GateCheck(None, "metres", not must_run, "pixels only", "metres from a camera" if must_run else "none")]
    points = np.array(swept_path_px(planned), dtype=np.float64).reshape(-1, 2)
    finite = bool(np.isfinite(points).all())
    checks.append(GateCheck(None, "numbers", finite, f"{len(points)} points", "all finite"))
    if len(points) == 0 or not finite:
        return checks
    width, height = now.main.size_px
    for axis, side in enumerate((width, height)):
        least, most = float(points[:, axis].min()), float(points[:, axis].max())
        margin = min(least, side - most)
        name = f"picture {'xy'[axis]}"
        value = f"{least:.0f} to {most:.0f} px"
        checks.append(GateCheck(None, name, margin >= 0, value, f"[0, {side}] px", f"{margin:+.0f} px"))
    checks += [_region_px_check(points, region, now.main.camera, limits) for region in regions]
    return checks


def _region_px_check(points: Array, region: KeepOut, camera: Camera | None, limits: Limits) -> GateCheck:
    name = f"keep-out {region.name}"
    shape = region_px(region, camera, table_height_m(limits))
    if shape is None:
        return GateCheck(None, name, False, "in metres, but no camera places it", "a region in px, or a camera")
    gap = distance(points, shape)
    return GateCheck(
        None, name, gap > 0, "enters it" if gap == 0 else f"{gap:.0f} px away", "outside", f"{gap:+.0f} px"
    )


def _pixel_regions(planned: PlannedAction, regions: Sequence[KeepOut]) -> list[GateCheck]:
    """Metres without a camera in the main view: regions in pixels are checked against the pixels it came from."""
    points = np.array(swept_path_px(planned), dtype=np.float64)
    checks = []
    for region in regions:
        if region.unit != "px":
            continue
        name = f"keep-out {region.name}"
        if len(points) == 0:
            checks.append(GateCheck(None, name, False, "in pixels, but no camera places it", "a region in metres"))
            continue
        gap = distance(points, region_px(region, None, 0.0))
        value = "enters it" if gap == 0 else f"{gap:.0f} px away"
        checks.append(GateCheck(None, name, gap > 0, value, "outside", f"{gap:+.0f} px"))
    return checks
