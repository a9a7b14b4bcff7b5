"""Free areas in a crop: is the box on free table, and where is the freest place near it?"""

from __future__ import annotations

from wonderful_team.geometry import Box
from wonderful_team.models.offline.vision import BoxFit, Scene, free_spots, see
from wonderful_team.pictures import Picture, Point

FREE_ENOUGH = 0.08
"""Share of a box that things may cover while it still counts as free."""


def judge_area(crop: Picture, box: Box) -> BoxFit:
    """How free the box is, by what lies in it."""
    scene = see(crop)
    covered, under = 0.0, None
    for thing in scene.objects:
        shared = thing.box.intersection(box)
        if shared is not None and shared.area / box.area > covered:
            covered, under = shared.area / box.area, thing
    if covered <= FREE_ENOUGH:
        return BoxFit(
            "tight", None, box, 1.0, None, (), (), 1.0 - covered, f"free table: {covered:.0%} of the box is covered"
        )
    spot = nearest_free(scene, box)
    best = Box.around(spot, box.width, box.height)
    seen = under.look.words if under is not None else "something"
    return BoxFit(
        "empty", None, best, best.iou(box), under, (), (), 1.0 - covered, f"a {seen} covers {covered:.0%} of the box"
    )


def nearest_free(scene: Scene, box: Box) -> Point:
    """The free place nearest to the middle of a box; its middle itself when the picture shows none."""
    radius = 0.5 * min(box.width, box.height)
    spots = free_spots(scene, radius_px=radius, count=30) or free_spots(scene, radius_px=0.6 * radius, count=30)
    if not spots:
        return box.centre
    cx, cy = box.centre
    return min((spot.point for spot in spots), key=lambda point: (point[0] - cx) ** 2 + (point[1] - cy) ** 2)
