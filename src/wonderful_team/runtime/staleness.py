"""Is the picture that the plan was made from still true where the plan is going to touch something?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.actions import places_of
from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.motions import Carry, Motion, Slide
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import GateCheck, Observation, Plan, PlannedAction, View
from wonderful_team.images import CHANGED, region_change

NOISE_LEVELS = 14
"""A pixel counts as changed when a channel, smoothed over 3 x 3 pixels, differs by more than this (of 255).

Sensor noise of 4 levels leaves differences of about 2 after smoothing, so this is seven times the noise."""
MAX_AGE_S = 600.0
"""Oldest picture that may be acted upon [s]; ten minutes lets a person read and approve a plan."""
_POINT_REACH_PX_SHARE = 0.06
"""Half-width of the window round a point without a box, as a share of the picture's shorter side."""


@dataclass(frozen=True)
class Region:
    """A part of the main view that an action relies on, and which action (from 0)."""

    name: str
    box: Box
    action: int


def changed_boxes(then: View, now: View) -> tuple[Box, ...]:
    """Boxes round everything that differs between two pictures, a few pixels wider than the change."""
    if then.size_px != now.size_px:
        return (Box(0, 0, *now.size_px),)
    changed = _changed_pixels(then.rgb, now.rgb).astype(np.uint8)
    grown = cv2.dilate(changed, np.ones((5, 5), np.uint8))
    count, _, stats, _ = cv2.connectedComponentsWithStats(grown)
    return tuple(Box(x, y, x + w, y + h) for x, y, w, h, _ in stats[1:count].tolist())


def _changed_pixels(then: Array, now: Array) -> Array:
    difference = cv2.blur(now.astype(np.float32), (3, 3)) - cv2.blur(then.astype(np.float32), (3, 3))
    return np.asarray(np.abs(difference).max(axis=2) > NOISE_LEVELS)


def points_px(planned: PlannedAction, view: View) -> tuple[tuple[str, Point], ...]:
    """Points of an action as (role, pixel of the main view); projected when no sources name them."""
    if planned.sources or view.camera is None:
        return tuple((source.role, source.point_px) for source in planned.sources)
    if planned.action is None or not _touches(planned):
        return ()
    named = planned.action.points()
    try:
        pixels = view.camera.project(np.array([point_m for _, point_m in named]))
    except ValueError:
        return ()  # behind the camera: outside the picture, so there is nothing to watch
    return tuple((role, (float(x), float(y))) for (role, _), (x, y) in zip(named, pixels, strict=True))


def _motion(planned: PlannedAction) -> Motion | None:
    return None if planned.action is None else planned.action.motion(None)


def _touches(planned: PlannedAction) -> bool:
    """Whether an action is there to move something in the picture."""
    return isinstance(_motion(planned), Carry | Slide)


def watched(actions: Sequence[PlannedAction], plan: Plan | None, view: View, first: int = 0) -> tuple[Region, ...]:
    """The regions that actions rely on: the box of each object they touch, a window round each other point.

    Where nothing says which part of the picture an action that touches something relies on, it is the whole picture.
    """
    whole = Box(0, 0, *view.size_px)
    found: list[Region] = []
    for index, planned in enumerate(actions, start=first):
        regions = [_region(role, point, planned, plan, view, index) for role, point in points_px(planned, view)]
        if not regions and _touches(planned):
            regions = [Region("whole picture", whole, index)]
        if isinstance(_motion(planned), Slide) and len(regions) == 2 and regions[0].box.intersection(whole) is None:
            # A tool may come down just outside of the picture: what shows of its way is watched.
            ends = (*regions[0].box.corners, *regions[1].box.corners)
            regions[0] = Region(regions[0].name, Box.bounding(ends), index)
        found += regions
    return tuple(found)


def _region(role: str, point: Point, planned: PlannedAction, plan: Plan | None, view: View, index: int) -> Region:
    target = getattr(dict(places_of(planned.step)).get(role), "target", None)
    name = f"{target} ({role})" if target else role
    grounded = plan.grounded.get(target) if plan is not None and target is not None else None
    if grounded is not None and grounded.target.kind == "object" and grounded.box is not None:
        if grounded.box.contains(point):
            return Region(name, grounded.box, index)
    return Region(name, point_window(point, _held_box(planned, plan), view), index)


def touched(planned: PlannedAction, plan: Plan | None, before: View, after: View) -> tuple[Box, ...]:
    """The parts of the main view that an executed action was meant to change.

    A pick and place changes where the object stood and where it goes, a push the strip in between. For actions that
    leave the arm in the picture (moves, trajectories), it is whatever they changed.
    """
    points = points_px(planned, before)
    held = _held_box(planned, plan)
    match _motion(planned):
        case Carry():
            return tuple(point_window(point, held, before).scaled(1.6) for _, point in points)
        case Slide():
            ends = [point_window(point, held, before).scaled(1.6) for _, point in points]
            return (Box.bounding([corner for box in ends for corner in box.corners]),) if ends else ()
        case _:
            return changed_boxes(before, after)


def _held_box(planned: PlannedAction, plan: Plan | None) -> Box | None:
    target = getattr(planned.step, "pick", None)
    grounded = plan.grounded.get(target) if plan is not None and target is not None else None
    return None if grounded is None else grounded.box


def point_window(point: Point, held: Box | None, view: View) -> Box:
    """A window round a point: as large as what is held there, else of a fixed share of the picture."""
    if held is not None:
        return Box.around(point, held.width, held.height)
    side = 2 * _POINT_REACH_PX_SHARE * min(view.size_px)
    return Box.around(point, side, side)


def staleness_checks(
    then: Observation | None,
    now: Observation,
    regions: Sequence[Region],
    *,
    scene_hash: str | None = None,
    expected_change: Sequence[Box] = (),
    max_age_s: float | None = MAX_AGE_S,
) -> list[GateCheck]:
    """Compare the picture the plan was made from with the picture of now.

    Args:
        then: What the plan was made from, or what its last step left; None when it is not at hand.
        now: The scene just before motion.
        regions: What the coming actions rely on.
        scene_hash: The hash that the plan says its picture has; None for actions that come without a plan.
        expected_change: Parts that the plan's own earlier actions changed.
        max_age_s: Limit on the picture's age [s]; None for no limit.
    """
    if then is None:
        if scene_hash is None:
            return [GateCheck(None, "scene", True, "no plan, no picture", "none stated")]
        same = now.is_called(scene_hash)
        value = "the same picture" if same else f"now {now.hash[:12]}; the picture of the plan is not at hand"
        return [GateCheck(None, "scene", same, value, f"picture {scene_hash[:12] or '(the plan names none)'}")]
    checks = []
    if scene_hash is not None:
        ok, limit = then.is_called(scene_hash), scene_hash[:12] or "a picture that the plan names"
        checks.append(
            GateCheck(
                None, "picture of the plan", ok, (then.hash if len(scene_hash) != 16 else then.short_hash)[:12], limit
            )
        )
    checks.append(_age(then, now, max_age_s))
    same = then.shows_the_same_as(now)
    checks.append(GateCheck(None, "scene", True, "the same picture" if same else "changed somewhere", "regions decide"))
    checks += [_region_check(then.main, now.main, region, same, expected_change) for region in regions]
    return checks


def _age(then: Observation, now: Observation, max_age_s: float | None) -> GateCheck:
    age_s = now.main.time_s - then.main.time_s
    if max_age_s is None:
        return GateCheck(None, "picture age", True, f"{age_s:.1f} s", "no limit")
    ok = age_s <= max_age_s and (age_s >= 0 or then.shows_the_same_as(now))
    return GateCheck(None, "picture age", ok, f"{age_s:.1f} s", f"0 to {max_age_s:.0f} s", f"{max_age_s - age_s:.1f} s")


def _region_check(then: View, now: View, region: Region, same: bool, expected_change: Sequence[Box]) -> GateCheck:
    limit = f"change below {CHANGED:.2f} of 1"
    name = f"unchanged: {region.name}"
    if then.size_px != now.size_px:
        return GateCheck(region.action, name, False, f"picture of {now.size_px} px", f"{then.size_px} px as planned")
    if region.box.intersection(Box(0, 0, *now.size_px)) is None:
        return GateCheck(region.action, name, False, "outside the picture: it cannot be watched", limit)
    if any(region.box.intersection(box) is not None for box in expected_change):
        return GateCheck(region.action, name, True, "changed by this plan's own actions", limit, "excused")
    change = 0.0 if same else region_change(then.rgb, now.rgb, region.box)
    return GateCheck(region.action, name, change < CHANGED, f"{change:.2f}", limit, f"{CHANGED - change:+.2f}")
