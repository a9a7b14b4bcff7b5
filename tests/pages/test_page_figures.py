"""The picture of a plan: a cross where something is put down, numbers that cover no arrow, pictures for names."""

from __future__ import annotations

import itertools
import math
import re
from types import SimpleNamespace

import pytest

from wonderful_team.pages.cost import waterfall
from wonderful_team.pages.figures import arrow_layer
from wonderful_team.pages.planted import sentence
from wonderful_team.pages.strips import overviews
from wonderful_team.pages.words import step_words

NUMBER = r"-?\d+(?:\.\d+)?"
SCENE = {"hash": "s", "size_px": [200, 100], "main": "top", "views": {"top": "gone"}}


def grounded(name: str, box: tuple[float, float, float, float], role: str) -> dict:
    x0, y0, x1, y1 = box
    return {
        "target": {"id": name, "words": f"thing {name}", "part": None, "where": ""},
        "status": "found",
        "box": {"x0": x0, "y0": y0, "x1": x1, "y1": y1},
        "points": {role: [(x0 + x1) / 2, (y0 + y1) / 2]},
    }


class Shown:
    size_px, number = (200, 100), 1


class Album:
    def get(self, key: str) -> Shown:
        return Shown()


def test_the_cross_of_left_of_a_thing_lies_beside_the_thing() -> None:
    plan = {
        "subgoals": [1],
        "scene_hash": "s",
        "grounded": {"T1": grounded("T1", (10, 10, 30, 30), "pick"), "T2": grounded("T2", (100, 40, 140, 80), "place")},
        "actions": [
            {"sources": [{"target": "T1", "point_px": [20, 20]}, {"target": "T2", "point_px": [80, 60]}]},
        ],
    }
    record = {"planner": {"plans": [{"id": "p", "plan": plan}], "observations": [SCENE], "outlines": []}}
    drawing = str(overviews(record, Album())[0]["drawing"])  # type: ignore[arg-type]
    found = re.findall(rf'd="M({NUMBER}) ({NUMBER})L({NUMBER}) ({NUMBER})M[^"]*" class="cross t1"', drawing)
    middles = [((float(a) + float(c)) / 2, (float(b) + float(d)) / 2) for a, b, c, d in found]
    assert middles == [(80.0, 60.0)]


def test_names_of_things_that_stand_close_cover_neither_each_other_nor_the_things() -> None:
    boxes = [
        (10 + 45 * column, 12 + 22 * row, 24 + 45 * column, 26 + 22 * row) for column in range(4) for row in range(3)
    ]
    things = {f"T{k}": grounded(f"T{k}", box, "pick") for k, box in enumerate(boxes)}
    # What moves down has its name above it, what moves up below: between two rows they meet.
    ends = [
        {"sources": [{"target": name, "point_px": [0, 50]}, {"target": None, "point_px": [0, 90 if k % 3 else 10]}]}
        for k, name in enumerate(things)
    ]
    plan = {"subgoals": [1], "scene_hash": "s", "grounded": things, "actions": ends}
    record = {"planner": {"plans": [{"id": "p", "plan": plan}], "observations": [SCENE], "outlines": []}}
    drawing = str(overviews(record, Album())[0]["drawing"])  # type: ignore[arg-type]
    plates = re.findall(
        rf'<rect x="({NUMBER})" y="({NUMBER})" width="({NUMBER})" height="({NUMBER})"[^>]*class="tag', drawing
    )
    taken = [tuple(map(float, box)) for box in boxes]
    taken += [(x, y, x + width, y + height) for x, y, width, height in (map(float, plate) for plate in plates)]
    assert len(taken) == 2 * len(boxes)
    for one, other in itertools.combinations(taken, 2):
        wide, high = (min(one[k + 2], other[k + 2]) - max(one[k], other[k]) for k in (0, 1))
        assert wide < 1 or high < 1


def test_a_turn_is_an_arc_with_its_degrees() -> None:
    step = {"type": "PickPlaceStep", "rotate_deg": -90}
    ends = [{"target": "T1", "point_px": [20, 20]}, {"target": "T1", "point_px": [100, 60]}]
    content = {
        "subgoals": [1],
        "scene_hash": "s",
        "grounded": {"T1": grounded("T1", (10, 10, 30, 30), "pick")},
        "actions": [{"step": step, "sources": ends}],
    }
    record = {"planner": {"plans": [{"id": "p", "plan": content}], "observations": [SCENE], "outlines": []}}
    overview = overviews(record, Album())[0]  # type: ignore[arg-type]
    assert overview["turns"] == 1
    assert "90° anticlockwise" in str(overview["drawing"])
    content["actions"] = [{"step": {**step, "rotate_deg": 0}, "sources": ends}]
    still = overviews(record, Album())[0]  # type: ignore[arg-type]
    assert still["turns"] == 0
    assert "°" not in str(still["drawing"])


def test_the_number_of_a_short_arrow_covers_neither_its_line_nor_its_head() -> None:
    for end in ((60.0, 50.0), (50.0, 41.0), (44.0, 57.0)):
        start, size = (50.0, 50.0), 6.0
        drawn = str(arrow_layer([start, end], 1, size))
        x, y, r = map(float, re.search(rf'cx="({NUMBER})" cy="({NUMBER})" r="({NUMBER})"', drawn).groups())  # type: ignore[union-attr]
        assert math.dist((x, y), end) > r
        assert math.dist((x, y), start) > r
        bend = tuple(map(float, re.search(rf"Q({NUMBER}) ({NUMBER})", drawn).groups()))  # type: ignore[union-attr]
        line = [
            tuple((1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c for a, b, c in zip(start, bend, end, strict=True))
            for t in (k / 20 for k in range(21))
        ]
        assert min(math.dist((x, y), point) for point in line) > r


def test_numbers_of_crossing_arrows_stand_on_their_own_lines() -> None:
    crossing = [((20.0, 20.0), (220.0, 200.0)), ((220.0, 20.0), (20.0, 200.0))]
    lines, plates = [], []
    for number, (start, end) in enumerate(crossing, start=1):
        drawn = str(arrow_layer([start, end], number, 8.0))
        bend = tuple(map(float, re.search(rf"Q({NUMBER}) ({NUMBER})", drawn).groups()))  # type: ignore[union-attr]
        lines.append(
            [
                tuple(
                    (1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c for a, b, c in zip(start, bend, end, strict=True)
                )
                for t in (k / 40 for k in range(41))
            ]
        )
        plates.append(tuple(map(float, re.search(rf'cx="({NUMBER})" cy="({NUMBER})"', drawn).groups())))  # type: ignore[union-attr]
    for own, other in ((0, 1), (1, 0)):
        assert min(math.dist(plates[own], point) for point in lines[own]) < 4
        assert min(math.dist(plates[own], point) for point in lines[other]) > 25


@pytest.mark.parametrize("end", [(50.0, 50.0), (51.0, 50.5), (54.0, 50.0), (50.0, 42.0)])
def test_the_head_of_an_arrow_is_no_longer_than_the_move(end: tuple[float, float]) -> None:
    start, size = (50.0, 50.0), 6.0
    drawn = str(arrow_layer([start, end], 1, size))
    head = re.search(r'd="(M[^"]*Z)" class="arrow-head"', drawn)
    assert head is not None
    numbers = [float(number) for number in re.findall(NUMBER, head[1])]
    corners = list(zip(numbers[::2], numbers[1::2], strict=True))
    assert max(math.dist(corner, end) for corner in corners) <= min(math.dist(start, end), 1.1 * size) + 0.02


def test_steps_say_what_the_targets_are() -> None:
    step = {
        "type": "PickPlaceStep",
        "pick": "T3",
        "place": {"type": "Beside", "side": "left", "target": "T4"},
        "rotate_deg": 0,
    }
    assert step_words(step, {"T3": "banana", "T4": "block"}) == "pick T3 banana, place left of T4 block"
    turned = {"type": "RotateGripperStep", "subgoal": "G1", "rotate_deg": -270.0}
    assert step_words(turned) == "turn the gripper 270° anticlockwise"


def test_planted_mistakes_that_nobody_caught_are_not_called_caught() -> None:
    assert sentence([]) == ""
    assert sentence([{"by": "Verification"}, {"by": ""}]) == "2 planted mistakes, 1 caught"
    assert sentence([{"by": ""}]) == "1 planted mistake, 0 caught"
    assert sentence([{"by": "a"}, {"by": "b"}]) == "2 planted mistakes, both caught"


def test_bars_have_the_colours_of_their_roles_and_roles_of_other_methods_have_some_too() -> None:
    def call(role: str, number: int) -> SimpleNamespace:
        entry = {"role": role, "invalid": None}
        return SimpleNamespace(
            entry=entry, sent_s=number, answered_s=number + 1, seconds=1.0, label=role, anchor="a", number=number
        )

    def colours(roles: list[str], words: list[str]) -> list[str]:
        return re.findall(r"bar role-(\d)", str(waterfall([call(role, k) for k, role in enumerate(roles)], words)))  # type: ignore[misc]

    words = ["supervisor.md", "supervisor.DraftPlan.md", "verification.md", "manager.md"]
    assert colours(["manager", "supervisor", "manager"], words) == ["2", "0", "2"]
    assert colours(["finder", "keeper", "finder"], []) == ["0", "1", "0"]
    assert colours([str(k) for k in range(10)], []) == [*"01234567", "7", "7"]
