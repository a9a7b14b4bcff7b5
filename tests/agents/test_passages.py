"""What a model is told fits what it is asked and shown: passages of the words stand in some requests only."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.agents.question_samples import SAMPLES, picture
from tests.agents.test_agent_requests import build, shown
from wonderful_team.agents import Prompts, build_request
from wonderful_team.contracts import JudgeBox, LocatePoints, Question, ReadScene, ShownTask
from wonderful_team.core.pictures import Axes
from wonderful_team.core.values import Target
from wonderful_team.errors import ConfigError

MUG = Target("T1", "object", "mug", use=("pick",))
SPOT = Target("T2", "area", "free spot", use=("place",))
VIEW = picture("top view", Axes())


def sample(contract: str, **changes: Any) -> Any:
    return replace(next(one for one in SAMPLES if one.contract == contract), **changes)  # type: ignore[type-var]


def told(question: Question) -> str:
    request = build(question)
    return " ".join(f"{request.system}\n{shown(request)}".split())


def test_without_pictures_in_the_instruction_nothing_is_said_of_them() -> None:
    plain = ShownTask("put the mug on the tray", (picture("top view"),))
    with_pictures, without = told(sample("DraftPlan")), told(sample("DraftPlan", task=plain))
    for rule in (
        "A picture of one thing alone",
        "A name in braces",
        "An object's picture in the instruction",
        "- like: the names",
    ):
        assert rule in with_pictures
        assert rule not in without
    assert "like is empty and alike is both" in without


def test_a_name_in_braces_is_explained_wherever_one_stands() -> None:
    """A target may have no example of its own, and yet the instruction that is quoted names pictures."""
    question = LocatePoints(MUG, "centre", (), VIEW, instruction="put the {dragged_obj} on the tray")
    assert "A name in braces" in told(question)
    assert "A picture of one thing alone" not in told(question)
    assert "A name in braces" not in told(replace(question, instruction="put the mug on the tray"))


def test_how_targets_are_listed_is_told_where_they_are_listed() -> None:
    assert "How to write targets" in told(sample("DraftPlan", with_targets=True))
    assert "How to write targets" not in told(sample("DraftPlan", with_targets=False))
    assert "How to write targets" in told(sample("ExtractTargets"))
    assert "targets" not in sample("DraftPlan", with_targets=False).output().model_json_schema()["properties"]


def test_a_point_to_pick_and_a_place_are_asked_for_in_their_own_words() -> None:
    pick, place = (LocatePoints(target, purpose, (), VIEW) for target, purpose in ((MUG, "centre"), (SPOT, "place")))
    assert "on its solid material" in told(pick)
    assert "can come to lie" not in told(pick)
    assert "can come to lie" in told(place)
    assert "solid material" not in told(place)


@pytest.mark.parametrize(
    ("targets", "said", "unsaid"),
    [
        ((MUG,), ["Point for pick or grasp"], ["Point for place", "push_start", "For an area"]),
        ((SPOT,), ["Point for place", "For an area"], ["Point for pick", "push_start"]),
        ((replace(MUG, use=("push_start",)), replace(MUG, id="T3", part="handle")), ["push_start: where", "only the part"], ["Point for place"]),
    ],
    ids=["picked", "place in an area", "pushed, and a part"],
)  # fmt: skip
def test_a_reading_is_told_of_the_uses_that_are_wanted(targets: Any, said: list[str], unsaid: list[str]) -> None:
    text = told(ReadScene(targets, (), VIEW))
    assert all(rule in text for rule in said)
    assert not any(rule in text for rule in unsaid)


def test_a_verdict_on_a_box_without_points_is_not_asked_about_points() -> None:
    boxed = sample("JudgeBox").crop
    alone, with_point = JudgeBox(MUG, boxed), JudgeBox(MUG, boxed, uses=("pick",))
    assert "Judge every point" not in told(alone)
    assert "wrong_points" not in alone.output().model_json_schema()["properties"]
    assert "Judge every point" in told(with_point)
    assert "wrong_points" in with_point.output().model_json_schema()["properties"]


def test_how_positions_count_is_said_once() -> None:
    """Where a line of the request says it, in the model's own unit, the standing words do not say it again in pixels."""
    for question in SAMPLES:
        request = build(question)
        by_line = "Answer with positions in picture" in shown(request)
        assert not (by_line and "Positions count from the top-left corner" in request.system), question.contract
    assert "Positions count from the top-left corner" in build(sample("MoveBox")).system
    assert "Positions count from the top-left corner" in build(sample("WriteFunction")).system


def test_passages_of_ones_own_depend_on_the_same_conditions(tmp_path: Path) -> None:
    (tmp_path / "checker.md").write_text("You check.\n{% if examples %}\nSee the examples.\n{% endif %}\nBe brief.\n")
    prompts = Prompts.load(tmp_path)
    judge = sample("JudgeBox", goal=None)
    with_examples, without = (
        build_request(one, id="q", stage="ground", prompts=prompts).system
        for one in (judge, replace(judge, examples=()))
    )
    assert with_examples == "You check.\nSee the examples.\nBe brief."
    assert without == "You check.\nBe brief."


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("{% if exmaples %}x{% endif %}", "depends on exmaples; known are marks, names, positions, examples"),
        ("one\n{% if examples %}x", r"'checker.md' \(line 2\): .*a passage stands between"),
        ("{% include 'x' %}", r"\(line 1\): a passage may depend on names"),
    ],
    ids=["a name that is not known", "no end", "another file"],
)
def test_a_passage_that_cannot_be_read_is_refused_with_its_line(tmp_path: Path, text: str, problem: str) -> None:
    (tmp_path / "checker.md").write_text(text)
    with pytest.raises(ConfigError, match=problem):
        Prompts.load(tmp_path)


def test_braces_of_ones_own_words_stay_as_they_are(tmp_path: Path) -> None:
    (tmp_path / "checker.md").write_text("A name such as {name} or {{name}} or {#1} stands for a picture.")
    assert build_request(sample("JudgeBox"), id="q", stage="ground", prompts=Prompts.load(tmp_path)).system == (
        "A name such as {name} or {{name}} or {#1} stands for a picture."
    )
