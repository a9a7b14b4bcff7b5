"""What was not understood ends in the same words whether a photo or a world was planned for, wherever it is read."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import wonderful_team as wt
from wonderful_team.cli.app import run
from wonderful_team.cli.wording import action_line
from wonderful_team.core.actions import At, Beside, MoveStep, OriginOf, PickPlaceStep, Place, Step
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.values import GateCheck, GateReport, Instruction, PlannedAction, ReadPlan
from wonderful_team.pages.words import step_words
from wonderful_team.runtime.read_plan_checks import read_plan_checks

DESK = str(Path(__file__).parents[2] / "examples" / "desk.png")
UNKNOWN, SAID = "put the flurb onto the wurgle", "I do not know: flurb, wurgle"
UNCLEAR = "rotate the letter by 90 degrees"


@pytest.mark.parametrize("command", [["plan", DESK], ["run", "tabletop/rotate"]], ids=["plan", "run"])
def test_what_is_not_understood_is_called_so_everywhere(
    command: list[str], runs_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([*command, UNKNOWN]) == 7
    assert capsys.readouterr().out.startswith(f"NOT UNDERSTOOD  I used: put, onto. {SAID}")
    folder = runs_folder / "latest"
    assert wt.load_run(folder).outcome == "not_understood"
    assert "done       not understood  I used: put, onto." in (folder / "log.txt").read_text(encoding="utf-8")
    page = (folder / "page.html").read_text(encoding="utf-8")
    assert '<strong class="outcome">not understood</strong>' in page
    assert ">failure<" not in page
    for look in (["list", "runs"], ["show", "latest"]):
        assert run(look) == 0
        assert "not understood" in capsys.readouterr().out.lower()
    assert run([*command, UNKNOWN, "--json"]) == 7
    told = json.loads(capsys.readouterr().out)["result"]
    assert told["status"] == "not_understood"
    assert SAID in (told.get("message") or told["reason"])


def test_a_run_asks_what_is_meant_as_a_plan_does(runs_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["run", "tabletop/rotate", UNCLEAR]) == 7
    first, *choices, page = capsys.readouterr().out.splitlines()
    assert first == "NEEDS CLARIFICATION  Which one is meant by 'the letter'? 2 things fit equally well."
    assert sorted(choices) == ["  choice: the yellow dotted letter (right)", "  choice: the yellow letter (centre)"]
    assert page.startswith("page: ")
    html = (runs_folder / "latest" / "page.html").read_text(encoding="utf-8")
    head = html.partition("<nav")[0]
    assert head.count("the yellow dotted letter (right)") == 1


def test_a_trial_keeps_its_outcome_for_those_who_count() -> None:
    trial = wt.rollout(wt.Team(), wt.make_world("tabletop/rotate", instruction=UNKNOWN))
    assert (trial.outcome, trial.ending, trial.stage) == ("failure", "not_understood", "plan")
    assert "not understood: I used" in trial._repr_html_()


PLACES: list[tuple[Place, str, str]] = [
    (At("T2"), "at T2 bowl", "T2 bowl"),
    (Beside("T2", "left"), "left of T2 bowl", "left of T2 bowl"),
    (OriginOf("T2"), "where T2 bowl stood", "where T2 bowl stood"),
]


@pytest.mark.parametrize(("place", "on_the_page", "on_a_terminal"), PLACES)
def test_places_read_as_english(place: Place, on_the_page: str, on_a_terminal: str) -> None:
    words = {"T1": "red block", "T2": "bowl"}
    step: Step = PickPlaceStep("G1", "T1", place)
    assert step_words(to_jsonable(step), words) == f"pick T1 red block, place {on_the_page}"
    assert action_line(PlannedAction(step, None), words) == f"pick_place  T1 red block  ->  {on_a_terminal}"
    move: Step = MoveStep("G1", place, "above")
    assert step_words(to_jsonable(move), words) == f"move above {on_the_page.removeprefix('at ')}"


def test_the_gate_says_what_would_be_valid() -> None:
    checks = (
        GateCheck(0, "workspace x", False, "0.100 m", "[0.250, 0.750] m"),
        GateCheck(None, "status of the plan", False, "draft", "planned"),
    )
    assert GateReport(checks).reasons == (
        "action 1: workspace x: 0.100 m (valid: [0.250, 0.750] m)",
        "status of the plan: draft (valid: planned)",
    )


def test_a_plan_for_another_instruction_is_refused_in_plain_words() -> None:
    seen = wt.Observation.from_files(DESK)
    plan = wt.Plan(Instruction("put the red block away"), "planned")
    report = GateReport(tuple(read_plan_checks(ReadPlan(plan, None), Instruction("rotate the red block"), seen, False)))
    assert report.reasons == (
        "instruction of the plan: 'put the red block away' (valid: 'rotate the red block', the instruction of this run)",
    )
