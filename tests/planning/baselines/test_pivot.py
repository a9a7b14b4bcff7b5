"""`pivot`: the paper's numbers, read from its record; marks, radii and draws."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wonderful_team as wt
from tests.desk import draw_desk
from tests.planning.baselines.runs import Listening, contracts, decided, photo, pictures, requests, run, words
from wonderful_team.core.geometry import Frame
from wonderful_team.core.pictures import Picture
from wonderful_team.core.protocols import Act, GaveUp
from wonderful_team.planning.baselines.pivot import SAMPLES, SELECTED, Cloud


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """One trial: two targets with one point each."""
    return run("pivot", "visual_manipulation", tmp_path_factory.mktemp("pivot"))


def marks(request: dict[str, Any]) -> np.ndarray[Any, Any]:
    """The numbered points of a request [picture px]."""
    (found,) = [mark["points"] for part in pictures(request) for mark in part["marks"] if "points" in mark]
    return np.array(found)


def asked_of(trial: Any, branch: str) -> list[dict[str, Any]]:
    """The requests of one branch, in order."""
    return [request for request in requests(trial) if request["id"].split("/")[2] == branch]


def test_a_point_takes_three_iterations_of_three_runs_and_a_final_query(trial: Any) -> None:
    assert trial.outcome == "success"
    kinds = contracts(trial)
    assert (kinds.count("DraftPlan"), kinds.count("WriteSteps")) == (1, 1)
    assert kinds.count("SelectMarks") == 2 * (3 * 3 + 1) == len(kinds) - 2
    for target in ("T1.pick", "T2.place"):
        for number in (1, 2, 3):
            iterations = asked_of(trial, f"{target}.run{number}")
            assert [len(marks(request)) for request in iterations] == list(SAMPLES)
        (final,) = asked_of(trial, f"{target}.final")
        assert len(marks(final)) == 3
    assert {role: used.calls for role, used in trial.usage_by_role.items()} == {"drafter": 2, "selector": 20}


def test_the_next_radius_is_twice_the_largest_distance_from_the_mean_along_each_edge(trial: Any) -> None:
    for target in ("T1.pick", "T2.place"):
        for number in (1, 2, 3):
            first, *later = asked_of(trial, f"{target}.run{number}")
            for following in later:
                chosen = marks(first)[np.array(first["answer"]["parsed"]["numbers"]) - 1]
                assert len(chosen) == SELECTED == 3
                mean = chosen.mean(axis=0)
                radii = 2 * np.abs(chosen - mean).max(axis=0)
                away = (marks(following) - mean) / radii
                assert (np.hypot(*away.T) <= 1 + 1e-9).all()
                first = following


def test_the_first_marks_lie_all_over_the_view_and_differ_between_runs(trial: Any) -> None:
    clouds = [marks(asked_of(trial, f"T1.pick.run{number}")[0]) for number in (1, 2, 3)]
    everywhere = np.concatenate(clouds)
    assert np.ptp(everywhere, axis=0) == pytest.approx((1280, 640), rel=0.15)
    assert not np.array_equal(clouds[0], clouds[1])
    assert (everywhere >= 0).all()
    assert (everywhere <= (1280, 640)).all()


def test_what_the_final_query_selects_is_what_is_used(trial: Any) -> None:
    (final,) = asked_of(trial, "T1.pick.final")
    chosen = marks(final)[final["answer"]["parsed"]["numbers"][0] - 1]
    grounded = trial.plans[0].grounded["T1"]
    # The view of 640 px is shown at twice its size.
    assert grounded.points["pick"] == pytest.approx(tuple(chosen / 2))
    assert grounded.box is None
    assert [event.what for event in grounded.history] == ["centre"] * 9 + ["chosen"]


def test_the_selector_sees_a_description_and_marks_and_neither_plan_nor_instruction(trial: Any) -> None:
    for request in requests(trial):
        if request["role"] == "selector":
            assert "<instruction>" not in words(request)
            assert "points numbered 1 to" in words(request)
            assert request["notes"] == []


def test_the_same_scene_is_sampled_alike_and_another_is_not(trial: Any, tmp_path: Path) -> None:
    again = run("pivot", "visual_manipulation", tmp_path / "again")
    branch = "T1.pick.run1"
    assert np.array_equal(marks(asked_of(again, branch)[0]), marks(asked_of(trial, branch)[0]))
    other = run("pivot", "visual_manipulation", tmp_path / "other", seed=501)
    assert not np.array_equal(marks(asked_of(other, branch)[0]), marks(asked_of(trial, branch)[0]))


def plain(width: int = 400, height: int = 200) -> Picture:
    return Picture("top", np.zeros((height, width, 3), np.uint8), Frame.whole("top", (width, height)))


def test_where_the_selected_marks_do_not_differ_the_radius_halves() -> None:
    cloud = Cloud((100, 50), (80, 40))
    assert cloud.narrowed([(30.0, 20.0)]) == Cloud((30, 20), (40, 20))
    line = cloud.narrowed([(20.0, 20.0), (40.0, 20.0)])
    assert (line.centre, line.radii) == ((30, 20), (20, 20))


@pytest.mark.parametrize("centre", [(0.0, 0.0), (400.0, 200.0), (200.0, 100.0)])
def test_as_many_marks_as_asked_for_lie_whole_in_the_view(centre: tuple[float, float]) -> None:
    points = Cloud(centre, (3, 3)).sample(10, plain(), np.random.default_rng(0))
    assert len(points) == 10
    assert all(6 <= x <= 394 and 6 <= y <= 194 for x, y in points)


def test_a_target_of_which_nothing_is_selected_is_absent(tmp_path: Path) -> None:
    class Blind:
        name = "blind"
        model = wt.make_model("offline")

        def answer(self, request: wt.Request) -> Any:
            blind = request.contract == "SelectMarks"
            return {"reasoning": "", "numbers": []} if blind else self.model.answer(request)

    model = Listening(Blind())
    made = decided("pivot", photo(tmp_path), model)
    assert isinstance(made, GaveUp)
    assert (made.stage, made.reason) == ("grounding", "T1 not found: red circle; T2 not found: blue square")
    # Each run ends with its first iteration, and nothing is left to choose from.
    assert [request.contract for request in model.heard].count("SelectMarks") == 2 * 3


def test_only_marks_that_are_there_and_as_many_as_asked_for_are_taken(tmp_path: Path) -> None:
    class Wrong:
        name = "wrong"
        model = wt.make_model("offline")

        def answer(self, request: wt.Request) -> Any:
            if request.contract != "SelectMarks" or request.attempt:
                return self.model.answer(request)
            return {"reasoning": "", "numbers": [1, 2, 3, 4] if request.question.most == 3 else [9]}

    model = Listening(Wrong())
    assert isinstance(decided("pivot", photo(tmp_path), model), Act)
    feedback = {request.feedback for request in model.heard if request.feedback}
    assert feedback == {"4 marks selected; at most 3 asked for", "candidate 9 does not exist; valid: 1 to 3"}


def test_a_cap_ends_it_at_stage_budget(tmp_path: Path) -> None:
    trial = run("pivot", "visual_manipulation", tmp_path, max_calls=5)
    assert (trial.outcome, trial.stage, trial.usage.calls) == ("failure", "budget", 5)
    assert trial.page.is_file()


def test_it_finds_things_in_photos(tmp_path: Path) -> None:
    seen = wt.Observation.from_files(draw_desk(tmp_path) / "desk.png")
    policy: Any = wt.Method(method="pivot", model="offline").policy()
    circle, none = asyncio.run(policy.locate(seen, ["red circle", "green star"]))
    assert circle == pytest.approx((80, 150), abs=26)
    assert none is None
