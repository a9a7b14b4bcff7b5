"""The page's drawings of motion: the gate's clearances, the robot's own positions, fingers to scale; nothing is made up."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.pages.arm_run import FINGERS, PX_PER_M, ArmWorld, Carrying
from tests.pages.test_page import read
from wonderful_team.pages import write_page
from wonderful_team.pages.fingers import _planned, pads_m
from wonderful_team.pages.height_profile import profile_drawing
from wonderful_team.pages.legs import Leg, corners_of, distance_to, leg_of
from wonderful_team.record import Recorder
from wonderful_team.runtime import rollout

NUMBER = r"-?\d+(?:\.\d+)?"


def ran(folder: Path, **options: Any) -> tuple[dict[str, Any], str]:
    """The record and the page of a run."""
    with Recorder(folder) as recorder:
        trial = rollout(Carrying(), ArmWorld(**options), subscribers=[recorder])
    assert trial.reports, trial.reason
    record = json.loads((folder / "record.json").read_text(encoding="utf-8"))
    return record, write_page(folder).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("arm")
    ran(path, off={6: 0.0123})
    return path


def test_the_smallest_clearance_on_the_page_is_the_gates(folder: Path) -> None:
    record = json.loads((folder / "record.json").read_text(encoding="utf-8"))
    _, text = read(folder / "page.html")
    (gate,) = [gate for gate in record["planner"]["gates"] if gate.get("profiles")]
    past = next(one for one in gate["profiles"] if one["action"] == 5)
    assert past["surface_m"][past["nearest"]] == pytest.approx(0.12, abs=2e-3)
    assert f"Smallest clearance: {1000 * past['clearance_m']:.0f} mm, in action 6" in text
    check = next(check for check in gate["checks"] if check["action"] == 5 and check["name"] == "under the way")
    assert check["value"] == f"{past['clearance_m']:+.3f} m over what is seen"
    html = (folder / "page.html").read_text(encoding="utf-8")
    assert f'class="least-label" font-size="12.00">{1000 * past["clearance_m"]:.0f} mm</text>' in html


def test_the_largest_deviation_is_the_robots_own(folder: Path) -> None:
    _, text = read(folder / "page.html")
    assert "Largest deviation from the plan: 12.3 mm, in action 6" in text


def test_fingers_are_to_scale_with_their_numbers(folder: Path) -> None:
    _, text = read(folder / "page.html")
    for words in ("opening, planned 85 mm", "each finger 20 by 20 mm", "held, measured 39.1 mm", "Action 4"):
        assert words in text, words
    assert re.search(r"yaw, planned \d+\.\d° (anti)?clockwise", text)
    html = (folder / "page.html").read_text(encoding="utf-8")
    for css, opening in (("planned", 0.085), ("measured", 0.0391)):
        pads = [np.array([pair.split(",") for pair in points.split()], dtype=float) for points in
                re.findall(rf'<polygon points="([^"]*)" class="pad {css}">', html)]  # fmt: skip
        assert len(pads) == 2
        between = float(np.linalg.norm(pads[0].mean(axis=0) - pads[1].mean(axis=0)))
        assert between == pytest.approx((opening + FINGERS.thickness_m) * PX_PER_M, abs=0.05)
        sides = np.linalg.norm(pads[0] - np.roll(pads[0], 1, axis=0), axis=1)
        assert sides == pytest.approx([0.02 * PX_PER_M] * 4, abs=0.05)


def test_a_second_grip_tells_how_the_gripper_was_turned_after_the_move() -> None:
    move = {"type": "MoveTo", "pose": {"position_m": [0.4, 0.0, 0.1], "quaternion_wxyz": [1.0, 0.0, 0.0, 0.0]}}
    told = [{"how": "gripped across 30 mm, turned 0 degrees clockwise"}]
    closing = {"type": "Gripper", "state": "close"}
    turn = {"type": "RotateGripper", "yaw_rad": -np.pi / 2}
    actions = [(move, told), (closing, []), ({"type": "Gripper", "state": "open"}, []), (turn, []), (closing, [])]
    content = {"actions": [{"action": action, "sources": sources} for action, sources in actions]}
    first, second = _planned(content, {"opening_m": FINGERS.opening_m}, 1.0)
    assert first.how == told[0]["how"]
    assert second.how == f"{first.how}; then turned 90.0° clockwise"
    assert second.yaw_rad == pytest.approx(-np.pi / 2)


def test_every_drawing_of_motion_says_what_it_shows_and_the_page_stays_whole(folder: Path) -> None:
    reader, _ = read(folder / "page.html")
    assert "motion" in reader.ids
    assert not {"script", "link", "img"} & set(reader.tags)
    described = [value for tag, name, value in reader.attributes if tag == "svg" and name == "aria-label"]
    assert any("Height of the tool along" in words for words in described)
    assert any("planned path of the tool over the table and the measured one" in words for words in described)


def test_a_robot_that_does_not_say_where_it_was_has_no_measured_path(tmp_path: Path) -> None:
    _, html = ran(tmp_path, silent=True, fingers=False)
    _, text = read(tmp_path / "page.html")
    assert "No measured path: this robot does not report where its tool was" in text
    assert "Largest deviation" not in text
    assert 'class="path measured"' not in html
    assert "Fingers at the grasp" not in text
    assert "Smallest clearance" in text


def changed(folder: Path, copy: Path, change: Any) -> str:
    """The words of the page when the record is another."""
    shutil.copytree(folder, copy)
    record = json.loads((copy / "record.json").read_text(encoding="utf-8"))
    change(record["planner"])
    (copy / "record.json").write_text(json.dumps(record), encoding="utf-8")
    return read(write_page(copy))[1]


def test_a_record_of_an_earlier_release_opens_and_says_what_it_lacks(folder: Path, tmp_path: Path) -> None:
    def older(planner: dict[str, Any]) -> None:
        for gate in planner["gates"]:
            gate.pop("profiles", None)

    text = changed(folder, tmp_path / "run", older)
    assert "No path and no heights: the record holds none of the gate's for this plan" in text
    assert "Smallest clearance" not in text
    assert "held, measured 39.1 mm" in text


@pytest.mark.parametrize("value", ["here", [1, 2], [[0, "x", 2]], {"x": 1}, [[1, 2, None]], None])
def test_what_is_no_position_is_not_drawn(folder: Path, tmp_path: Path, value: Any) -> None:
    def broken(planner: dict[str, Any]) -> None:
        for execution in planner["executions"]:
            execution["measured"] = {"path_m": value, "tool_m": value, "held_width_m": "wide"}

    text = changed(folder, tmp_path / "run", broken)
    assert "No measured path" in text
    assert "held, measured not reported" in text


def test_before_anything_ran_the_plan_is_drawn_alone(folder: Path, tmp_path: Path) -> None:
    def planned(planner: dict[str, Any]) -> None:
        planner["executions"], planner["subgoals"] = [], []

    text = changed(folder, tmp_path / "run", planned)
    assert "Smallest clearance" in text
    assert "held, measured not run" in text
    assert "No measured path" not in text


def test_a_plan_in_pixels_has_no_section_of_motion(folder: Path, tmp_path: Path) -> None:
    def in_pixels(planner: dict[str, Any]) -> None:
        for plan in planner["plans"]:
            for planned in plan["plan"]["actions"]:
                planned["action"] = None

    assert "planned and measured" not in changed(folder, tmp_path / "run", in_pixels)


def a_leg(number: int, clearance_m: float | None) -> Leg:
    y = 0.05 * number
    profile = {
        "action": number - 1,
        "points_m": [[0.4, y, 0.1], [0.4, y + 0.02, 0.1], [0.4, y + 0.05, 0.1]],
        "low_m": [0.1, 0.1, 0.1],
        "surface_m": [0.0, None if clearance_m is None else 0.1 - clearance_m, None],
        "goal_m": [None, None, 0.02],
        "clearance_m": clearance_m,
        "least_m": None if clearance_m is None else 0.01,
        "nearest": None if clearance_m is None else 1,
        "stays": True,
    }
    return leg_of(profile, [])


def test_labels_of_a_long_plan_do_not_cover_each_other() -> None:
    legs = [a_leg(number, 0.02 + 0.0005 * number) for number in range(1, 60)]
    drawing = str(profile_drawing(legs))
    plates = re.findall(rf'<rect x="({NUMBER})" y="({NUMBER})" width="({NUMBER})" height="({NUMBER})"', drawing)
    boxes = [tuple(map(float, one)) for one in plates]
    assert len(boxes) > 5
    assert 'class="least-label" font-size="12.00">20 mm' in drawing
    for k, (x, y, w, h) in enumerate(boxes):
        assert 0 <= x
        assert x + w <= 960
        for a, b, c, d in boxes[k + 1 :]:
            assert x + w <= a or a + c <= x or y + h <= b or b + d <= y
    names = re.findall(rf'<text x="({NUMBER})" y="20.00" class="tick" font-size="12.00">(\d+)</text>', drawing)
    assert all(float(b[0]) - float(a[0]) >= 12 for a, b in zip(names[:-1], names[1:], strict=True))


def test_a_surface_that_nothing_is_known_of_is_not_filled() -> None:
    drawing = str(profile_drawing([a_leg(1, None)]))
    (ground,) = re.findall(r'<path d="([^"]*)" class="ground"/>', drawing)
    assert ground.count("M") == 1
    assert "least-label" not in drawing


def test_distances_and_corners_are_those_of_the_path() -> None:
    path = np.array([[0, 0, 0], [0.1, 0, 0], [0.2, 0, 0], [0.2, 0.1, 0], [0.2, 0.2, 0.0]])
    assert distance_to(np.array([0.15, 0.03, 0.04]), path) == pytest.approx(0.05)
    assert distance_to(np.array([0.3, 0.2, 0.0]), path) == pytest.approx(0.1)
    assert corners_of(path) == [0, 2, 4]
    there_and_back = np.array([[0, 0, 0], [0, 0, 0.1], [0, 0, 0.0]])
    assert corners_of(there_and_back) == [0, 1, 2]


def test_pads_stand_across_the_heading() -> None:
    left, right = pads_m(np.zeros(3), 0.0, 0.06, {"breadth_m": 0.02, "thickness_m": 0.01})
    # With heading 0 along x the fingers close along y.
    assert sorted([left.mean(axis=0)[1], right.mean(axis=0)[1]]) == pytest.approx([-0.035, 0.035])
    assert np.ptp(left[:, 0]) == pytest.approx(0.02)
    assert np.ptp(left[:, 1]) == pytest.approx(0.01)
