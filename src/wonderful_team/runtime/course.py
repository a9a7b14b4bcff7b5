"""How a plan changes what is seen: which points a thing has, where it goes, what it may rest on, action after action."""

from __future__ import annotations

from typing import Any

import numpy as np
from shapely import MultiPolygon, affinity

from wonderful_team.core.actions import (
    At,
    Beside,
    MoveStep,
    MoveTo,
    OriginOf,
    Place,
    RotateGripper,
    places_of,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.motions import Carry, Reach, Slide, Stay
from wonderful_team.core.values import GroundedTarget, Plan, PlannedAction, View
from wonderful_team.images.relief import RAISED_M, Relief, covered, outline
from wonderful_team.runtime.stage import Carried, Stage

RING_SHARE, LEAST_RING_PX = 0.15, 2.0
"""How far round a box its support is looked for: share of its smaller side, and at least so many pixels."""
RETURNED_M = 0.02
"""So near to where it was seen a thing has returned [m]."""
GONE_M = -1e6
"""Where points go that nothing shows any more [m]: far from every table."""
MOSTLY = 0.5
"""A patch of which this share or more belongs to what the plan has put there is that thing."""
_MOST_POINTS = 4000
"""A thing is known well enough by so many points."""


class Course:
    """Follows a plan through the scene that a view shows."""

    def __init__(self, view: View, plan: Plan | None, table_z_m: float, holding: bool = False) -> None:
        self._view, self._table_z_m = view, table_z_m
        self._grounded = dict(plan.grounded) if plan is not None else {}
        self._relief = self._seen = Relief.of(view)
        self._held: tuple[str, Carried, Array, float] | None
        self._things: dict[str, Array] = {}
        # What was put somewhere and has no name that the plan knows.
        self._nameless: list[tuple[Array, float]] = []
        self._bases: dict[str, float] = {}
        self._regions: dict[str, Any] = {}
        self._lies_at: dict[str, str] = {}
        # What a robot holds from the start has a size that nobody has said.
        self._held = ("", Carried(None), np.zeros(0, dtype=np.int64), table_z_m) if holding else None
        self._at: tuple[str, Array] | None = None
        # Points of what the fingers have just let go of: they still stand round it.
        self._let_go = np.zeros(0, dtype=np.int64)
        # Where the tool was and how it was turned when it closed, and how the last move has turned it.
        self._held_at: Array | None = None
        self._held_yaw_rad = self._yaw_rad = 0.0
        self._due: tuple[str, Array | None, float, Array, Array, float] | None = None

    def next(self, planned: PlannedAction, tool_m: Array | None) -> Stage:
        """The stage of the next action, after which the scene is as that action should leave it.

        Args:
            planned: The action.
            tool_m: Where the tool stands before it, shape (3,) [m]; None when unknown.
        """
        # What the last action leaves is worked out when another one comes: after the last nobody asks.
        due, self._due = self._due, None
        if due is not None:
            self._move(*due)
        action, step = planned.action, planned.step
        motion = Stay() if action is None else action.motion(tool_m)
        if isinstance(motion, Carry):
            return self._carry(planned, motion)
        if isinstance(motion, Slide):
            return self._slide(planned, motion)
        if isinstance(motion, Stay):
            self._grip(motion.grip, tool_m)
        if isinstance(step, MoveStep):
            self._at = (step.to.target, np.zeros(3)) if step.height == "at" else None
        if isinstance(action, MoveTo):
            self._yaw_rad = action.pose.yaw_rad
        if isinstance(action, RotateGripper):
            self._yaw_rad += action.yaw_rad
        held = self._held
        carried = None if held is None else held[1].turned(self._yaw_rad - self._held_yaw_rad)
        own = self._mask(held[2]) if held is not None and self._relief is not None else None
        taken = ""
        if held is not None and isinstance(step, MoveStep) and isinstance(step.to, At) and isinstance(motion, Reach):
            taken = self._taken(held[0], step.to.target, motion.points_m[-1])
        meant = self._met(planned)
        if isinstance(motion, Reach) and held is None:
            meant, self._let_go = self._from_between(meant), np.zeros(0, dtype=np.int64)
        return Stage(motion, self._relief, own, carried, meant, False, False, taken=taken)

    def _carry(self, planned: PlannedAction, way: Carry) -> Stage:
        places = dict(places_of(planned.step))
        name, place = (places["pick"].target, places.get("place")) if "pick" in places else ("", None)
        own, base = self._own(name, way.start_m)
        carried = self._carried(name, own, way.start_m, base)
        meant, level, stated = self._place(name, place, way, own)
        back = isinstance(place, OriginOf) and place.target == name and way.yaw_rad == 0 and self._returns(name, way)
        put = self._put("" if place is None else place.target)
        taken = self._taken(name, place.target, way.end_m) if isinstance(place, At) else ""
        stage = Stage(way, self._relief, own, carried, meant, level, stated, back, taken, put, self._support(own, base))
        self._due = (name, own, base, way.start_m, way.end_m, way.yaw_rad)
        self._lies_at[name] = place.target if isinstance(place, At) else ""
        return stage

    def _taken(self, name: str, place: str, end_m: Array) -> str:
        """Another thing that the plan names, lies on the place and has not been moved: what is put there lands on it, not in the place."""
        target, relief = self._grounded.get(place), self._relief
        if target is None or target.target.kind != "object" or relief is None or name == place:
            return ""
        whole = self.region(place, end_m)
        for other, found in self._grounded.items():
            if other in (name, place) or other in self._things or found.target.kind != "object" or found.box is None:
                continue
            region = self.region(other, end_m)
            if whole is None or region is None or not whole.contains(region.centroid) or region.area >= whole.area:
                continue
            own, _ = self._own(other, np.append(end_m[:2], self._top_m(found.box)))
            if own is not None and (own & relief.near(end_m, relief.cell_m)).any():
                return found.target.words
        return ""

    def _top_m(self, box: Box) -> float:
        """Height of the highest surface that shows in a box [m]."""
        assert self._relief is not None
        heights = self._relief.xyz_m[self._relief.in_box(box), 2]
        return float(heights.max()) if len(heights) else self._table_z_m

    def _support(self, own: Array | None, base: float) -> Array | None:
        """What shows under a thing once it is lifted off something that is not the table."""
        if own is None or self._relief is None or not own.any() or base <= self._table_z_m + RAISED_M:
            return None
        under = self._relief.xyz_m[own].copy()
        under[:, 2] = base
        return under

    def _stated(self, place_m: Array, own: Array | None) -> Any | None:
        """What a height says that a thing is put on: what stands at the place, where the surface is not the table."""
        surface = None if self._relief is None else self._relief.surface_m(place_m[:2], own)
        if self._relief is None or surface is None or surface <= self._table_z_m + RAISED_M:
            return None
        return self._relief.standing(place_m[:2], self._table_z_m)

    def _place(self, name: str, place: Place | None, way: Carry, own: Array | None) -> tuple[Any | None, bool, bool]:
        """What a thing may rest on, whether the place must be level, and whether the plan names it."""
        target = self._grounded.get(place.target) if place is not None else None
        if place is None or target is None:
            return self._stated(way.end_m, own), False, False
        if isinstance(place, OriginOf) or (isinstance(place, At) and place.target == name):
            return None, False, True
        if isinstance(place, Beside):
            return None, True, True
        if target.target.kind == "object":
            return self.region(place.target, way.end_m), False, True
        return None, True, True

    def _slide(self, planned: PlannedAction, way: Slide) -> Stage:
        places = dict(places_of(planned.step))
        start, end = places.get("push_start"), places.get("push_end")
        name = "" if start is None else start.target
        own, base = self._own(name, way.start_m) if name in self._grounded else (None, self._table_z_m)
        meant = None
        if isinstance(end, At) and end.target in self._grounded:
            meant = self.region(end.target, way.end_m)
        carried = self._carried(name, own, way.start_m, base)
        stage = Stage(way, self._relief, own, carried, meant, False, name in self._grounded)
        along_m = way.end_m[:2] - way.start_m[:2]
        length = float(np.linalg.norm(along_m))
        if own is not None and self._relief is not None and own.any() and length > 1e-6:
            along = (self._relief.xyz_m[own, :2] - way.start_m[:2]) @ (along_m / length)
            shift = np.append(along_m / length * max(0.0, length - float(along.min())), 0.0)
            at_m = np.append(way.start_m[:2], base)
            self._due = (name, own, base, at_m, at_m + shift, 0.0)
        return stage

    def _returns(self, name: str, way: Carry) -> bool:
        """Whether a thing really comes to lie where the view shows it."""
        target, now = self._grounded.get(name), self.region(name, way.start_m)
        corners = None if target is None or target.box is None else self._corners(target.box, first=True)
        if corners is None or now is None:
            return False
        shown = outline(corners, 0.002).centroid
        end = _shifted(now, way.start_m, way.end_m, way.yaw_rad).centroid
        return float(shown.distance(end)) <= RETURNED_M

    def region(self, name: str, at_m: Array) -> Any | None:
        """What a target covers of the table now, as a shape; None when nothing says so."""
        if name in self._regions:
            return self._regions[name]
        target = self._grounded.get(name)
        box = None if target is None else target.box
        if box is None:
            return None if self._relief is None else self._relief.standing(at_m[:2], self._table_z_m)
        corners = self._corners(box)
        return None if corners is None else outline(corners, 0.002)

    def _corners(self, box: Box, first: bool = False) -> Array | None:
        """Points that a box shows, shape (N, 2) [m]: those with depth in it now, or at first, else its corners."""
        relief = self._seen if first else self._relief
        if relief is not None:
            inside = relief.in_box(box)
            if inside.any():
                return np.asarray(relief.xyz_m[inside, :2])
        if self._view.camera is None:
            return None
        try:
            return np.asarray(self._view.camera.on_plane(np.array(box.corners), self._table_z_m)[:, :2])
        except ValueError:
            return None

    def _own(self, name: str, at_m: Array) -> tuple[Array | None, float]:
        """Which points a thing has, shape (N,) bool, and the height of what it stands on [m]."""
        relief = self._relief
        if relief is None or not len(relief.xyz_m):
            return None, self._table_z_m
        heights = relief.xyz_m[:, 2]
        if name in self._things:
            return self._mask(self._things[name]), self._bases[name]
        target: GroundedTarget | None = self._grounded.get(name)
        if target is None or target.box is None:
            patch = relief.patch(at_m[:2], self._table_z_m)
            return patch, self._base_of(patch)
        box = target.box
        ring = max(LEAST_RING_PX, RING_SHARE * min(box.width, box.height))
        inside = relief.in_box(box)
        round_it = relief.in_box(box.grown(ring, ring, ring, ring)) & ~inside
        top = float(at_m[2])
        lower = heights[round_it & (heights < top - RAISED_M)]
        if not len(lower):
            lower = heights[inside & (heights < top - RAISED_M)]
        base = max(float(np.quantile(lower, 0.25)), self._table_z_m) if len(lower) else min(top, self._table_z_m)
        close = relief.all_round(box)
        base = close if close is not None and base < close < top - RAISED_M else base
        raised = inside & (heights > base + RAISED_M * 0.75)
        return (raised if raised.any() else inside), base

    def _base_of(self, patch: Array | None) -> float:
        """The height of what a thing without a name stands on: where the plan has put it, else the table [m]."""
        if patch is not None:
            for indices, base in reversed(self._nameless):
                if len(indices) and patch[indices].mean() > MOSTLY:
                    return base
        return self._table_z_m

    def _carried(self, name: str, own: Array | None, tool_m: Array, base: float) -> Carried:
        hanging = max(0.0, float(tool_m[2]) - base)
        if own is not None and own.any() and self._relief is not None:
            points = self._relief.xyz_m[own, :2]
            return Carried(points[:: max(1, len(points) // _MOST_POINTS)] - tool_m[:2], hanging)
        target = self._grounded.get(name)
        region = self.region(name, tool_m) if target is not None and target.box is not None else None
        if region is None:
            return Carried(None, hanging)
        # What the plan itself has put onto it comes along.
        on_it = [other for key, other in self._regions.items() if key != name and region.contains(other.centroid)]
        whole = MultiPolygon([region, *on_it]).convex_hull
        return Carried(np.asarray(whole.exterior.coords) - tool_m[:2], hanging)

    def _move(self, name: str, own: Array | None, base: float, start: Array, end: Array, yaw_rad: float) -> None:
        """The thing stands at its end now, and what it stood on shows where it was."""
        region = self.region(name, start) if name in self._grounded else None
        if region is not None:
            self._regions[name] = _shifted(region, start, end, yaw_rad)
        if own is None or self._relief is None or not own.any():
            return
        relief = self._relief
        left = relief.xyz_m[own].copy()
        left[:, 2] = base
        moved = _moved(relief.xyz_m[own], base, start, end, yaw_rad)
        self._relief = after = relief.with_expected(left)
        points, px = after.xyz_m, after.px
        # What it covers there is not the surface any more; when it leaves again, its support is.
        mine = np.append(own, np.zeros(len(left), dtype=bool))
        hidden = ~mine & after.inside(outline(moved[:, :2], relief.cell_m))
        hidden[hidden] = covered(moved[:, :2], points[hidden, :2], relief.cell_m)
        # Slats between whose gaps it was put are covered too: it rests on them, whatever the one place point showed.
        hidden &= points[:, 2] < max(end[2] + RAISED_M, float(moved[:, 2].max()))
        points[hidden], px[hidden] = GONE_M, np.nan
        points[mine], px[mine] = moved, np.nan
        indices = np.flatnonzero(own)
        # A point belongs to what took it along last.
        self._nameless = [(others[~own[others]], at_m) for others, at_m in self._nameless]
        if name not in self._grounded:
            self._nameless.append((indices, float(end[2])))
            return
        self._things[name] = indices
        self._bases[name] = float(end[2])

    def _put(self, place: str) -> Array | None:
        """Which points belong to things that earlier actions have put elsewhere than at a place, shape (N,) bool."""
        moved = [indices for name, indices in self._things.items() if place not in (name, self._lies_at.get(name))]
        moved += [indices for indices, _ in self._nameless]
        return self._mask(np.concatenate(moved)) if moved else None

    def _mask(self, indices: Array) -> Array:
        assert self._relief is not None
        own = np.zeros(len(self._relief.xyz_m), dtype=bool)
        own[indices] = True
        return own

    def _grip(self, grip: str | None, tool_m: Array | None) -> None:
        if grip is None:
            return
        if grip == "open":
            if self._held is not None and tool_m is not None and self._relief is not None:
                # What it stood on, not the lowest of its points that is seen: a fruit bulges over its own foot.
                name, carried, indices, base = self._held
                start = np.append((tool_m if self._held_at is None else self._held_at)[:2], base)
                end = np.append(tool_m[:2], float(tool_m[2]) - carried.hanging_m)
                self._move(name, self._mask(indices), base, start, end, self._yaw_rad - self._held_yaw_rad)
                self._let_go = indices
            self._held = None
        elif self._held is None:
            if tool_m is None or self._at is None:
                self._held = ("", Carried(None), np.zeros(0, dtype=np.int64), self._table_z_m)
                return
            name = self._at[0]
            points, base = self._own(name, tool_m)
            indices = np.zeros(0, dtype=np.int64) if points is None else np.flatnonzero(points)
            self._held, self._held_at = (name, self._carried(name, points, tool_m, base), indices, base), tool_m
            self._held_yaw_rad = self._yaw_rad

    def _from_between(self, meant: Any | None) -> Any | None:
        """What the open fingers may come near to on their way off what they have let go of, with that thing itself."""
        if self._relief is None or not len(self._let_go):
            return meant
        thing = outline(self._relief.xyz_m[self._let_go, :2], self._relief.spacing_m)
        return thing if meant is None else meant.union(thing)

    def _met(self, planned: PlannedAction) -> Any | None:
        """What a move is meant to come near to: what its step names, or what stands at its end."""
        step, action = planned.step, planned.action
        if not isinstance(step, MoveStep) or action is None or self._relief is None:
            return None
        end = np.asarray(getattr(getattr(action, "pose", None), "position_m", np.zeros(3)))
        if step.to.target in self._grounded:
            # A free area is named for being free: nothing that stands in it may be met by what is put there.
            area = self._grounded[step.to.target].target.kind == "area"
            return None if area and self._held is not None else self.region(step.to.target, end)
        return self._relief.standing(end[:2], self._table_z_m)


def _shifted(region: Any, start: Array, end: Array, yaw_rad: float) -> Any:
    turned = affinity.rotate(region, yaw_rad, origin=(float(start[0]), float(start[1])), use_radians=True)
    return affinity.translate(turned, float(end[0] - start[0]), float(end[1] - start[1]))


def _moved(points: Array, base: float, start: Array, end: Array, yaw_rad: float) -> Array:
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    offset = points[:, :2] - start[:2]
    turned = offset @ np.array([[c, s], [-s, c]])
    return np.column_stack([turned + end[:2], points[:, 2] - base + end[2]])
