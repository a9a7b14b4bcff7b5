"""The truth of an episode, for scorers and simulated models only: asked of the simulator when it is needed, never before."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from wonderful_team.core.actions import Action, PickPlace
from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Score
from wonderful_team.core.values import GroundTruthView, Observation, TrueThing
from wonderful_team.sims.arms.oracle import arm_actions
from wonderful_team.sims.fetch.scene import (
    BOX_NAME,
    LID_NAME,
    ORIGIN_M,
    FetchScene,
    body_name,
    footprint,
    room_for_lid,
)
from wonderful_team.sims.fetch.scoring import LID_TOP_M, Track, inside, leans_rad, lid_on, lid_on_table, score_of
from wonderful_team.sims.fetch.things import BOX, BOX_INSIDE_M, HANDLE, HANDLE_M, LID, LID_M, RIM_M, Kind
from wonderful_team.sims.process.client import Simulator

HANDLE_NAME, HANDLE_WORDS = "handle", "black handle"
HANDLE_KIND = Kind(HANDLE_WORDS, (), (HANDLE_M[0] / 2, HANDLE_M[1] / 2), HANDLE_M[2], 0.0)
GAP_M = 0.006
"""Between two things in the box [m]."""
LYING_RAD = math.radians(30)
"""What leans by more lies: it cannot be gripped as it stood."""


@dataclass(eq=False)
class Episode:
    """What a world and its truth both know; it grows.

    Attributes:
        looks: What could be seen, and by which number the simulator kept it.
        closings: How often the fingers were closed.
    """

    task: str
    seed: int
    scene: FetchScene
    looks: list[tuple[Observation, int]] = field(default_factory=list)
    closings: int = 0


class FetchTruth:
    """Implements the SceneTruth protocol for one episode.

    The lid is known by what it is gripped by, its handle: its plate belongs to the box as long as it lies on it.
    """

    def __init__(self, simulator: Simulator, episode: Episode) -> None:
        self._simulator, self._episode = simulator, episode
        self._names = {body_name(episode.scene, name): name for name in episode.scene.things}
        self._sights: dict[tuple[str, int], GroundTruthView] = {}

    def score(self) -> Score:
        """Success, or failure with its stage: from where things are now and how they moved."""
        poses, touched = self._poses(None)
        return score_of(self._episode.scene, poses, touched, self.track(), self._episode.closings)

    def track(self) -> Track:
        """How everything moved so far."""
        _, arrays = self._simulator.ask("track")
        rows = np.array(arrays["track"])
        rows[:, :, :3] -= ORIGIN_M
        names = list(self._names.values())
        return Track(
            {name: rows[:, k, :7] for k, name in enumerate(names)},
            {name: rows[:, k, 7] > 0.5 for k, name in enumerate(names)},
        )

    def truth(self) -> Mapping[str, Any]:
        """Things with true poses, and what is asked, as plain values."""
        poses, touched = self._poses(None)
        scene = self._episode.scene
        return {
            "task": self._episode.task,
            "seed": self._episode.seed,
            "things": {
                name: {
                    "words": one.kind.words,
                    "position_m": tuple(float(v) for v in poses[name].position_m),
                    "yaw_rad": poses[name].yaw_rad,
                    "height_m": one.kind.height_m,
                    "in_box": name not in (BOX_NAME, LID_NAME) and inside(one.kind, poses[name], poses[BOX_NAME]),
                }
                for name, one in scene.things.items()
            },
            "wanted": scene.wanted,
            "lid_on": lid_on(poses),
            "touched": touched,
        }

    def things(self) -> Mapping[str, TrueThing]:
        """Everything on the table as it stands now, by name."""
        return self._true(self._poses(None)[0])

    def start(self) -> Mapping[str, TrueThing]:
        """The same, as it stood when the world was made."""
        return self._true(self._poses(self._episode.looks[0][1])[0])

    def observation_log(self, view_id: str) -> Sequence[GroundTruthView]:
        """What really was in every look at a view so far, newest first; () for an unknown id."""
        looks = [(observation, number) for observation, number in self._episode.looks if view_id in observation.views]
        return tuple(self._sight(observation, number, view_id) for observation, number in reversed(looks))

    def oracle(self) -> Sequence[Action]:
        """Actions that solve the scene from here; [] when it is solved, or no way is known."""
        poses, _ = self._poses(None)
        scene, box = self._episode.scene, poses[BOX_NAME]
        left = [name for name in scene.wanted if not inside(scene.things[name].kind, poses[name], box)]
        actions: list[Action] = []
        if lid_on_table(poses):
            lid = poses[LID_NAME]
            others = {
                name: footprint(one.kind, *_xy(poses[name]), poses[name].yaw_rad)
                for name, one in scene.things.items()
                if name != LID_NAME
            }
            free = room_for_lid(others, _xy(lid))
            if free is None or leans_rad(lid) > LYING_RAD:
                return []
            top = lid.apply(np.array([(0.0, 0.0, LID.height_m)]))[0]
            actions += arm_actions(PickPlace(top, np.array([*free, LID_M[2]])), 0.0, HANDLE_M[2])
        height = LID_TOP_M if lid_on(poses) else RIM_M
        for place, name in enumerate(left):
            kind, pose = scene.things[name].kind, poses[name]
            if leans_rad(pose) > LYING_RAD:
                return []
            top = pose.apply(np.array([(*kind.grasp_m, kind.height_m)]))[0]
            aside = self._aside(poses, name, left[1 - place] if len(left) > 1 else "", -1.0 if place == 0 else 1.0)
            end = box.apply(np.array([(0.0, aside, height)]))[0]
            grasp = pose.apply(np.array([(*kind.grasp_m, 0.0)]))[0] - pose.position_m
            actions += arm_actions(PickPlace(top, end + np.array([*grasp[:2], 0.0])), 0.0, kind.height_m)
        return actions

    def _aside(self, poses: Mapping[str, Pose], name: str, other: str, side: float) -> float:
        """Where along the box's longer side a thing goes [m]: beside the other that goes there too, or away from what lies there."""
        scene, box = self._episode.scene, poses[BOX_NAME]
        half_m = {one: max(scene.things[one].kind.half_m) for one in scene.wanted}
        if other:
            return side * (half_m[name] + half_m[other] + GAP_M) / 2
        for one in scene.wanted:
            if one != name and inside(scene.things[one].kind, poses[one], box):
                lies_m = float(((poses[one].position_m - box.position_m) @ box.rotation)[1])
                most_m = BOX_INSIDE_M[1] / 2 - half_m[name] - GAP_M
                away_m = math.copysign(half_m[name] + half_m[one] + GAP_M, -lies_m)
                return float(np.clip(lies_m + away_m, -most_m, most_m))
        return 0.0

    def _poses(self, look: int | None) -> tuple[dict[str, Pose], tuple[str, ...]]:
        said, arrays = self._simulator.ask("poses", look=look)
        rows = arrays["poses"]
        poses = {name: Pose(row[:3] - ORIGIN_M, row[3:]) for name, row in zip(self._names.values(), rows, strict=True)}
        return poses, tuple(self._names[body] for body in said["touched"])

    def _true(self, poses: Mapping[str, Pose]) -> dict[str, TrueThing]:
        on = lid_on(poses)
        found = {}
        for name, one in self._episode.scene.things.items():
            if name == LID_NAME:
                continue
            covered = name == BOX_NAME and on
            height = LID_TOP_M if covered else one.kind.height_m
            kind = LID if covered else one.kind
            grasp = (BOX.half_m[0], 0.0) if name == BOX_NAME else one.kind.grasp_m
            found[name] = _thing(name, one.kind.words, kind, poses[name], height, grasp)
        lid = poses[LID_NAME]
        if not on:
            found[LID_NAME] = _thing(LID_NAME, "blue lid", LID, lid, LID_M[2], (LID_M[0] / 3, LID_M[1] / 3))
        foot = Pose(lid.apply(np.array([(0.0, 0.0, LID_M[2])]))[0], lid.quaternion_wxyz)
        found[HANDLE_NAME] = _thing(HANDLE_NAME, HANDLE_WORDS, HANDLE_KIND, foot, HANDLE_M[2], (0.0, 0.0))
        return found

    def _sight(self, observation: Observation, number: int, camera: str) -> GroundTruthView:
        key = (camera, number)
        if key not in self._sights:
            said, arrays = self._simulator.ask("masks", look=number, camera=camera)
            poses, _ = self._poses(number)
            things = self._true(poses)
            owners = [self._owner(str(geom), LID_NAME in things) for geom in said["names"]]
            shown = arrays["geoms"]
            masks = {name: np.isin(shown, [k for k, owner in enumerate(owners) if owner == name]) for name in things}
            self._sights[key] = GroundTruthView(observation.views[camera].without_depth(), masks, things)
        return self._sights[key]

    def _owner(self, geom: str, lid_is_off: bool) -> str:
        body, _, part = geom.rpartition(":")
        name = self._names[body]
        if name != LID_NAME:
            return name
        if int(part) == HANDLE:
            return HANDLE_NAME
        return LID_NAME if lid_is_off else BOX_NAME


def _thing(name: str, words: str, kind: Kind, pose: Pose, height_m: float, grasp_m: tuple[float, float]) -> TrueThing:
    """A thing as it stands: its foot's middle is its place, its height that of its top over the table."""
    shape = footprint(kind, *_xy(pose), pose.yaw_rad)
    outline: Array = np.array(shape.exterior.coords[:-1])
    top = pose.apply(np.array([(*grasp_m, height_m)]))[0]
    return TrueThing(
        name, words, "container" if name == BOX_NAME else "object", name, words.split()[0], pose.position_m, pose.yaw_rad,
        float(pose.position_m[2]) + height_m, outline, top,
    )  # fmt: skip


def _xy(pose: Pose) -> tuple[float, float]:
    return float(pose.position_m[0]), float(pose.position_m[1])
