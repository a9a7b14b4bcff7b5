"""What each member is worth, and where failures move: by hand, and with models that make exactly one kind of error."""

from __future__ import annotations

import csv
import json
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest

from wonderful_team import registry
from wonderful_team.cli.app import run
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.evals.ablation import MEMBERS, SETTINGS, Ablation, ablations, end_of, left_out
from wonderful_team.evals.report.ablation import EFFECT_HEAD, effect_lines, end_lines, moved_lines
from wonderful_team.evals.report.page import write_all
from wonderful_team.evals.summary import summarise
from wonderful_team.evals.trials import Condition, Row, TrialRow, TrialSpec
from wonderful_team.planning.config import ABLATIONS, members_of
from wonderful_team.simulated import profile_named


def ended(method: str, seed: int, stage: str | None, task: str = "tabletop/rotate", outcome: str = "failure") -> Row:
    result = TrialRow("success") if stage is None else TrialRow(outcome, stage)  # type: ignore[arg-type]
    return Row(TrialSpec(task, seed, Condition(method, "m")), result)


def test_names_say_who_is_left_out_as_the_team_itself_reads_them() -> None:
    names = ["full", *SETTINGS]
    names += ["-" + "-".join(some) for n in range(1, 6) for some in combinations(MEMBERS, n)]
    for name in names:
        members = members_of(name)
        off = {member for member in MEMBERS if not getattr(members, member)}
        for base in ("team", "team:paper"):
            assert left_out(base if name == "full" else f"{base}:{name}") == (base, off), name
    assert set(SETTINGS) == set(ABLATIONS) - {"full"}
    assert left_out("direct:axes") is None
    assert left_out("team:-nobody") is None
    assert left_out("single-call-grounding") is None


def test_effects_and_moves_are_those_counted_by_hand() -> None:
    with_ = [None] * 8 + ["grounding", "plan"]
    without = [None] * 3 + ["plan"] * 3 + ["draft", "wrong object", "grounding", None]
    rows = [ended("team", 1000 + n, stage) for n, stage in enumerate(with_)]
    rows += [ended("team:-verification", 1000 + n, stage) for n, stage in enumerate(without)]
    rows += [ended("team:-verification", 1010, "crash", outcome="error"), ended("direct", 1000, "plan")]
    # Of the whole team more was run: it does not count beside what was run of both.
    rows += [ended("team", 1010, None), *(ended("team", 2000 + n, "gate") for n in range(5))]
    (found,) = ablations(summarise(rows, []))
    (effect,) = found.effects
    assert effect.label == "Verification"
    assert (effect.pair.only_first, effect.pair.only_second, effect.pair.n) == (5, 1, 10)
    assert effect.moved == {("success", "planning"): 4, ("success", "grounding"): 1, ("planning", "success"): 1}
    assert effect.kept == 4
    assert effect_lines(found)[0][:4] == ("Verification", "team", "team:-verification", "+40.0")
    head, lines = end_lines(found)
    shown = dict(zip(head, lines[1], strict=True))
    assert (found.shared, lines[0][-1], lines[1][-1]) == (11, "11", "11")
    assert shown["planning"] == "4 (+3)"
    assert shown["grounding"] == "2 (+1)"
    assert shown["not scored"] == "1 (+1)"


def test_a_member_is_judged_beside_every_team_that_differs_in_it_alone() -> None:
    rows = [ended(method, 1000, None) for method in ("team", "team:s1", "team:s2", "team:s3", "team:s4", "team:s6")]
    (found,) = ablations(summarise(rows, []))
    told = [(one.label, one.pair.first.method, one.pair.second.method) for one in found.effects]
    assert told == [
        ("Verification", "team", "team:s1"),
        ("Verification", "team:s2", "team:s3"),
        ("Manager", "team:s4", "team:s6"),
        ("Checker", "team", "team:s2"),
        ("Checker", "team:s1", "team:s3"),
        ("Mover", "team:s2", "team:s4"),
        ("Verification and Checker", "team", "team:s3"),
        ("Checker and Mover", "team", "team:s4"),
        ("Manager, Checker and Mover", "team", "team:s6"),
    ]


def test_a_crash_is_code_that_broke_and_other_stages_keep_their_name() -> None:
    ends = [end_of(ended("team", 1, stage)) for stage in ("method", "crash", "wrong object", "gate", "budget")]
    assert ends == ["crash", "crash", "grounding", "planning", "budget"]


def test_each_writes_out_the_team_without_every_member() -> None:
    assert registry.each_member(["team:-each"]) == ["team", *(f"team:-{name}" for name in MEMBERS)]
    assert registry.each_member(["team", "direct", "team:-each"])[:3] == ["team", "direct", "team:-verification"]
    assert registry.each_member(["team:paper:-each"])[1] == "team:paper:-verification"
    assert registry.each_member(["team:s1:-each"]) == ["team:s1:-each"]


def test_a_simulated_model_takes_rates_of_its_own() -> None:
    profile = profile_named("perfect:wrong_plan=0.5:spread=0.02:accepts_wrong=0.25")
    assert (profile.wrong_plan, profile.spread, profile.overlooks) == (0.5, (0.02, 0.02), 0.0)
    assert profile.judgement.off == (0.25, 0.75, 0.0)
    assert profile_named("paper-gpt-4o:overlooks=0").radial == profile_named("paper-gpt-4o").radial
    for wrong in ("missed=2", "missed=", "missed", "missed=nan", "shifts_boxes=0.5", "edge=-1"):
        with pytest.raises(ConfigError, match="valid"):
            profile_named(f"perfect:{wrong}")
    with pytest.raises(UnknownNameError, match="wrong_plan"):
        profile_named("perfect:wrong_plans=1")
    with pytest.raises(ConfigError, match="twice"):
        profile_named("perfect:missed=1:missed=0")


def study(tmp_path: Path, capsys: pytest.CaptureFixture[str], *words: str) -> tuple[Ablation, Path]:
    store = tmp_path / "s.db"
    assert run(["bench", *words, "--no-control", "all", "--record", "none", "--store", str(store), "--jobs", "1"]) == 0
    assert "SIMULATED" in capsys.readouterr().out
    made = write_all([store], tmp_path / "page.html")
    (found,) = ablations(made.summary)
    return found, made.page


def csv_lines(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


def changes(found: Ablation) -> dict[str, dict[tuple[str, str], int]]:
    """What moved, by the member that was left out."""
    return {one.label: dict(one.moved) for one in found.effects if one.pair.first is found.conditions[0] and one.moved}


def test_wrong_plans_alone_move_verifications_cell_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # Tasks of one move: a plan without it fails whatever is drawn, which for two moves hangs on the pixels.
    methods = "team,team:-verification,team:-checker,team:-mover,team:-memory"
    found, page = study(
        tmp_path, capsys, "visual_manipulation", "rotate", "--seeds", "1000:1002", "--method", methods,
        "--model", "simulated:perfect:wrong_plan=1",
    )  # fmt: skip
    assert changes(found) == {"Verification": {("success", "planning"): 4}}
    assert moved_lines(found)[0][3] == "success → planning: 4; as before: 0"
    html = page.read_text(encoding="utf-8")
    assert "What each member is worth" in html
    assert "success → planning: 4" in html
    effects = csv_lines(page.with_name("page-effects.csv"))
    over_all = {line["members"]: line for line in effects if line["task"] == "all"}
    assert {name: float(line["adds"]) for name, line in over_all.items()} == {
        "verification": 1.0, "checker": 0.0, "mover": 0.0, "memory": 0.0,
    }  # fmt: skip
    ends = csv_lines(page.with_name("page-ends.csv"))
    failed = {(line["method"], line["end"]): 0 for line in ends if line["trials"] != "0" and line["end"] != "success"}
    assert list(failed) == [("team:-verification", "planning")]
    text = page.with_suffix(".md").read_text(encoding="utf-8")
    assert f"| {' | '.join(EFFECT_HEAD)} |" in text


def test_things_that_the_manager_takes_for_others_move_the_checkers_cell_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found, _ = study(
        tmp_path, capsys, "pointing", "--seeds", "1000:1008", "--method", "team:-each",
        "--model", "simulated:perfect,manager=simulated:perfect:wrong_thing=0.4",
    )  # fmt: skip
    moved = changes(found)
    assert list(moved) == ["Checker"], moved
    assert list(moved["Checker"]) == [("success", "grounding")]


def test_the_suite_holds_the_nine_tasks(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["list", "suites", "--json"]) == 0
    listed: dict[str, Any] = json.loads(capsys.readouterr().out)["result"]["suites"]
    assert listed["ablation"].startswith("9 tasks")
