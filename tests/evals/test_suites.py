"""Suites by name, seeds, shards, photos and what they refuse."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from wonderful_team.core.caps import Caps
from wonderful_team.core.geometry import AffineCamera, Box, PinholeCamera, Pose
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.evals.estimate import estimate
from wonderful_team.evals.perturb import moved, read_tiers
from wonderful_team.evals.photos import Located, read_photos, score_photo
from wonderful_team.evals.plan import StudyPlan, read_shard
from wonderful_team.evals.suites import VIMA_TASKS, all_suites, default_seeds, read_seeds, resolve
from wonderful_team.evals.trials import Condition, Row, TrialRow, TrialSpec
from wonderful_team.registry.role_models import choice_of, read_choices, text_of

KNOWN = [
    "tabletop/rotate",
    "tabletop/visual_manipulation",
    "tabletop/fruit_placement/both",
    "tabletop/fruit_placement/no_area",
]


def _is_own(name: str) -> bool:
    return ".py:" in name


def test_suites_grow_with_the_registered_tasks_and_say_what_is_missing() -> None:
    suites = all_suites(KNOWN)
    assert suites["vima17"].tasks == ("tabletop/visual_manipulation", "tabletop/rotate")
    assert "15 of its 17 tasks do not exist yet" in suites["vima17"].note
    whole = all_suites([f"tabletop/{name}" for name in VIMA_TASKS])
    assert len(whole["vima17"].tasks) == 17
    assert whole["vima17"].note == ""
    assert len(suites["fruit"].tasks) == 2
    assert "companions" not in suites
    goals = [f"tabletop/{folder}/one" for folder in ("superhero_companions", "fruit_price_ranking")]
    assert all_suites([*KNOWN, *goals])["implicit"].tasks == (*KNOWN[2:], *goals)


def test_implicit_goals_on_the_arm_are_suites_of_their_own() -> None:
    goals = [f"arms/{folder}/{one}" for folder in ("fruit_placement", "fruit_price_ranking") for one in ("a", "b")]
    suites = all_suites([*KNOWN, *goals])
    assert suites["prices/arm"].tasks == tuple(goals[2:])
    assert suites["implicit/arm"].tasks == tuple(goals)
    assert suites["implicit"].tasks == tuple(KNOWN[2:])
    assert suites["implicit/arm"].protocol == suites["implicit"].protocol


def test_spatial_planning_is_run_closed_loop() -> None:
    known = [*KNOWN, "arms/star", "arms/wipe", "arms/block_in_bowl"]
    suites = all_suites(known)
    assert suites["spatial"].tasks == ("arms/star", "arms/wipe")
    assert (suites["spatial"].protocol.runs, suites["spatial"].protocol.replans) == (5, 3)
    alone, other = resolve(["arms/star", "arms/block_in_bowl"], known, suites, _is_own)
    assert (alone.protocol.replans, other.protocol.replans) == (3, 0)


def test_the_papers_protocols() -> None:
    suites = all_suites(KNOWN)
    assert default_seeds(suites["vima17"].protocol) == tuple(range(1000, 1010))
    assert default_seeds(suites["fruit"].protocol) == (1000, 1001)
    assert suites["vima17"].protocol.replans == 0


def test_names_of_suites_tasks_and_files() -> None:
    suites = all_suites(KNOWN)
    found = resolve(["fruit", "rotate", "mine.py:cups"], KNOWN, suites, _is_own)
    assert [suite.tasks[0] for suite in found] == [KNOWN[2], "tabletop/rotate", "mine.py:cups"]
    with pytest.raises(UnknownNameError, match="rotate"):
        resolve(["rotat"], KNOWN, suites, _is_own)
    with pytest.raises(ConfigError, match="no such file"):
        resolve(["photos.json"], KNOWN, suites, _is_own)


@pytest.mark.parametrize("words", ["", "5:5", "a:b", "1,1", "-3", "3:1"])
def test_bad_seeds_are_refused(words: str) -> None:
    with pytest.raises(ConfigError, match="seeds"):
        read_seeds(words)


def test_seeds_shards_and_caps() -> None:
    assert read_seeds("1000:1003,7") == (1000, 1001, 1002, 7)
    assert read_shard("2/4") == (2, 4)
    for words in ("5/4", "0/4", "1", "a/b"):
        with pytest.raises(ConfigError, match="shard"):
            read_shard(words)
    with pytest.raises(ConfigError, match="positive"):
        Caps(calls=0)


def test_controls_stand_in_every_study_unless_refused() -> None:
    suites = resolve(["rotate"], KNOWN, all_suites(KNOWN), _is_own)
    methods = {(c.method, c.model) for c in StudyPlan(suites, ("mine.py:A",), ("m",)).conditions(suites[0])}
    assert methods == {("mine.py:A", "m"), ("oracle", "-"), ("no-op", "-"), ("random", "-"), ("team", "offline")}
    bare = StudyPlan(suites, ("mine.py:A",), ("m",), controls=()).conditions(suites[0])
    assert [c.method for c in bare] == ["mine.py:A"]


def test_an_estimate_multiplies_means_and_says_which_gaps_show() -> None:
    suites = resolve(["rotate"], KNOWN, all_suites(KNOWN), _is_own)
    plan = StudyPlan(suites, ("team",), ("m",), tuple(range(1000, 1050)), controls=())
    condition = Condition("team", "m")
    ended = Row(
        TrialSpec("tabletop/rotate", 1000, condition),
        TrialRow("success", calls=8, tokens=1000, usd=0.1, seconds=36.0),
    )
    found = estimate(plan, [ended], {}, workers=2)
    assert found.total("calls") == 49 * 8
    assert found.total("usd") == pytest.approx(4.9)
    assert found.hours == pytest.approx(49 * 36 / 2 / 3600)
    assert found.pairs == 50
    assert "with 50 scenes per method you can see gaps of about" in found.text()
    dearer = Row(
        TrialSpec("tabletop/rotate", 1001, condition), TrialRow("failure", calls=20, tokens=3000, seconds=36.0)
    )
    both = estimate(plan, [ended, dearer], {}, workers=2)
    assert (both.total("calls"), both.bounds("calls")) == (48 * 14, (48 * 8, 48 * 20))
    assert "672 calls (384 to 960), 96,000 tokens (48,000 to 144,000)" in both.text()
    blind = estimate(plan, [], {}, workers=2)
    assert blind.bounds("calls") is None
    assert blind.total("usd") is None
    assert "unknown USD" in blind.text()


def _photos(folder: Path) -> Path:
    cv2.imwrite(str(folder / "a.png"), np.full((60, 80, 3), 200, np.uint8))
    annotations = [
        {"image_id": 1, "bbox": [10, 10, 20, 20], "instruction": "red block"},
        {"image_id": 1, "bbox": [50, 30, 10, 10], "category_id": 4},
    ]
    coco = {
        "images": [{"id": 1, "file_name": "a.png"}],
        "annotations": annotations,
        "categories": [{"id": 4, "name": "cup"}],
    }
    path = folder / "photos.json"
    path.write_text(json.dumps(coco), encoding="utf-8")
    return path


def test_photos_are_scored_by_boxes_and_points(tmp_path: Path) -> None:
    (scene,) = read_photos(str(_photos(tmp_path)))
    assert [asked.words for asked in scene.asked] == ["red block", "cup"]
    right = score_photo(scene, [Located(Box(11, 11, 30, 30)), Located(None, (55.0, 35.0))])
    assert right.outcome == "success"
    assert right.facts["points inside"] == 1.0
    wrong = score_photo(scene, [Located(Box(11, 11, 30, 30)), Located()])
    assert (wrong.outcome, wrong.stage, wrong.reason) == ("failure", "grounding", "cup: not found")


def test_bad_photo_files_are_told(tmp_path: Path) -> None:
    path = _photos(tmp_path)
    coco = json.loads(path.read_text(encoding="utf-8"))
    for name, change, words in (
        ("b", {"annotations": [{"image_id": 1, "bbox": [1, 1, 0, 5], "instruction": "x"}]}, "is empty"),
        ("c", {"annotations": [{"image_id": 1, "bbox": [1, 1, 5, 5]}]}, "neither instruction nor category"),
        ("d", {"images": [{"id": 1, "file_name": "none.png"}]}, "there is no file"),
        ("e", {"images": []}, "valid is COCO JSON"),
    ):
        bad = tmp_path / f"{name}.json"
        bad.write_text(json.dumps({**coco, **change}), encoding="utf-8")
        with pytest.raises(ConfigError, match=words):
            read_photos(str(bad))


@pytest.mark.parametrize("words", ["fog=1", "lighting", "lighting=4", "lighting=x", "lighting=0..7"])
def test_unknown_perturbations_are_refused(words: str) -> None:
    with pytest.raises(ConfigError, match="KIND=0..3"):
        read_tiers([words])


def test_tiers_and_isolated_parts_are_conditions_of_their_own() -> None:
    assert read_tiers(["clutter=0..2,paraphrase=3"]) == ("", "clutter=1", "clutter=2", "paraphrase=3")
    assert read_tiers([]) == read_tiers(["texture=0"]) == ("",)
    suites = resolve(["rotate"], KNOWN, all_suites(KNOWN), _is_own)
    plan = StudyPlan(
        suites,
        ("team",),
        ("m",),
        controls=("oracle",),
        isolate=("", "planning"),
        perturb=("", "clutter=2"),
        how="thinking low",
    )
    labels = [one.label for one in plan.conditions(suites[0])]
    assert labels == [
        "team · m · thinking low",
        "team · m · planning alone · thinking low",
        "team · m · clutter=2 · thinking low",
        "team · m · planning alone · clutter=2 · thinking low",
        "oracle",
        "oracle · clutter=2",
    ]
    assert len({spec.key for spec in plan.trials()}) == 6 * 10
    with pytest.raises(ConfigError, match="valid are whole, planning, grounding"):
        StudyPlan(suites, isolate=("memory",))


def test_models_by_role_have_one_text_that_says_who_answers_what() -> None:
    assert read_choices(["a,b", "checker=c"], "offline") == ("a, checker=c", "b, checker=c")
    assert read_choices(["a", "a,checker=c,mover=d"], "offline") == ("a", "a, checker=c, mover=d")
    assert read_choices(["mover=d", "checker=c"], "offline") == ("offline, checker=c, mover=d",)
    assert read_choices(["http://h:1/v1#x"], "offline") == ("http://h:1/v1#x",)
    text = text_of({"mover": "d", "*": "a", "checker": "c", "memory": "a"})
    assert text == "a, checker=c, mover=d", "roles in their own order; a role that names the rest's model says nothing"
    assert choice_of(text) == {"*": "a", "checker": "c", "mover": "d"}
    assert choice_of("a") == "a"
    with pytest.raises(UnknownNameError, match="checker"):
        read_choices(["chequer=c"], "offline")
    with pytest.raises(ConfigError, match="two models for checker"):
        read_choices(["a,checker=c", "checker=d"], "offline")


def test_a_moved_camera_sees_points_where_the_picture_shows_them() -> None:
    A = cv2.getRotationMatrix2D((40.0, 30.0), 8.0, 0.9)
    affine = AffineCamera(np.array([[0, 100.0, 0, 40], [100.0, 0, 0, 10], [0, 0, -1, 1.0]]))
    pinhole = PinholeCamera(np.array([[90.0, 0, 40], [0, 90.0, 30], [0, 0, 1]]), Pose.at((0.2, 0.1, 1.0), 0.0))
    points = np.array([(0.3, 0.1, 0.0), (0.1, -0.2, 0.05)])
    for camera in (affine, pinhole):
        if isinstance(camera, PinholeCamera):
            points = camera.deproject([(30.0, 20.0), (55.0, 41.0)], [1.0, 0.8])
        before = camera.project(points)
        assert np.allclose(moved(camera, A).project(points), before @ A[:, :2].T + A[:, 2])


def test_looks_are_part_of_what_a_trial_is_and_leave_earlier_trials_alone() -> None:
    suites = resolve(["rotate"], KNOWN, all_suites(KNOWN), _is_own)
    plain, looking = (
        StudyPlan(suites, ("team",), ("m",), controls=("oracle",), reobserve=reobserve) for reobserve in (0, 8)
    )
    team, oracle = looking.conditions(suites[0])
    assert (team.reobserve, oracle.reobserve) == (8, 0)
    assert team.label == "team · m · reobserve 8"
    specs = [TrialSpec("tabletop/rotate", 1000, plan.conditions(suites[0])[0]) for plan in (plain, looking)]
    assert specs[0].key == '["tabletop/rotate", 1000, 0, "team", "m", "", "", 0]'
    assert specs[0].key != specs[1].key
    with pytest.raises(ConfigError, match="reobserve must be 0 or more, got -1"):
        StudyPlan(suites, reobserve=-1)
