"""The eyes of a simulated model: which true sight a picture shows, and what is in it.

A picture that shows nothing that was ever really seen gives no sight: the model is blind in it.
"""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import cv2
import numpy as np

from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.core.protocols import SceneTruth
from wonderful_team.core.values import GroundTruthView, LaterPicture, TrueThing
from wonderful_team.simulated.agreement import difference, expected

LEAST_PX = 8
"""Fewer pixels of a thing than this are not seen [view px]."""


@dataclass(frozen=True, eq=False)
class Seen:
    """A picture whose pixels are true, with the sight that it was cut from.

    Attributes:
        newest: The last look at the same view.
        truth: Says how things stand now, where the sight itself does not say how they stood.
    """

    picture: Picture
    sight: GroundTruthView
    newest: GroundTruthView
    truth: SceneTruth

    @cached_property
    def current(self) -> bool:
        """Whether nothing that shows has changed since."""
        return self.sight is self.newest or _alike(self.sight, self.newest)

    @cached_property
    def window(self) -> Box:
        """The part of the view that the picture shows [view px]."""
        frame = self.picture.frame
        whole = Box(0, 0, *self.sight.view.size_px)
        return frame.box_to_view(frame.valid).intersection(whole) or whole

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The things that show in the picture."""
        return tuple(name for name in self.sight.masks if self.count(name) >= LEAST_PX)

    def thing(self, name: str) -> TrueThing | None:
        """A thing as it stood in this picture."""
        return self.sight.things.get(name) or self.truth.things().get(name)

    def mask(self, name: str) -> tuple[Array, tuple[int, int]]:
        """Which pixels of the window show a thing, and the window's corner (column, row) [view px]."""
        x0, y0 = int(np.floor(self.window.x0 + 1e-6)), int(np.floor(self.window.y0 + 1e-6))
        x1, y1 = int(np.ceil(self.window.x1 - 1e-6)), int(np.ceil(self.window.y1 - 1e-6))
        whole = self.sight.masks.get(name)
        if whole is None:
            return np.zeros((y1 - y0, x1 - x0), bool), (x0, y0)
        return whole[y0:y1, x0:x1], (x0, y0)

    def count(self, name: str) -> int:
        """How many pixels of the view show a thing inside the picture."""
        return int(self.mask(name)[0].sum())

    def box(self, name: str) -> Box | None:
        """Tight round what shows of a thing [picture px]; None where it does not show."""
        mask, (x, y) = self.mask(name)
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        if mask.sum() < LEAST_PX:
            return None
        box = Box(x + columns[0], y + rows[0], x + columns[-1] + 1, y + rows[-1] + 1)
        return self.picture.frame.box_to_picture(box)

    def at(self, point: Point, names: Sequence[str] | None = None) -> str | None:
        """The thing that shows at a point [picture px]."""
        x, y = self.picture.frame.point_to_view(point)
        if not self.window.contains((x, y)):
            return None
        width, height = self.sight.view.size_px
        column, row = min(int(x), width - 1), min(int(y), height - 1)
        for name in self.sight.masks if names is None else names:
            if self.sight.masks[name][row, column]:
                return name
        return None

    def project(self, position_m: Array) -> Point | None:
        """Where a point of the base frame shows [picture px]; None without a camera."""
        camera = self.sight.view.camera
        if camera is None:
            return None
        x, y = camera.project(np.asarray(position_m, dtype=float)[None])[0]
        return self.picture.frame.point_to_picture((float(x), float(y)))

    def inside(self, point: Point) -> bool:
        """Whether a point [picture px] lies in the part that shows the view."""
        return self.picture.frame.valid.contains(point)

    def middle(self, name: str) -> Point | None:
        """The point of what shows of a thing that is farthest from its edges [picture px]."""
        mask, (x, y) = self.mask(name)
        if mask.sum() < LEAST_PX:
            return None
        depth = cv2.distanceTransform(np.pad(mask, 1).astype(np.uint8), cv2.DIST_L2, 5)[1:-1, 1:-1]
        row, column = np.unravel_index(int(depth.argmax()), depth.shape)
        return self.picture.frame.point_to_picture((x + column + 0.5, y + row + 0.5))

    def grasp(self, name: str) -> Point | None:
        """Where to take hold of a thing [picture px]: its true grasp point where that shows, else the middle of what shows."""
        thing = self.thing(name)
        point = None if thing is None else self.project(thing.grasp_m)
        if point is not None and self.inside(point) and self.at(point, (name,)) is not None:
            return point
        return self.middle(name)

    def centre(self, name: str) -> Point | None:
        """Where a thing's own centre is [picture px], hidden or not; that of its box where nobody knows better."""
        thing = self.thing(name)
        point = None
        if thing is not None:
            x, y, _ = thing.position_m
            point = self.project(np.array([x, y, thing.height_m]))
        if point is None:
            box = self.box(name)
            return None if box is None else box.centre
        return point

    def position(self, name: str) -> Point | None:
        """What a list gives as a thing's position [picture px]: its centre; of one that can be carried and has a hole there,
        where it can be held.
        """
        thing, centre = self.thing(name), self.centre(name)
        if centre is None or thing is None or thing.kind != "object" or self.at(centre, (name,)) is not None:
            return centre
        return self.grasp(name)


@dataclass(frozen=True, eq=False)
class _Known:
    """What a picture was found to show, while its pixels live; a blind one is looked at again after the next look."""

    pixels: weakref.ref[Array]
    frame: Frame
    sight: GroundTruthView | None
    newest: GroundTruthView

    def holds(self, picture: Picture, newest: GroundTruthView) -> bool:
        same = self.frame is picture.frame or (
            self.frame.view_id == picture.frame.view_id
            and np.array_equal(self.frame.T_view_picture, picture.frame.T_view_picture)
        )
        return self.pixels() is picture.rgb and same and (self.sight is not None or self.newest is newest)


class Eyes:
    """Finds the sight behind a picture; remembers it for as long as the pixels live."""

    def __init__(self, truth: SceneTruth) -> None:
        self.truth = truth
        self._known: dict[int, _Known] = {}

    def see(self, picture: Picture) -> Seen | None:
        """What a picture shows; None when its pixels are not those of any look at its view."""
        observation_log = self.truth.observation_log(picture.frame.view_id)
        if not observation_log:
            return None
        sight = self._match(picture, observation_log)
        return None if sight is None else Seen(picture, sight, observation_log[0], self.truth)

    def _match(self, picture: Picture, observation_log: Sequence[GroundTruthView]) -> GroundTruthView | None:
        source = picture.source if isinstance(picture, LaterPicture) else None
        if source is not None:
            # Nobody has put other pixels into it: they are this view's, seen through this frame.
            own = next((sight for sight in observation_log if sight.view.has_the_pixels_of(source)), None)
            if own is not None:
                return own
        key = id(picture.rgb)
        known = self._known.get(key)
        if known is not None and known.holds(picture, observation_log[0]):
            return known.sight
        found, least = None, float("inf")
        for sight in observation_log:
            right = expected(sight.view.rgb, picture.frame)
            apart = None if right is None else difference(picture.rgb, right, picture.frame.scale)
            if apart is not None and apart < least:
                found, least = sight, apart
            if least == 0.0:
                break
        pixels = weakref.ref(picture.rgb, partial(_forget, weakref.ref(self), key))
        self._known[key] = _Known(pixels, picture.frame, found, observation_log[0])
        return found

    def forget(self, key: int) -> None:
        """A picture's pixels are gone."""
        self._known.pop(key, None)


def _forget(eyes: weakref.ref[Eyes], key: int, _: object) -> None:
    # Not the eyes themselves: they would hold each other in a circle, with all that was seen.
    known = eyes()
    if known is not None:
        known.forget(key)


def _alike(one: GroundTruthView, other: GroundTruthView) -> bool:
    return one.masks.keys() == other.masks.keys() and all(
        np.array_equal(mask, other.masks[name]) for name, mask in one.masks.items()
    )
