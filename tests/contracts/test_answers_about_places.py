"""What the contracts accept and refuse of points, boxes, edges and numbered candidates: one row a case."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from tests.contracts.right_answers import BOX, QUESTION, changed, judged

NAN, INF = math.nan, math.inf
NO_POINTS: dict[str, Any] = {"found": False, "points": []}
T7 = "targets.0"

REFUSED: list[tuple[str, dict[str, Any], str]] = [
    # The sample's picture has 64 x 32 px: up to 1.28 px and 0.64 px beyond it are clamped.
    ("LocatePoints", {"points.0.x": -1.3}, r"x = -1\.3 lies outside main view, which spans 0 to 64 px"),
    ("LocatePoints", {"points.1.y": 32.7}, r"y = 32\.7 lies outside main view, which spans 0 to 32 px"),
    ("LocatePoints", {"points.0.x": NAN}, "points.0.x.*finite number"),
    ("LocatePoints", {"points.0.x": INF}, "points.0.x.*finite number"),
    ("LocatePoints", {"points.0.x": 10**400}, "points.0.x"),
    ("LocatePoints", {"points.0.x": "left"}, "points.0.x.*valid number"),
    ("LocatePoints", {"points.0": [3, 4]}, "points.0.*(dictionary|object)"),
    ("LocatePoints", {"points": [{"x": 1, "y": 1}] * 4}, "4 points given; at most 3 asked for"),
    ("LocatePoints", {"points": []}, "points must be given exactly when found is true"),
    ("LocatePoints", {"found": False}, "points must be given exactly when found is true"),
    ("ChooseMark", {"number": 0}, "candidate 0 does not exist; valid: 1 to 3"),
    ("ChooseMark", {"number": 4}, "candidate 4 does not exist; valid: 1 to 3"),
    ("ChooseMark", {"number": 1.5}, "number.*integer"),
    ("ChoosePoint", {"number": -1}, "candidate -1 does not exist; valid: 1 to 3"),
    ("ChoosePoint", {"number": None}, "number.*valid integer"),
    ("GiveBox", {"box.x1": 66}, "x1 = 66 lies outside centred, which spans 0 to 64 px"),
    ("GiveBox", {"box.y0": NAN}, "box.y0.*finite number"),
    ("GiveBox", {"box.x0": 30.5}, "x0 must be less than x1 and y0 less than y1"),
    ("GiveBox", {"box.y0": 25}, "x0 must be less than x1 and y0 less than y1"),
    # In order as it was given, empty once it is clamped.
    ("GiveBox", {"box.x0": 64.2, "box.x1": 64.8}, "x0 must be less than x1"),
    ("GiveBox", {"box": [10, 5, 30, 20]}, "box.*(dictionary|object)"),
    ("ReadScene", {f"{T7}.id": "T9"}, "unknown target 'T9'; valid: T7, T8"),
    ("ReadScene", {f"{T7}.id": "T8"}, "target ids must be unique; these occur twice: T8"),
    ("ReadScene", {f"{T7}.id": "{T7}"}, "unknown target '{T7}'; valid: T7, T8"),
    ("ReadScene", {f"{T7}.id": ""}, "unknown target ''; valid: T7, T8"),
    ("ReadScene", {"targets": []}, "every target must be answered; missing: T7, T8"),
    ("ReadScene", {f"{T7}.found": False}, "T7 is said not to be there, yet has a box or points"),
    ("ReadScene", {f"{T7}.box": None}, "T7 is said to be found, yet has no box"),
    ("ReadScene", {f"{T7}.points": []}, "T7 needs a point for: grasp, pick"),
    ("ReadScene", {f"{T7}.points.0.role": "pick"}, "T7 needs a point for: grasp"),
    ("ReadScene", {f"{T7}.points.0.role": "handle"}, "points.0.role"),
    ("ReadScene", {f"{T7}.points.0.point.x": 700}, "x = 700 lies outside whole, which spans 0 to 64 px"),
    ("ReadScene", {f"{T7}.box.y1": -40}, "y1 = -40 lies outside whole, which spans 0 to 32 px"),
    ("Presence", {"edges": []}, "edges must hold each of left, top, right, bottom once"),
    ("Presence", {"edges.0.edge": "top"}, "edges must hold each of left, top, right, bottom once"),
    ("Presence", {"edges.0.edge": "middle"}, "edges.0.edge"),
    ("Presence", {"edges.0.inside": "perhaps"}, "edges.0.inside.*boolean"),
    ("JudgeBox", {"decision": "keep"}, "decision.*'accept', 'revise' or 'reject'"),
    ("JudgeRevision", {"decision": "accept"}, "decision.*'keep_before'"),
    ("MoveBox", {"right_px": 0}, "the revision changes nothing"),
    ("MoveBox", {"right_px": NAN}, "right_px.*finite number"),
    ("MoveBox", {"right_px": 60}, r"the revised box \(70, 5, 90, 20\) lies outside the picture"),
    ("MoveBox", {"right_px": 1e308}, "box"),
    ("MoveBox", {"action": "resize", "grow_left_px": -20}, "box must have x0 < x1 and y0 < y1"),
    ("MoveBox", {"action": "turn"}, "action"),
    ("MoveBox", {"cut_edges": ["middle"]}, "cut_edges.0"),
]


@pytest.mark.parametrize(("contract", "changes", "says"), REFUSED)
def test_a_wrong_place_is_refused_by_what_is_wrong(contract: str, changes: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=f"(?s){says}"):
        judged(QUESTION[contract], changed(contract, changes))


ACCEPTED: list[tuple[str, dict[str, Any]]] = [
    ("LocatePoints", NO_POINTS),
    ("LocatePoints", {"points.0.x": 0, "points.0.y": 32}),
    ("ChooseMark", {"number": None}),
    ("GiveBox", {"box": None}),
    ("GiveBox", {"box": {"x0": 0, "y0": 0, "x1": 64, "y1": 32}}),
    ("ReadScene", {"targets.1": {"id": "T8", "found": True, "box": BOX, "points": [{"role": "place", "point": {"x": 1, "y": 2}}]}}),
    # More points than asked for do no harm: the roles that count are there.
    ("ReadScene", {f"{T7}.points": [{"role": role, "point": {"x": 1, "y": 2}} for role in ("pick", "grasp", "place")]}),
    ("Presence", {"edges": [{"edge": edge, "inside": False, "outside": False} for edge in ("bottom", "left", "top", "right")]}),
    ("MoveBox", {"action": "stop", "right_px": 0}),
    ("MoveBox", {"action": "resize", "grow_right_px": 2}),
]  # fmt: skip


@pytest.mark.parametrize(("contract", "changes"), ACCEPTED)
def test_a_right_place_is_taken_without_a_repair(contract: str, changes: dict[str, Any]) -> None:
    said = changed(contract, changes)
    answer, repairs = judged(QUESTION[contract], said)
    assert (answer, repairs) == (type(answer).model_validate(said), ())


CLAMPED: list[tuple[str, dict[str, Any], str, float, str]] = [
    ("LocatePoints", {"points.0.x": -1.2}, "points.0.x", 0, r"point (-1.2, 4.0) clamped to (0, 4) in main view"),
    ("LocatePoints", {"points.0.y": 32.6}, "points.0.y", 32, r"point (3.0, 32.6) clamped to (3, 32) in main view"),
    ("GiveBox", {"box.x1": 65.2}, "box.x1", 64, "box clamped to (10, 5, 64, 20) in centred"),
    ("ReadScene", {f"{T7}.box.y0": -0.6}, f"{T7}.box.y0", 0, "box clamped to (10, 0, 30, 20) in whole"),
    (
        "ReadScene",
        {f"{T7}.points.1.point.x": 65},
        f"{T7}.points.1.point.x",
        64,
        "point (65.0, 9.0) clamped to (64, 9) in whole",
    ),
]


@pytest.mark.parametrize(("contract", "changes", "place", "becomes", "told"), CLAMPED)
def test_two_hundredths_beyond_the_picture_are_clamped_and_told(
    contract: str, changes: dict[str, Any], place: str, becomes: float, told: str
) -> None:
    answer, repairs = judged(QUESTION[contract], changed(contract, changes))
    value: Any = answer.model_dump()
    for part in place.split("."):
        value = value[int(part) if part.isdigit() else part]
    assert value == becomes
    assert repairs == (told,)


def test_a_mover_stops_only_where_that_is_offered() -> None:
    said = changed("MoveBox", {"action": "stop"})
    with pytest.raises(ValueError, match="'stop' is not offered here: propose a move or a resize"):
        judged(replace(QUESTION["MoveBox"], may_stop=False), said)
