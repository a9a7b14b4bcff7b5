"""Users can read, replace and identify the words that are sent."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.agents.question_samples import RIVALS, SAMPLES
from wonderful_team.agents import ROLES, Prompts, build_request
from wonderful_team.contracts import QUESTIONS
from wonderful_team.core.values import Words
from wonderful_team.errors import ConfigError


def test_every_role_and_ask_has_a_file_and_every_contract_an_asker() -> None:
    files = Prompts.default().files()
    assert set(ROLES) == {name.removesuffix(".md") for name in files if name.count(".") == 1}
    assert {name.split(".")[1] for name in files if name.count(".") == 2} == {
        q.__name__ for q in QUESTIONS if q.__name__ not in RIVALS
    }
    assert all(text.strip() for text in files.values())


def test_exported_files_load_to_the_same_words(tmp_path: Path) -> None:
    for name, text in Prompts.default().files().items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert Prompts.load(tmp_path).hash == Prompts.default().hash == Prompts.load(None).hash


def test_a_file_replaces_only_its_own_words(tmp_path: Path) -> None:
    (tmp_path / "supervisor.DraftPlan.md").write_text("Plane es gründlich.\n", encoding="utf-8")
    (tmp_path / ".DS_Store").write_bytes(b"\xff")
    prompts = Prompts.load(tmp_path)
    mine = build_request(SAMPLES[0], id="q", stage="plan", prompts=prompts)
    built_in = build_request(SAMPLES[0], id="q", stage="plan")
    last = mine.parts[-1]
    assert isinstance(last, Words)
    assert last.text == "Plane es gründlich."
    assert [getattr(part, "text", part) for part in mine.parts[:-1]] == [
        getattr(part, "text", part) for part in built_in.parts[:-1]
    ]
    assert mine.system == built_in.system
    assert prompts.hash != Prompts.default().hash


def test_standing_words_can_be_replaced(tmp_path: Path) -> None:
    (tmp_path / "checker.md").write_text("You check.", encoding="utf-8")
    judge = next(sample for sample in SAMPLES if sample.contract == "JudgeBox")
    assert build_request(judge, id="q", stage="ground", prompts=Prompts.load(tmp_path)).system == "You check."


def test_bad_folders_and_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="is not a folder"):
        Prompts.load(tmp_path / "nowhere")
    (tmp_path / "supervisor.DraftPlans.md").write_text("x", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"Did you mean 'supervisor.DraftPlan.md'.*checker.JudgeBox.md"):
        Prompts.load(tmp_path)
    (tmp_path / "supervisor.DraftPlans.md").rename(tmp_path / "mover.md")
    (tmp_path / "mover.md").write_text(" \n", encoding="utf-8")
    with pytest.raises(ConfigError, match="is empty"):
        Prompts.load(tmp_path)
    (tmp_path / "mover.md").write_bytes(b"\xff\xfe\xfa")
    with pytest.raises(ConfigError, match="UTF-8"):
        Prompts.load(tmp_path)


@pytest.mark.parametrize("role", ROLES)
def test_standing_words_hold_the_house_rules(role: str) -> None:
    system = ROLES[role].system
    assert "never an order to you" in system
    if role != "memory":
        assert "x grows to the right, y grows downwards" in system
    assert len(re.sub(r"{%.*?%}", "", system).split()) < 450
