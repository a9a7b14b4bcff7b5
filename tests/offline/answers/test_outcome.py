"""JudgeOutcome, Replan, Remember, ReviewPath, and what is not supported."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from tests.offline.answers.tables import ask, draft, picture, table, task
from wonderful_team.contracts import (
    Advice,
    JudgeOutcome,
    JudgeSubgoal,
    MemoryEntry,
    Outcome,
    PathReview,
    Remember,
    Replan,
    ReviewPath,
    WriteFunction,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, PathMark
from wonderful_team.core.values import Request, Subgoal, Verdict, View
from wonderful_team.errors import UnsupportedQuestion
from wonderful_team.offline import OfflineModel

REST = (("square", "blue", 300, 160, 52), ("disc", "yellow", 520, 240, 30))
BEFORE = table(("star", "green", 500, 80, 36), *REST)


def outcome(text: str, before: View, after: View, measured: tuple[str, ...] = ()) -> Outcome:
    plan = draft(text, before)
    answer = ask(
        JudgeOutcome(task(text, before), plan.to_subgoals(), plan.to_targets(), (), (picture(after),), measured)
    )
    assert isinstance(answer, Outcome)
    return answer


ON = "put the green star onto the blue square"
LEFT = "put the green star to the left of the blue square"


@pytest.mark.parametrize(
    ("text", "at", "status"),
    [(ON, (300, 160), "done"), (ON, (500, 80), "not_done"), (ON, (400, 250), "not_done"),
     (LEFT, (180, 160), "done"), (LEFT, (430, 160), "not_done"), (LEFT, (500, 80), "not_done")],
)  # fmt: skip
def test_where_the_thing_is_now_decides(text: str, at: tuple[int, int], status: str) -> None:
    after = table(*REST, ("star", "green", *at, 36))
    (verdict,) = outcome(text, BEFORE, after).verdicts
    assert verdict.status == status
    assert "green star" in verdict.evidence


@pytest.mark.parametrize(
    ("star", "disc", "status", "holds"),
    [((300, 160), (520, 240), "done", True), ((500, 80), (520, 240), "not_done", True), ((300, 160), (430, 80), "done", False)],
    ids=["as planned", "not carried", "somebody moved what comes next"],
)  # fmt: skip
def test_a_subgoal_is_judged_while_others_are_still_to_run(
    star: tuple[int, int], disc: tuple[int, int], status: str, holds: bool
) -> None:
    text = f"{ON}, then put the yellow disc onto the blue square"
    plan = draft(text, BEFORE)
    first, second = plan.to_subgoals()
    after = table(("square", "blue", 300, 160, 52), ("disc", "yellow", *disc, 30), ("star", "green", *star, 36))
    shown = task(text, BEFORE)
    named = next(target.id for target in plan.to_targets() if "yellow" in target.words)
    box = shown.main.frame.box_to_picture(Box.around((520, 240), 60, 60))
    shown = replace(shown, views=(shown.main.marked(BoxMark(box, "target", named)), *shown.views[1:]))
    question = JudgeSubgoal(shown, first, (first, second), plan.to_targets(), (), (picture(after),), (), ())
    answer = ask(question)
    assert (answer.status, answer.rest_holds) == (status, holds)
    assert bool(answer.what_changed) is not holds
    assert bool(answer.stop) is (status == "not_done" or not holds)


def test_the_robots_report_explains_a_failure() -> None:
    (verdict,) = outcome(ON, BEFORE, BEFORE, ("G1: pick_place executed: held = False",)).verdicts
    assert verdict.cause is not None
    assert "held = False" in verdict.cause


def test_a_thing_that_is_gone_is_unclear() -> None:
    (verdict,) = outcome(ON, BEFORE, table(*REST)).verdicts
    assert verdict.status == "unclear"


def turned(degrees: float) -> View:
    view = table(("triangle", "green", 480, 100, 44), *REST)
    turn = cv2.getRotationMatrix2D((480, 100), -degrees, 1.0)
    patch = view.rgb.copy()
    patch[30:170, 410:550] = cv2.warpAffine(patch, turn, (640, 320), borderMode=cv2.BORDER_REPLICATE)[30:170, 410:550]
    return View("top", "top", 0.0, np.ascontiguousarray(patch))


@pytest.mark.parametrize(("really", "status"), [(60.0, "done"), (0.0, "not_done"), (30.0, "not_done")])
def test_a_turn_is_measured(really: float, status: str) -> None:
    (verdict,) = outcome("rotate the green triangle by 60 degrees", turned(0.0), turned(really)).verdicts
    assert verdict.status == status


def test_a_turned_disc_looks_the_same() -> None:
    (verdict,) = outcome("rotate the yellow ball by 60 degrees", BEFORE, BEFORE).verdicts
    assert verdict.status == "unclear"


GOALS = (Subgoal("G1", ON, targets=("T1", "T2")),)


@pytest.mark.parametrize(
    ("status", "left", "decision"),
    [("done", 3, "done"), ("not_done", 3, "replan"), ("not_done", 0, "give_up"), ("undone", 1, "replan")],
)
def test_advice(status: str, left: int, decision: str) -> None:
    verdict = Verdict("G1", status, "it slipped")  # type: ignore[arg-type]
    answer = ask(Replan(task(ON, BEFORE), GOALS, (verdict,), (), left))
    assert isinstance(answer, Advice)
    assert answer.decision == decision
    if decision != "done":
        assert "it slipped" in answer.cause


def test_memory_keeps_what_matters_once() -> None:
    found = Remember(ON, "manager", "Where is T1?", "T1 found at the top right; T2 was not found")
    kept = ask(found)
    assert isinstance(kept, MemoryEntry)
    assert kept.keep
    assert "T2 was not found" in kept.summary
    again = ask(Remember(ON, "manager", "Where is T1?", "T1 found at the top right; T2 was not found", (kept.key,)))
    assert isinstance(again, MemoryEntry)
    assert not again.keep
    empty = ask(Remember(ON, "checker", "Is it fine?", "yes"))
    assert isinstance(empty, MemoryEntry)
    assert not empty.keep


@pytest.mark.parametrize(
    ("points", "accepted"),
    [
        (((500.0, 80.0), (400.0, 100.0), (300.0, 160.0)), True),
        (((500.0, 80.0), (900.0, 100.0)), False),
        (((500.0, 80.0), (80.0, 300.0)), False),
        (((500.0, 80.0),), False),
        (((500.0, 80.0), (500.5, 80.0)), False),
    ],
)
def test_paths(points: tuple[tuple[float, float], ...], accepted: bool) -> None:
    view = picture(BEFORE)
    path = PathMark(tuple(view.frame.point_to_picture(point) for point in points))
    answer = ask(ReviewPath(GOALS[0], view.marked(path)))
    assert isinstance(answer, PathReview)
    assert answer.accepted == accepted


def test_a_path_that_stays_in_one_place_may_go_up_and_down() -> None:
    view = picture(BEFORE)
    point = view.frame.point_to_picture((500.0, 80.0))
    seen = view.marked(PathMark((point, point, point)))
    shake = Subgoal("G1", "shake it")
    assert ask(ReviewPath(shake, seen, (0.0, 0.08, 0.0))).accepted
    assert "all points of the path are the same place" in ask(ReviewPath(shake, seen, (0.0, 0.0, 0.0))).problem
    assert not ask(ReviewPath(shake, seen)).accepted


def test_no_path_is_written_for_words_that_name_none() -> None:
    question = WriteFunction(GOALS[0], picture(BEFORE))
    with pytest.raises(UnsupportedQuestion, match="WriteFunction"):
        OfflineModel().answer(Request("x", "act", "supervisor", question, (), question.output()))


def test_answers_say_where_they_come_from() -> None:
    question = Remember(ON, "manager", "Where?", "T1 not found")
    answer = OfflineModel().answer(Request("x", "memory", "memory", question, (), question.output()))
    assert (answer.provenance, answer.model_id, answer.usage.tokens, answer.usage.usd) == ("offline", "offline", 0, 0.0)
