"""Nothing answers from truth: change the pixels, leave the words, and the answer must change or say "not here"."""

from __future__ import annotations

import asyncio
from dataclasses import replace

import numpy as np
import pytest

from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import GiveBox, JudgeBox, LocatePoints, Presence, ReadScene, Strip
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import PointMark
from wonderful_team.core.values import Observation, Target
from wonderful_team.models.client import ModelClient
from wonderful_team.offline import OfflineModel
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.planning.boxes import Job
from wonderful_team.planning.session import AgentSession
from wonderful_team.sims.tabletop import make_world

SEED = 4
TARGET = Target("T1", "object", "object shown in {dragged_obj}", source="slot", like=("dragged_obj",), use=("pick",))


@pytest.fixture(scope="module")
def world():
    world = make_world("rotate", seed=SEED)
    yield world
    world.close()


@pytest.fixture(scope="module")
def shown(world):
    return SceneShown(world.observe(), world.instruction, PICK_PLACE, world.limits)


@pytest.fixture(scope="module")
def true_box(world):
    name = world.privileged.truth()["slots"]["dragged_obj"]
    rows, columns = np.nonzero(world.privileged.mask(name))
    return Box(columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)


def ask(shown, question, stage="ground"):
    desk = AgentSession(ModelClient(OfflineModel()), TeamConfig(ablation="s8"), shown.instruction.text)
    return asyncio.run(desk.ask(question, stage=stage))


def noise_like(picture, seed=0):
    rng = np.random.default_rng(seed)
    return replace(picture, rgb=rng.integers(0, 256, picture.rgb.shape).astype(np.uint8), depth_m=None)


def rolled(picture, right_px):
    depth = None if picture.depth_m is None else np.roll(picture.depth_m, right_px, axis=1)
    return replace(picture, rgb=np.roll(picture.rgb, right_px, axis=1), depth_m=depth)


def job(shown, target=TARGET):
    desk = AgentSession(ModelClient(OfflineModel()), TeamConfig(), shown.instruction.text)
    return Job(desk, shown, target, 0, (), shown.examples([target]))


def test_a_right_box_is_accepted_and_the_same_words_over_other_pixels_are_not(shown, true_box):
    work = job(shown)
    crop = work.crop_with("crop", true_box, true_box, "target")
    half_a_box = round(crop.frame.scale * true_box.width / 2)
    decisions = {
        name: ask(shown, JudgeBox(TARGET, picture, work.examples)).decision
        for name, picture in {
            "right": crop,
            "shifted": rolled(crop, half_a_box),
            "noise": noise_like(crop),
            "empty": replace(crop, rgb=np.full_like(crop.rgb, 222), depth_m=None),
        }.items()
    }
    assert decisions["right"] == "accept"
    assert {decisions["shifted"], decisions["noise"], decisions["empty"]} <= {"revise", "reject"}


def test_points_and_boxes_follow_the_pixels(shown, true_box):
    view, examples = shown.labelled, shown.examples([TARGET])
    true_box = view.frame.box_to_picture(true_box)
    # Towards the side with more room, so that the thing stays whole.
    shift = 120 if true_box.centre[0] < view.size_px[0] / 2 else -120
    moved = rolled(view, shift)
    for picture, expected in ((view, 0), (moved, shift)):
        point = ask(shown, LocatePoints(TARGET, "centre", (), picture, (), examples)).points[0]
        assert abs(point.x - (true_box.centre[0] + expected)) < true_box.width / 2
        centre = (true_box.centre[0] + expected, true_box.centre[1])
        box = ask(shown, GiveBox(TARGET, (), picture.marked(PointMark(centre, "centre")), examples)).box
        assert box.as_box.iou(true_box.shifted(expected, 0)) > 0.8
        item = ask(shown, ReadScene((TARGET,), (), picture, (), examples)).targets[0]
        assert item.box.as_box.iou(true_box.shifted(expected, 0)) > 0.8


def test_noise_instead_of_the_view_is_not_here(shown):
    examples = shown.examples([TARGET])
    noise = noise_like(shown.labelled)
    assert ask(shown, LocatePoints(TARGET, "centre", (), noise, (), examples)).found is False
    assert ask(shown, ReadScene((TARGET,), (), noise, (), examples)).targets[0].found is False
    assert ask(shown, GiveBox(TARGET, (), noise.marked(PointMark((100, 100))), examples)).box is None


def test_strips_are_read_from_their_own_pixels(shown, true_box):
    work = job(shown)
    cut = true_box.grown(0, 0, -true_box.width * 0.4, 0)  # the right part of the thing sticks out
    strips = work.strips(cut)
    right = {item.edge: item for item in ask(shown, Presence(TARGET, strips, work.examples)).edges}["right"]
    assert right.outside is True
    swapped = tuple(
        Strip(strip.edge, strip.side, noise_like(strip.picture)) if strip.edge == "right" else strip for strip in strips
    )
    noisy = {item.edge: item for item in ask(shown, Presence(TARGET, swapped, work.examples)).edges}["right"]
    assert (noisy.inside, noisy.outside) != (right.inside, right.outside)


def test_a_team_that_is_shown_noise_finds_nothing_and_moves_nothing(world):
    seen = world.observe()
    noisy = Observation(
        {name: replace(view, rgb=noise_like_view(view), depth_m=None) for name, view in seen.views.items()}
    )
    plan = asyncio.run(TeamPolicy(OfflineModel()).make_plan(noisy, world.instruction, PICK_PLACE, world.limits))
    assert plan.status == "needs_clarification"
    assert plan.actions == ()


def noise_like_view(view):
    return np.random.default_rng(1).integers(0, 256, view.rgb.shape).astype(np.uint8)
