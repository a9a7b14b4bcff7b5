"""The one safety gate: every action of every policy passes it, simulated or real. All problems are reported at once.

Where it cannot decide, it refuses.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wonderful_team.core.actions import Vocabulary
from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.motions import Carry, Drive, Leave, Lost, Reach
from wonderful_team.core.text import counted
from wonderful_team.core.values import (
    GateCheck,
    GateReport,
    HeightProfile,
    KeepOut,
    Limits,
    Observation,
    Plan,
    PlannedAction,
)
from wonderful_team.images.keep_out import table_height_m
from wonderful_team.runtime.agreement import agreement_checks, class_checks, form_checks, repeat_checks, size_checks
from wonderful_team.runtime.approval import Approval, Declined, approval_checks, approved_id
from wonderful_team.runtime.course import Course
from wonderful_team.runtime.keep_out_checks import keep_out_checks, keep_out_px_checks
from wonderful_team.runtime.passing import Piece, pieces_of, profile_of
from wonderful_team.runtime.seen_checks import height_checks, least_clearance_m, place_checks, taken_checks, way_checks
from wonderful_team.runtime.stage import Stage
from wonderful_team.runtime.staleness import MAX_AGE_S, staleness_checks, watched
from wonderful_team.runtime.sweep import Sweep, sweep_of, swept_path_px

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
    expected_change: Sequence[Box] = (),
    max_age_s: float | None = MAX_AGE_S,
    tool_radius_m: float = TOOL_RADIUS_M,
    measured_heights: bool = False,
    stages: list[Stage] | None = None,
) -> GateReport:
    """Check actions before anything moves.

    Args:
        actions: What is going to run, in order.
        vocabulary: What the world runs.
        limits: What it allows.
        plan: Where the actions come from, or None for a method that acts without one.
        then: The picture that the plan was made from; None when it is not at hand.
        now: The scene just before motion; its depth, where it has any, says what stands where.
        approval: A person's consent, checked whenever it is given.
        approval_required: Refuse without consent.
        page: Hash of the page that shows the plan; a consent must name it.
        expected_plan_id: Id of the plan that was read; another plan is refused.
        must_run: Refuse actions that have no metres; otherwise a plan in pixels is checked in pixels.
        expected_change: Parts of the main view [px] that the plan's own earlier actions changed.
        max_age_s: Oldest picture that may be acted upon [s]; None for no limit.
        tool_radius_m: Half-width of what moves, kept clear of keep-out regions [m].
        measured_heights: Refuse heights that no depth shows, for a camera without depth; a world whose robot finds
            surfaces by itself does without. Where there is depth, it must show every point that is touched.
        stages: Gets the scene as it is expected before each action, for who watches them run; complete when they are admitted.

    Returns:
        Every check with its value, limit and margin; `admitted` when none failed.
    """
    # Beyond the first that fails nothing is known, or nobody would wait for it.
    for refusal in (size_checks(actions, plan), class_checks(actions)):
        if refusal:
            return GateReport(tuple(refusal))
    checks = _plan_checks(actions, plan, expected_plan_id)
    checks += repeat_checks(actions) if plan is not None else []
    picture = (then or now).hash
    checks += approval_checks(approved_id(plan, actions), picture, page, approval, approval_required)
    regions = (*limits.keep_out, *(plan.keep_out if plan is not None else ()))
    passage = _Passage(plan, limits, now, regions, must_run, tool_radius_m, measured_heights)
    profiles: list[HeightProfile] = []
    for index, planned in enumerate(actions):
        found = form_checks(planned, vocabulary)
        if all(check.ok or check.name == "vocabulary" for check in found):
            found += passage.next(planned)
            if stages is not None and passage.stage is not None:
                stages.append(passage.stage)
            profile = passage.profile(index, len(actions))
            profiles += [] if profile is None else [profile]
        else:
            # What such an action does, and where the tool is after it, nobody knows.
            passage.lost()
        checks += [replace(check, action=index) for check in found]
    checks += staleness_checks(
        then,
        now,
        watched(actions, plan, now.main) if then is not None else (),
        scene_hash=plan.scene_hash if plan is not None else None,
        expected_change=expected_change,
        max_age_s=max_age_s,
    )
    return GateReport(tuple(checks), tuple(profiles))


class _Passage:
    """Follows actions one after the other: where the tool is, what it carries, what stands where.

    Attributes:
        stage: The scene before the action that was checked last; None where nobody knows.
    """

    def __init__(
        self,
        plan: Plan | None,
        limits: Limits,
        now: Observation,
        regions: Sequence[KeepOut],
        must_run: bool,
        tool_radius_m: float,
        measured_heights: bool,
    ) -> None:
        self._plan, self._limits, self._now, self._regions = plan, limits, now, regions
        self._must_run, self._tool_radius_m, self._measured = must_run, tool_radius_m, measured_heights
        self._course = Course(now.main, plan, table_height_m(limits), holding=bool(now.robot and now.robot.holding))
        self._tool_m = _tool_m(now)
        self._way: tuple[Stage, tuple[Piece, ...]] | None = None
        self.stage: Stage | None = None

    def lost(self) -> None:
        self._tool_m = None

    def profile(self, index: int, actions: int) -> HeightProfile | None:
        """Of the action that was checked last."""
        if self._way is None:
            return None
        stage, pieces = self._way
        return profile_of(index, pieces, least_clearance_m(stage), actions, isinstance(stage.motion, Reach))

    def next(self, planned: PlannedAction) -> list[GateCheck]:
        self._way = self.stage = None
        if planned.action is None:
            return self._pixel_checks(planned)
        held = self._held(planned)
        reach_px = 0.0 if held is None else math.hypot(held.width, held.height) / 2
        self.stage = stage = self._course.next(planned, self._tool_m)
        sweep = sweep_of(planned.action, self._limits, self._tool_m)
        found = self._metre_checks(stage, sweep)
        found += agreement_checks(planned, self._now.main, reach_px)
        if self._now.main.camera is None:
            found += keep_out_px_checks(
                planned, self._regions, None, self._limits, held, min(self._now.main.size_px), True
            )
        self._tool_m = sweep.after_m
        return found

    def _held(self, planned: PlannedAction) -> Box | None:
        name = getattr(planned.step, "pick", None)
        if name is None:
            name = getattr(getattr(planned.step, "to", None), "target", None)
        target = self._plan.grounded.get(name) if self._plan is not None and name is not None else None
        return None if target is None else target.box

    def _metre_checks(self, stage: Stage, sweep: Sweep) -> list[GateCheck]:
        limits, motion = self._limits, sweep.motion
        if sweep.path_m is None:
            found = []
            if isinstance(motion, Lost):
                limit = "known, from the robot or from an action before"
                found.append(GateCheck(None, "tool position", False, "not known", limit))
            camera = self._now.main.camera
            if isinstance(motion, Leave):
                found += keep_out_checks(sweep, None, self._regions, camera, limits, self._tool_radius_m)
            return found
        # The way from where the tool stands is the world's own doing: only what the action asks for must lie inside.
        checks = [_axis_check(sweep.path_m, axis, limits) for axis in range(2)]
        if not isinstance(motion, Drive):
            checks.append(_axis_check(sweep.path_m, 2, limits))
        if isinstance(motion, Carry):
            checks.append(_carry_check(motion, limits))
        if not isinstance(motion, Drive):
            checks += height_checks(stage, limits, self._measured)
            checks += place_checks(stage, limits) + taken_checks(stage)
            pieces = pieces_of(stage, sweep, self._tool_radius_m)
            self._way = stage, pieces
            checks += way_checks(stage, pieces, self._tool_radius_m)
        camera = self._now.main.camera
        return checks + keep_out_checks(sweep, stage.carried, self._regions, camera, limits, self._tool_radius_m)

    def _pixel_checks(self, planned: PlannedAction) -> list[GateCheck]:
        limit = "metres from a camera" if self._must_run else "none"
        checks = [GateCheck(None, "metres", not self._must_run, "pixels only", limit)]
        points = np.array(swept_path_px(planned), dtype=np.float64).reshape(-1, 2)
        finite = bool(np.isfinite(points).all())
        checks.append(GateCheck(None, "numbers", finite, f"{len(points)} points", "all finite"))
        if not finite:
            return checks
        if len(points) == 0:
            if planned.step.points:
                checks.append(GateCheck(None, "points", False, "none", "at least 1 pixel of the picture"))
            return checks
        width, height = self._now.main.size_px
        for axis, side in enumerate((width, height)):
            least, most = float(points[:, axis].min()), float(points[:, axis].max())
            margin = min(least, side - most)
            value = f"{least:.0f} to {most:.0f} px"
            name = f"picture {'xy'[axis]}"
            checks.append(GateCheck(None, name, margin >= 0, value, f"[0, {side}] px", f"{margin:+.0f} px"))
        held, camera = self._held(planned), self._now.main.camera
        return checks + keep_out_px_checks(
            planned, self._regions, camera, self._limits, held, min(width, height), False
        )


def _tool_m(now: Observation) -> Array | None:
    """Where the robot says that its tool is; None when it does not say, or says something that is no point."""
    if now.robot is None or now.robot.tool_m is None:
        return None
    tool = np.asarray(now.robot.tool_m, dtype=np.float64)
    return tool if tool.shape == (3,) and np.isfinite(tool).all() else None


def _plan_checks(actions: Sequence[PlannedAction], plan: Plan | None, expected_id: str | None) -> list[GateCheck]:
    checks = []
    if expected_id is not None:
        have = plan.id if plan is not None else "no plan"
        value, limit = f"plan {have[:12]}", f"plan {expected_id[:12]}"
        checks.append(GateCheck(None, "plan that was read", have == expected_id, value, limit))
    if plan is not None:
        ours, theirs = _texts(actions), _texts(plan.actions)
        same = ours == theirs
        value = counted(len(actions), "action") + ("" if same else ", not those of the plan")
        checks.append(GateCheck(None, "actions of the plan", same, value, f"the {len(theirs)} of plan {plan.id[:12]}"))
    if not actions:
        checks.append(GateCheck(None, "actions", False, "0", "at least 1"))
    return checks


def _texts(actions: Sequence[PlannedAction]) -> list[str]:
    return [json.dumps(to_jsonable((planned.step, planned.action)), sort_keys=True) for planned in actions]


def _axis_check(path: Array, axis: int, limits: Limits) -> GateCheck:
    low, high = limits.low_m[axis], limits.high_m[axis]
    values = path[:, axis]
    least, most = float(values.min()), float(values.max())
    margin = min(least - low, high - most)
    shown = f"{least:.3f} m" if least == most else f"{least:.3f} to {most:.3f} m"
    name = "height" if axis == 2 else f"workspace {'xy'[axis]}"
    return GateCheck(None, name, margin >= -TOLERANCE_M, shown, f"[{low:.3f}, {high:.3f}] m", f"{margin:+.3f} m")


def _carry_check(way: Carry, limits: Limits) -> GateCheck:
    carry = limits.carried_z_m(way.start_m, way.end_m)
    ends = max(way.start_m[2], way.end_m[2])
    room = float(carry - ends)
    return GateCheck(
        None, "carrying height", room > 0, f"{carry:.3f} m", f"above both ends ({ends:.3f} m)", f"{room:+.3f} m"
    )
