"""The suites `pointing` and `boxcheck`: one question a trial, scored as the paper scores it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from wonderful_team.cli.app import run
from wonderful_team.evals.toy import BOX_KINDS, WORDS, score_point, score_verdict
from wonderful_team.lab.toy import BOX_KINDS as DRAWN
from wonderful_team.lab.toy import RIGHT


def bench(capsys: pytest.CaptureFixture[str], store: Path, *words: str) -> dict[str, Any]:
    assert run(["bench", *words, "--store", str(store), "--jobs", "1", "--json"]) == 0
    told: dict[str, Any] = json.loads(capsys.readouterr().out)["result"]
    return told


def rates(told: dict[str, Any]) -> dict[str, tuple[int, int]]:
    return {f"{cell['method']} {cell['model']}": (cell["successes"], cell["scored"]) for cell in told["conditions"]}


def test_a_point_counts_within_one_three_and_four_radii() -> None:
    inside, near, far = (score_point((100.0 + off, 100.0), (100.0, 100.0), 50.0) for off in (50.0, 160.0, 300.0))
    assert (inside.outcome, near.outcome, far.outcome) == ("success", "failure", "failure")
    assert [near.facts[f"within {name}"] for name in ("1 radius", "3 radii", "4 radii")] == [0.0, 0.0, 1.0]
    assert far.facts["error [radii]"] == pytest.approx(6.0)
    missing = score_point(None, (100.0, 100.0), 50.0, rounds=[(200.0, 100.0)])
    assert missing.reason == "not found"
    assert missing.facts["error in round 0 [radii]"] == 2.0
    assert "error [radii]" not in missing.facts


def test_a_verdict_is_a_line_of_the_confusion_matrix() -> None:
    wrong = score_verdict("accept", "reject")
    assert wrong.outcome == "failure"
    assert wrong.facts == {"accept": 1.0, "revise": 0.0, "reject": 0.0}


def test_pointing_compares_one_question_with_the_grounding_team(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    told = bench(
        capsys, tmp_path / "s.db", "pointing", "--seeds", "1000:1003",
        "--method", "point:axes,team", "--model", "simulated:perfect,simulated:paper-claude-3-opus",
    )  # fmt: skip
    found = rates(told)
    assert found["point:axes simulated:perfect"] == found["team simulated:perfect"] == (3, 3)
    assert found["point:axes simulated:paper-claude-3-opus"][0] <= 1
    assert not any("controls" in text for text in told["warnings"])
    assert any("SIMULATED" in text for text in told["warnings"])
    assert run(["report", str(tmp_path / "s.db")]) == 0
    said = capsys.readouterr().out
    assert "within 3 radii" in said
    assert "error in round 0 [radii]" in said


def test_thorough_asks_more_on_the_toy_table_too(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ("pointing", "--seeds", "1000:1004", "--model", "simulated:paper-gpt-4-turbo", "--no-control", "all")
    calls = [
        bench(capsys, tmp_path / f"{len(more)}.db", *words, *more)["conditions"][0]["mean_calls"]
        for more in ((), ("--thorough",))
    ]
    assert calls[1] > calls[0]


def test_the_kinds_of_boxes_are_those_that_the_laboratory_draws() -> None:
    assert BOX_KINDS == DRAWN
    assert WORDS == ("accept", "revise", "reject")
    assert set(RIGHT.values()) == set(WORDS)


def test_boxcheck_gives_the_confusion_matrix_of_the_checker_and_of_one_look(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = ("boxcheck", "--seeds", "1000:1002", "--method", "point,team", "--model", "simulated:perfect")
    told = bench(capsys, tmp_path / "s.db", *words)
    assert rates(told)["team simulated:perfect"] == (8, 8)
    assert rates(told)["point simulated:perfect"] == (8, 8)
    assert run(["report", str(tmp_path / "s.db")]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if "boxcheck/around | 2 |" in line]
    assert len(lines) == 2
    assert all(line.endswith("| 0.000 | 0.000 | 1.000 |") for line in lines)


def test_a_method_that_judges_no_boxes_is_told_what_is_missing(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    bench(capsys, tmp_path / "s.db", "boxcheck", "--seeds", "1000:1001", "--method", "direct")
    assert run(["report", str(tmp_path / "s.db")]) == 0
    assert "needs judge(observation, words, box)" in (tmp_path / "s.csv").read_text(encoding="utf-8")


def test_a_tier_of_the_toy_table_does_not_exist(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ["bench", "pointing", "--perturb", "lighting=1", "--store", str(tmp_path / "s.db")]
    assert run(words) == 2
    assert "toy table" in capsys.readouterr().err


def test_point_plans_nothing(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert run(["run", "tabletop/rotate", "--seed", "3", "--method", "point", "--out", str(tmp_path)]) == 2
    assert "plans nothing" in capsys.readouterr().err
