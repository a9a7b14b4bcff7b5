"""The suite `annotations`: the same question with and without what the team draws, paired on the same tables, scored in code."""

from __future__ import annotations

import asyncio
import json
import math
from pathlib import Path
from typing import Any

import pytest

from wonderful_team.cli.app import run
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, Tiles
from wonderful_team.core.values import Request, Words
from wonderful_team.evals.store import Store
from wonderful_team.evals.toy import ANNOTATIONS, score_turn
from wonderful_team.images.turned import Shown, reach_px, turn_misfits
from wonderful_team.lab.annotations import ANSWERS_DEG, CHANGES, TurnTable, box_to_judge, change_to_judge, crop_window
from wonderful_team.lab.toy import RADIUS_PX, ToyTable
from wonderful_team.planning.baselines.shown import ShownWith

SEEDS = range(3000, 3030)


def test_the_pixels_say_what_the_truth_says_of_a_turn() -> None:
    for seed in range(3000, 3006):
        table = TurnTable(seed)
        misfits = turn_misfits(
            Shown(table.view, table.box.centre), Shown(table.goal, table.goal_at), reach_px(table.box), ANSWERS_DEG
        )
        assert ANSWERS_DEG[int(misfits.argmin())] == table.turn_deg
        assert table.turn_deg != 0.0


def test_windows_hold_the_target_and_do_not_give_it_away() -> None:
    for seed in SEEDS:
        table = ToyTable(seed)
        window = crop_window(table)
        assert window.intersection(table.target.box) == table.target.box
        assert math.dist(window.centre, table.target.centre) >= 0.5 * RADIUS_PX


def test_changes_are_worse_better_and_right_in_turn() -> None:
    said = set()
    for seed in SEEDS:
        table = ToyTable(seed)
        before, after, right = change_to_judge(table)
        gaps = [math.dist(box.centre, table.target.box.centre) for box in (before, after)]
        assert (right == "keep_before") == (gaps[1] > gaps[0])
        assert (right == "take_after_stop") == (gaps[1] == 0.0)
        said.add(right)
    assert said == set(CHANGES.values())
    assert {box_to_judge(ToyTable(seed))[1] for seed in SEEDS} == {"accept", "revise", "reject"}


class AskedError(Exception):
    """Holds what was asked."""


class Recorder:
    """A client that is asked and answers nothing."""

    async def ask(self, request: Request) -> Any:
        raise AskedError(request)


def request_of(annotated: bool, question: str, *given: Any) -> Request:
    method = ShownWith(Recorder(), annotated=annotated)  # type: ignore[arg-type]
    with pytest.raises(AskedError) as told:
        asyncio.run(getattr(method, question)(*given))
    request: Request = told.value.args[0]
    return request


def plain_words(request: Request) -> list[str]:
    """All that is said but the lines that announce pictures."""
    return [part.text for part in request.parts if isinstance(part, Words) and part.picture is None]


def test_both_ask_in_the_same_words_and_differ_in_what_is_shown() -> None:
    table, turned = ToyTable(3000), TurnTable(3000)
    view, said = table.view, table.target.words
    box, other = table.target.box, table.target.box.shifted(20, 0)
    turn = (turned.view, turned.box, turned.goal, turned.goal_at, ANSWERS_DEG, turned.words)
    for question, *given in (
        ("point", view, said), ("point", view, said, crop_window(table)), ("verdict", view, said, box), ("turn", *turn),
        ("revision", view, said, box, other),
    ):  # fmt: skip
        with_, without = (request_of(annotated, question, *given) for annotated in (True, False))
        assert plain_words(with_) == plain_words(without), question
        assert with_.system == without.system
    axes = [[type(mark) for mark in request_of(one, "point", view, said).pictures[0].marks] for one in (True, False)]
    assert axes == [[Axes], []]
    strips = [
        any(isinstance(m, Tiles) for m in request_of(one, "turn", *turn).pictures[0].marks) for one in (True, False)
    ]
    assert strips == [True, False]
    assert [len(request_of(one, "revision", view, said, box, other).pictures) for one in (True, False)] == [2, 1]
    crops = [request_of(one, "verdict", view, said, box).pictures[0].frame.valid for one in (True, False)]
    assert isinstance(crops[0], Box)
    sizes = [request_of(one, "verdict", view, said, box).pictures[0].frame.scale for one in (True, False)]
    assert sizes[0] > 2 * sizes[1], "the crop shows the box larger"


def test_a_turn_is_right_or_so_many_degrees_off() -> None:
    assert score_turn(330.0, 0.0).facts == {"error [degrees]": 30.0}
    assert score_turn(60.0, 60.0).outcome == "success"
    assert score_turn(None, 60.0).facts == {}


def test_each_annotation_is_paired_with_the_same_question_without(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["bench", "annotations", "--model", "simulated:perfect:spread=0.05", "--seeds", "1000:1006", "--jobs", "1"]
    assert run([*words, "--record", "full", "--out", str(tmp_path), "--store", str(tmp_path / "s.db"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["result"]
    assert [one["method"] for one in told["conditions"]] == ["annotated", "bare"]
    assert not any("controls" in text for text in told["warnings"])
    won: dict[tuple[str, str], int] = {}
    with Store(tmp_path / "s.db") as store:
        for row in store.rows():
            assert row.result is not None
            key = (row.spec.task, row.spec.condition.method)
            won[key] = won.get(key, 0) + (row.result.outcome == "success")
            assert Path(row.result.page).is_file(), "a picture of the hit or the miss"
    gain = {task.rpartition("/")[2]: won[task, "annotated"] - won[task, "bare"] for task in ANNOTATIONS}
    assert gain["axes"] == gain["strips"] == gain["crop_verdict"] == 0, "no rate of a profile depends on them"
    assert gain["crop"] > 0, "errors are shares of the picture shown"
    assert gain["before_after"] == 2, "without the box before, what became worse is not seen"
    assert run(["report", str(tmp_path / "s.db")]) == 0
    said = capsys.readouterr().out
    assert (
        "| annotated · simulated:perfect:spread=0.05 | bare · simulated:perfect:spread=0.05 | toy/annotations/crop |"
        in said
    )
    html = (tmp_path / "s.html").read_text(encoding="utf-8")
    assert html.count('<img src="data:image/webp') == 24


def test_what_puts_no_such_question_is_told_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["bench", "toy/annotations/axes", "--method", "team", "--seeds", "1000", "--jobs", "1"]
    assert run([*words, "--store", str(tmp_path / "s.db")]) == 0
    with Store(tmp_path / "s.db") as store:
        (row,) = [one for one in store.rows() if one.spec.condition.method == "team"]
    assert row.result is not None
    assert "methods annotated and bare" in row.result.reason
