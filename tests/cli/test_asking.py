"""The question on the terminal: what it shows, and what counts as yes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import wonderful_team as wt
from wonderful_team.cli import asking
from wonderful_team.core.values import GateReport
from wonderful_team.runtime import Approval, Declined, Proposal

EVIL = "T1\x1b[2K\x1b[1A harmless"


@pytest.fixture
def proposal(tmp_path: Path) -> Proposal:
    step = wt.PickPlaceStep(EVIL, pick=EVIL, place=wt.At("the safe place"))
    action = wt.PlannedAction(step, wt.PickPlace(np.array([0.5, 0.2, 0.034]), np.array([0.4, -0.2, 0.0]), 1.5708))
    page = tmp_path / "page.html"
    page.write_text("the plan", encoding="utf-8")
    return Proposal(None, (action,), GateReport(()), "a" * 64, page)


def answer(monkeypatch: pytest.MonkeyPatch, *lines: str | BaseException) -> None:
    left = list(lines)

    def read() -> str:
        line = left.pop(0) if left else EOFError()
        if isinstance(line, BaseException):
            raise line
        return line

    monkeypatch.setattr("builtins.input", read)


def test_it_shows_numbers_and_the_page_and_no_word_of_a_model(
    proposal: Proposal, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    answer(monkeypatch, "y")
    asking.ask(proposal)
    told = capsys.readouterr().err
    assert "pick_place  pick [0.500, 0.200, 0.034] m  place [0.400, -0.200, 0.000] m  yaw 1.571 rad" in told
    for shown in ("page.html", proposal.id[:12]):
        assert shown in told
    assert "harmless" not in told
    assert "safe place" not in told
    assert "\x1b" not in told


@pytest.mark.parametrize("said", ["y", "Y", " yes ", "YES"])
def test_yes(said: str, proposal: Proposal, monkeypatch: pytest.MonkeyPatch) -> None:
    answer(monkeypatch, said)
    given = asking.ask(proposal)
    assert isinstance(given, Approval)
    assert (given.plan_id, given.picture, len(given.page)) == (proposal.id, "a" * 64, 64)
    assert given.by


@pytest.mark.parametrize(
    ("lines", "because"),
    [
        (["n"], ""),
        (["No."], ""),
        ([""], ""),
        (["n, because it is hot"], "it is hot"),
        (["no, because it is hot"], "it is hot"),
        (["NO because it is hot"], "it is hot"),
        (["no: take the other one"], "take the other one"),
        ([EOFError()], ""),
        ([OSError(5, "Input/output error")], ""),
        ([RuntimeError("input(): lost sys.stdin")], ""),
        (["perhaps", "now", "yes please", "y"], ""),
    ],
)
def test_anything_else_is_a_no(
    lines: list[str | BaseException], because: str, proposal: Proposal, monkeypatch: pytest.MonkeyPatch
) -> None:
    answer(monkeypatch, *lines)
    given = asking.ask(proposal)
    assert isinstance(given, Declined)
    assert given.because == because


@pytest.mark.parametrize(
    ("line", "answered"),
    [
        ("2", "the right one"),
        (" 1 ", "the left one"),
        ("3", "3"),
        ("the one with a chip", "the one with a chip"),
        ("", None),
        (EOFError(), None),
        (OSError(5, "Input/output error"), None),
    ],
)
def test_a_planners_question_takes_a_number_or_words(
    line: str | BaseException,
    answered: str | None,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    answer(monkeypatch, line)
    assert asking.answer(f"which one{EVIL}?", ("the left one", "the right one")) == answered
    told = capsys.readouterr().err
    assert "which one" in told
    assert "2  the right one" in told
    assert "\x1b" not in told


@pytest.mark.parametrize(
    ("terminal", "as_json", "asks"), [(True, False, True), (True, True, False), (False, False, False)]
)
def test_only_a_person_at_a_terminal_is_asked(
    terminal: bool, as_json: bool, asks: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("stdin", "stderr"):
        monkeypatch.setattr(f"sys.{name}.isatty", lambda: terminal, raising=False)
    assert (asking.user_to_ask(as_json) is not None) == asks
    monkeypatch.setattr("sys.stdin", None)
    assert asking.user_to_ask(False) is None
