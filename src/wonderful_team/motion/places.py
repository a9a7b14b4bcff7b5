"""Places that steps name, as spots: at a target, beside it, or where it stood at the start."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from wonderful_team.core.actions import At, Beside, OriginOf, Place
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import PathPoint, Point
from wonderful_team.core.values import GroundedTarget, Limits, PointRole
from wonderful_team.errors import GeometryError
from wonderful_team.motion.beside import beside_px, half_extents
from wonderful_team.motion.deprojector import Deprojector, ResolvedPoint
from wonderful_team.motion.sharing import LEVEL_M, Share, share_px
from wonderful_team.motion.state import MotionState

TO_PICK: tuple[PointRole, ...] = ("pick", "grasp")
TO_PLACE: tuple[PointRole, ...] = ("place", "push_end", "pick", "grasp")
ANY: tuple[PointRole, ...] = ("pick", "grasp", "place", "push_end", "push_start")
TO_GRASP: tuple[PointRole, ...] = ("grasp", "pick", "place", "push_start", "push_end")


EVEN_M = 0.002
"""A surface at most this much higher than a thing's own point may still be what a flat thing lies on [m]."""


@dataclass(frozen=True, eq=False)
class Places:
    """The grounded targets of a plan in their view.

    Attributes:
        step: Number of the step that is being computed, from 1.
        shares: By step number, which part of its place a thing gets that lies there together with others.
    """

    grounded: Mapping[str, GroundedTarget]
    lift: Deprojector
    limits: Limits
    paths: Mapping[str, tuple[PathPoint, ...]]
    step: int = 1
    shares: Mapping[int, Share] = field(default_factory=dict)

    def fail(self, message: str) -> GeometryError:
        """The error to raise, naming the step."""
        return GeometryError(f"step {self.step}: {message}")

    def target(self, name: str) -> GroundedTarget:
        """A grounded target that was found, in this view.

        Raises:
            GeometryError: It was not grounded, is not in the picture, or was found in another view.
        """
        if name not in self.grounded:
            known = ", ".join(self.grounded) or "none"
            raise self.fail(f"target {name!r} was not grounded; grounded targets: {known}")
        found = self.grounded[name]
        if found.status == "absent":
            raise self.fail(f"target {name!r} ({found.target.words}) is not in the picture")
        if found.view_id != self.lift.view.id:
            raise self.fail(f"target {name!r} was found in view {found.view_id!r}, not in {self.lift.view.id!r}")
        return found

    def point(self, name: str, roles: tuple[PointRole, ...]) -> tuple[PointRole, Point]:
        """The target's chosen point for the first of these roles that it has.

        Raises:
            GeometryError: It has none of them, or the point lies outside the view.
        """
        found = self.target(name)
        for role in roles:
            if role in found.points:
                px = found.points[role]
                if not self.lift.inside(px):
                    width, height = self.lift.view.size_px
                    raise self.fail(
                        f"the {role} point of {name!r} at ({px[0]:.0f}, {px[1]:.0f}) px lies outside the view "
                        f"of {width} x {height} px"
                    )
                return role, px
        has = ", ".join(found.points) or "none"
        raise self.fail(f"target {name!r} has no point for {' or '.join(roles)}; it has: {has}")

    def box(self, name: str) -> Box:
        """The target's box in view pixels.

        Raises:
            GeometryError: It has none.
        """
        box = self.target(name).box
        if box is None:
            raise self.fail(f"target {name!r} has no box, which a place beside it or a push needs")
        return box

    def spot(self, name: str, roles: tuple[PointRole, ...], progress: MotionState) -> tuple[PointRole, ResolvedPoint]:
        """Where the target's chosen point lies now, on the surface that is seen there."""
        role, px = self.point(name, roles)
        return role, progress.carry(name, self.lift.surface(px, f"{name} {role} point"), self.lift)

    def support_z_m(self, name: str) -> float:
        """Height of what the target stood on in the picture [m]."""
        return self.lift.support_z_m(self.target(name).box, self._top_z_m(name) + EVEN_M)

    def centre(self, name: str, progress: MotionState) -> ResolvedPoint:
        """Where the target's centre lies now: that of its box, at the height of the point chosen on it.

        Without a box it is the point itself, without a point the surface at the box's centre.
        """
        found = self.target(name)
        if not found.points:
            seen = self.lift.surface(self.box(name).centre, f"centre of {name}'s box")
        else:
            role, px = self.point(name, ANY)
            seen = self.lift.surface(px, f"{name} {role} point")
            if found.box is not None:
                z_m = 0.0 if seen.position_m is None else float(seen.position_m[2])
                seen = self.lift.at_height(found.box.centre, z_m, f"centre of {name}'s box")
        return progress.carry(name, seen, self.lift)

    def origin(self, name: str) -> ResolvedPoint:
        """Where the target's centre stood at the start, at the height of what it stood on."""
        spot = self.centre(name, MotionState())
        how = f"origin of {name}: {spot.how}"
        if spot.position_m is None:
            return ResolvedPoint(spot.px, None, how)
        x, y, _ = spot.position_m
        return ResolvedPoint(spot.px, np.array([x, y, self.support_z_m(name)]), how)

    def resting(self, name: str, progress: MotionState) -> ResolvedPoint:
        """Where the target's centre is now, at the height of what it stands on now."""
        return progress.carry(name, self.origin(name), self.lift)

    def box_now(self, name: str, progress: MotionState) -> Box:
        """The target's box in view pixels, after the moves so far."""
        box = self.box(name)
        if not progress.moved.get(name):
            return box
        half = half_extents(box, progress.turn_of(name))
        centre = self.centre(name, progress).px
        return Box.around(centre, 2 * half[0], 2 * half[1])

    def destination(
        self, place: Place, progress: MotionState, thing: str | None, yaw_rad: float = 0.0
    ) -> ResolvedPoint:
        """Where the centre of `thing` is to be put; its height is the surface it will rest on.

        Args:
            place: As the step says.
            progress: What earlier steps have changed.
            thing: Target that is put there; None for the bare tool.
            yaw_rad: How far the thing is turned on the way.
        """
        match place:
            case At(target) if target == thing:
                # A thing that is put down where it is, such as one that is only turned.
                return self.resting(target, progress)
            case At(target):
                spot = self._shared(target, self.spot(target, TO_PLACE, progress)[1], progress)
                return spot if progress.moved.get(target) else self._freed(spot, progress, thing, target)
            case OriginOf(target):
                return self.origin(target)
            case Beside():
                return self._beside(place, progress, thing, yaw_rad)

    def _shared(self, name: str, spot: ResolvedPoint, progress: MotionState) -> ResolvedPoint:
        """This step's part of a place that several things share; the place's own point for one thing alone.

        Where a thing has no room for all beside each other, each comes to lie on those before it. In a free area nobody asked
        for that: its height stays, and the safety gate sees what stands there.
        """
        share = self.shares.get(self.step)
        if share is None:
            return spot
        boxes = [self.target(thing).box for thing in share.things]
        centre = self.point(name, TO_PLACE)[1]
        uncovered = any(self._shows(other, spot) for other in progress.moved if other not in (name, *share.things))
        part = share_px(share, self.target(name), boxes, centre, self.lift, uncovered)
        px = (spot.px[0] + part[0] - centre[0], spot.px[1] + part[1] - centre[1])
        if px == spot.px and self.target(name).target.kind == "area":
            return spot
        if px == spot.px:
            return self._on_others(share.things[: share.index], spot, progress)
        how = f"{spot.how}; part {share.index + 1} of {len(share.things)} that go there"
        z_m = 0.0 if spot.position_m is None else float(spot.position_m[2])
        return self.lift.at_height(px, z_m - self._stands_on_point_m(name, centre, part), how)

    def _stands_on_point_m(self, name: str, point: Point, part: Point) -> float:
        """How much higher a place shows at its own point than at a part of it [m]; 0 where both are its floor."""
        seen, floor = (self.lift.surface(px, name).position_m for px in (point, part))
        higher = 0.0 if seen is None or floor is None else float(seen[2] - floor[2])
        return higher if higher > LEVEL_M else 0.0

    def _on_others(self, things: Sequence[str], spot: ResolvedPoint, progress: MotionState) -> ResolvedPoint:
        """A spot at the height of what earlier steps have put there, if that is higher."""
        if spot.position_m is None:
            return spot
        highest, z_m = "", float(spot.position_m[2])
        for thing in things:
            top = self.spot(thing, TO_PICK, progress)[1].position_m
            if top is not None and top[2] > z_m:
                highest, z_m = thing, float(top[2])
        if not highest:
            return spot
        return ResolvedPoint(
            spot.px, np.array([*spot.position_m[:2], z_m]), f"{spot.how}; on {highest}, which lies there"
        )

    def _beside(self, place: Beside, progress: MotionState, thing: str | None, yaw_rad: float) -> ResolvedPoint:
        half = (0.0, 0.0)
        if thing is not None:
            half = half_extents(self.target(thing).box, progress.turn_of(thing) + yaw_rad)
        try:
            px = beside_px(self.box_now(place.target, progress), place.side, half, self.lift.view.size_px)
        except ValueError as error:
            raise self.fail(f"no room for {thing or 'the tool'} {place.side} of {place.target!r}: {error}") from error
        spot = self.lift.surface(px, f"{place.side} of {place.target}'s box")
        return self._freed(spot, progress, thing, place.target)

    def _freed(self, spot: ResolvedPoint, progress: MotionState, thing: str | None, place: str) -> ResolvedPoint:
        """The same spot, but at the height of the support where the picture shows a thing that will have left it."""
        for name in (*progress.moved, *([thing] if thing is not None else [])):
            if name == place or spot.position_m is None:
                continue
            support_m = self.support_z_m(name)
            if support_m + EVEN_M < float(spot.position_m[2]) and self._shows(name, spot):
                return self.lift.at_height(
                    spot.px, support_m, f"{spot.how}; {name} has left it, so z = {support_m:.3f} m"
                )
        return spot

    def _shows(self, name: str, spot: ResolvedPoint) -> bool:
        """Whether the picture shows a target at a spot.

        What shows in its box no higher than its pick point is the target. What lies higher, as where a thing leans on the wall
        of a bowl, may be a neighbour: it is the target if it hangs together with that point, and so is all without a box.
        """
        found = self.target(name)
        if found.box is not None and not found.box.contains(spot.px):
            return False
        if found.box is not None and spot.position_m is not None and spot.position_m[2] <= self._top_z_m(name) + EVEN_M:
            return True
        held = next((px for role, px in found.points.items() if role in TO_PICK), None)
        return held is not None and self.lift.inside(held) and self.lift.one_surface(held, spot.px, found.box)

    def _top_z_m(self, name: str) -> float:
        """Height of the point at which a thing is held; infinite without one."""
        point = next((px for role, px in self.target(name).points.items() if role in TO_PICK), None)
        seen = None if point is None or not self.lift.inside(point) else self.lift.surface(point, name).position_m
        return math.inf if seen is None else float(seen[2])
