"""Do what a sequence of pictures shows, step by step: one thing that travels, or things that are stacked."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import CrowdedError, Scene, Spot
from wonderful_team.sims.tabletop.showing import Stand
from wonderful_team.sims.tabletop.tasks.choices import L4, L123, kit_shapes, kit_textures, one_of, some_of

WAYPOINTS, RADIUS_M, FRAMES = 5, 0.19, 3
HORIZON = 6
FLAT = ("block", "letter E", "cross", "diamond", "flower", "heart", "hexagon", "pentagon", "round", "star")
"""Shapes with a middle that others can stand on."""


def waypoint(number: int) -> Spot:
    """One of five points on a circle round the middle of the table [m]."""
    angle = 2 * math.pi * number / WAYPOINTS
    return 0.5 + RADIUS_M * math.sin(angle), RADIUS_M * math.cos(angle)


@task(
    "follow_motion",
    instruction="Follow this motion for {dragged_obj}: {frame_0} {frame_1} {frame_2}.",
    horizon=HORIZON,
    partitions=L4,
)
def follow_motion(scene: Scene, rng: np.random.Generator) -> None:
    """Move a pictured thing through the places that the frames show, one place an action; another thing stands by."""
    scene.order, scene.goals_last = "every action", True
    cover, other = scene.pick_textures(2, kit_textures(scene))
    spots = [waypoint(int(k)) for k in rng.choice(WAYPOINTS, size=FRAMES, replace=False)]
    yaw = float(scene.layout.integers(4)) * math.pi / 2
    carried = scene.add(one_of(rng, kit_shapes(scene)), cover, at=spots[0], yaw_rad=yaw)
    bystander = scene.add(one_of(rng, kit_shapes(scene)), other)
    if any(math.dist((bystander.x_m, bystander.y_m), spot) < 0.2 for spot in spots):
        raise CrowdedError("the thing that stands by is in the way of the motion")
    for k, spot in enumerate(spots):
        moved = {carried: Stand(carried.name, spot, yaw)} if k > 0 else {}
        scene.show_table(f"frame_{k}", moved=moved, kind="frame", index=k)
        if k > 0:
            scene.goal(carried, at=spot)
            scene.then()
    scene.show(dragged_obj=carried)


@task(
    "follow_order",
    instruction="Stack objects in this order {frame_0} {frame_1} {frame_2}.",
    horizon=HORIZON,
    partitions=L123,
)
def follow_order(scene: Scene, rng: np.random.Generator) -> None:
    """Stack things in the order that the frames show, one move an action; a fourth thing is left alone."""
    scene.order, scene.goals_last = "every action", True
    scene.apart_m = 0.16
    covers = scene.pick_textures(4, kit_textures(scene))
    flat = kit_shapes(scene, FLAT)
    things = [scene.add(one_of(rng, flat), cover) for cover in covers]
    low, middle, top, _ = some_of(rng, [thing.name for thing in things], 4)
    by_name = {thing.name: thing for thing in things}
    under = by_name[low]
    scene.show_table("frame_0", kind="frame", index=0)
    moved, height = {}, under.body.height_m
    for k, name in enumerate((middle, top), start=1):
        thing = by_name[name]
        moved[thing] = Stand(name, (under.x_m, under.y_m), thing.yaw_rad, height)
        height += thing.body.height_m
        scene.show_table(f"frame_{k}", moved=dict(moved), kind="frame", index=k)
        scene.goal(thing, near=under)
        scene.then()
