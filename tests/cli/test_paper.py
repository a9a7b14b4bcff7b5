"""`paper`: tables by name, what they run, and our figures beside the paper's."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from wonderful_team import registry
from wonderful_team.api.known_suites import known_suites
from wonderful_team.cli.app import run
from wonderful_team.errors import ConfigError
from wonderful_team.evals.paper_also import with_methods
from wonderful_team.evals.paper_filled import filled
from wonderful_team.evals.paper_tables import PAPER_TABLES
from wonderful_team.evals.report import paper_page
from wonderful_team.evals.summary import Summary
from wonderful_team.evals.trials import Condition, Row, TrialRow, TrialSpec
from wonderful_team.registry.worlds import task_names


def told(capsys: pytest.CaptureFixture[str], *words: str, code: int = 0) -> dict[str, Any]:
    assert run(["paper", *words, "--json"]) == code
    found: dict[str, Any] = json.loads(capsys.readouterr().out)["result"]
    return found


def test_without_a_table_all_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["paper"]) == 0
    said = capsys.readouterr().out
    assert all(name in said for name in PAPER_TABLES)
    assert "cannot be run yet: it needs" in said


def test_every_table_names_methods_and_tasks_that_there_are() -> None:
    for name, table in PAPER_TABLES.items():
        assert bool(table.suites) != bool(table.lacks), name
        assert all(registry.method_row(method) is not None for method in table.methods), name
        assert all(suite in known_suites() or suite in task_names() for suite in table.suites), name
        head, lines = filled(table, None)
        assert lines
        assert all(len(line) == len(head) for line in lines), name


def test_what_follows_from_the_papers_own_table_stands_beside_what_it_prints() -> None:
    head, lines = filled(PAPER_TABLES["training-based"], None)
    team = dict(zip(head, lines[0], strict=True))
    assert team["paper: as printed"].startswith("91.25 %")
    assert team["paper: as it follows"].startswith("92.08 %")
    assert team["ours: mean of the four groups"] == "not run"


def test_a_mean_of_tasks_says_whose_it_is_how_sure_and_where_the_answers_came_from() -> None:
    def rows(model: str, wins: int, replans: int = 0) -> list[Row]:
        condition = Condition("team:paper", model, replans=replans)
        return [
            Row(
                TrialSpec(task, 1000 + n, condition),
                TrialRow("success" if n < wins else "failure", "plan", provenance=("simulated",)),
            )
            for task in PAPER_TABLES["training-based"].suites
            for n in range(10)
        ]

    def cell(*told: list[Row]) -> str:
        found = [row for some in told for row in some]
        conditions = tuple(dict.fromkeys(row.spec.condition for row in found))
        head, lines = filled(PAPER_TABLES["training-based"], Summary(tuple(found), (), conditions, ()))
        return dict(zip(head, lines[0], strict=True))["ours: mean of the four groups"]

    assert cell(rows("simulated:a", 5)) == "50.00 % (n = 10 a task; 40 to 60) [SIMULATED]"
    # Each model's own, never their mean; what else sets two apart is told too, and what was only begun is left out.
    assert cell(rows("a", 5), rows("b", 10), rows("a", 0, replans=3), rows("c", 1)[:20]).split("; ")[::2] == [
        "a: 50.00 % (n = 10 a task", "b: 100.00 % (n = 10 a task", "a · 3 replans: 0.00 % (n = 10 a task",
    ]  # fmt: skip


def test_a_table_runs_and_stands_beside_the_papers(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ("toy", "--model", "simulated:perfect", "--seeds", "1000:1001", "--folder", str(tmp_path), "--jobs", "1")
    found = told(capsys, *words)
    table = found["tables"]["toy"]
    line = dict(zip(table["head"], table["lines"][0], strict=True))
    assert line["ours: point:axes"].startswith("100 % (n = 1;")
    assert "[SIMULATED]" in line["ours: team:paper"]
    assert line["paper: gpt-4o"] == "33 % (n not stated)"
    page = Path(found["page"]).read_text(encoding="utf-8")
    assert "SIMULATED" in page
    assert "default-src 'none'" in page
    assert (tmp_path / "paper.html").is_file()
    rows = list(csv.reader((tmp_path / "toy-table.csv").read_text(encoding="utf-8").splitlines()))
    assert rows[0] == table["head"]
    assert r"\begin{tabular}" in (tmp_path / "toy-table.tex").read_text(encoding="utf-8")
    # The same command goes on where it stopped: nothing is run again.
    assert run(["paper", *words]) == 0
    assert "within 3 radii" in capsys.readouterr().out


def test_the_confusion_matrix_has_a_line_for_every_kind_and_verdict(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    found = told(
        capsys, "boxes", "--model", "simulated:perfect", "--seeds", "1000:1001", "--folder", str(tmp_path), "--jobs", "1"
    )  # fmt: skip
    table = found["tables"]["boxes"]
    lines = {line[0]: dict(zip(table["head"], line, strict=True)) for line in table["lines"]}
    assert len(lines) == 12
    assert lines["around: reject"]["ours: team:paper"].startswith("100 %")
    assert lines["slightly off: accept"]["ours: point"].startswith("0 %")
    assert lines["perfect: accept"]["paper: gpt-4-turbo"].startswith("72 % (n = 25;")


def test_a_cap_holds_for_all_tables_together(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ("--model", "simulated:perfect", "--no-control", "all", "--folder", str(tmp_path), "--jobs", "1")
    boxes = (*words, "--seeds", "1000:1001")
    assert told(capsys, "boxes", *boxes)["stopped"] == ""
    # Eight boxes were judged, a call each: for the next table that leaves nothing.
    stopped = told(capsys, "toy", *words, "--seeds", "1000:1001", "--max-calls", "8", code=5)["stopped"]
    assert "cap of 8 calls" in stopped


def test_a_table_that_cannot_be_run_shows_the_papers_figures_and_what_is_missing(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run(["paper", "vla", "--folder", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "Cannot be run yet: it needs the worlds and weights of these models." in said
    assert " %" in said


def test_crashes_of_a_methods_code_are_counted_apart_from_other_failures() -> None:
    task, seen = "tabletop/visual_manipulation", [("success", None), ("failure", "crash"), ("failure", "grounding")]
    asked = Condition("moka", "m")
    results = [TrialRow(outcome, stage) for outcome, stage in [*seen, ("error", None)]]
    rows = [Row(TrialSpec(task, 1000 + k, asked), result) for k, result in enumerate(results)]
    head, lines = filled(PAPER_TABLES["moka"], Summary(tuple(rows), (), (asked,), ()))
    line = dict(zip(head, next(line for line in lines if line[0] == "moka"), strict=True))
    for column, paper in (("success", "20 %"), ("failed otherwise", "40 %"), ("code crashed", "40 %")):
        assert line[f"ours: {column}"].startswith("33.3 % (n = 3;")
        assert line[f"paper: {column}"].startswith(paper)


def test_an_estimate_runs_nothing(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert run(["paper", "toy", "--estimate", "--pilot", "1", "--seeds", "1000:1002", "--folder", str(tmp_path)]) == 0
    assert not (tmp_path / "toy-table.html").exists()
    assert capsys.readouterr().out.strip()


def test_an_unknown_table_is_told_the_known_ones(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["paper", "tabel"]) == 2
    assert "vima17" in capsys.readouterr().err


def test_rivals_stand_beside_the_papers_figures_of_them(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ("--model", "simulated:perfect", "--seeds", "1000:1001", "--no-control", "all", "--jobs", "1")
    found = told(capsys, "training-based", *words, "--method", "instruct2act", "--folder", str(tmp_path))
    table = found["tables"]["training-based"]
    lines = {line[0]: dict(zip(table["head"], line, strict=True)) for line in table["lines"]}
    ours = lines["Instruct2Act"]["ours: mean of the four groups"]
    assert "(n = 1 a task; " in ours
    assert ours.endswith("[SIMULATED]")
    assert lines["Instruct2Act"]["paper: as printed"].startswith("79.67 %")
    assert lines["team"]["ours: mean of the four groups"] == "not run yet"


def test_a_method_that_the_table_lacks_is_told_those_that_it_has(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run(["paper", "vima17", "--method", "pivot", "--folder", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "pivot" in said
    assert "nlap:privileged" in said


def test_of_all_tables_those_whose_world_is_missing_are_left_out_and_say_why(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(names: Any) -> None:
        if any(name.startswith("arms/") for name in names):
            raise ConfigError("the arms are not installed: get them so")

    monkeypatch.setattr(registry, "check_ready", refuse)
    for name in [name for name in PAPER_TABLES if name not in ("toy", "real-robot")]:
        monkeypatch.delitem(PAPER_TABLES, name)
    words = ("--model", "simulated:perfect", "--seeds", "1000:1001", "--no-control", "all", "--jobs", "1")
    assert run(["paper", "all", *words, "--method", "team:paper", "--folder", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "Not run: the arms are not installed: get them so" in said
    assert "100 % (n = 1;" in said


def test_variations_of_an_implicit_goal_are_counted_together() -> None:
    team = Condition("team", "m")
    results = [("all_match", "success"), ("both", "failure"), ("no_area", "success"), ("misplaced", "success")]
    rows = [
        Row(TrialSpec(f"arms/fruit_placement/{task}", 1000, team), TrialRow(outcome, None)) for task, outcome in results
    ]
    head, lines = filled(PAPER_TABLES["real-robot"], Summary(tuple(rows), (), (team,), ()))
    line = dict(zip(head, next(line for line in lines if line[0] == "fruit_placement"), strict=True))
    assert line["ours: team"].startswith("75 % (n = 4;")
    assert line["paper: team:paper"].startswith("100 % (n = 8;")


def test_a_method_of_ones_own_stands_in_a_table_beside_the_others(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    own = tmp_path / "mine.py"
    own.write_text(
        "import wonderful_team as wt\n\n\nclass Waiting:\n    name = 'waiting'\n\n"
        "    def decide(self, situation):\n        return wt.Done('nothing')\n",
        encoding="utf-8",
    )
    words = (
        "pivot",
        "--also",
        f"{own}:Waiting,moka",
        "--method",
        "team:paper",
        "--model",
        "simulated:perfect",
        "--jobs",
        "1",
    )
    quick = ("--seeds", "1000:1001", "--no-control", "all", "--record", "none", "--folder", str(tmp_path / "out"))
    table = told(capsys, *words, *quick)["tables"]["pivot"]
    line = dict(zip(table["head"], table["lines"][0], strict=True))
    assert line["ours: mine.py:Waiting"].startswith("0 % (n = 1;")
    assert line["ours: moka"].startswith("100 % (n = 1;")
    assert (line["ours: pivot"], line["paper: pivot"]) == ("not run yet", "30 % (n = 10; 11 to 60)")
    assert run(["paper", "pivot", "--also", "nobody", *quick]) == 2


def test_a_method_more_is_a_column_or_a_line_as_the_table_has_them() -> None:
    for name in ("vima17", "subgoals", "boxes", "moka", "fetch", "training-based"):
        head, lines = filled(PAPER_TABLES[name], None)
        more_head, more = filled(
            with_methods(PAPER_TABLES[name], ["my/mine.py:Mine", PAPER_TABLES[name].methods[0]]), None
        )
        new = [column for column in more_head if column not in head]
        if name in ("moka", "fetch", "training-based"):
            assert not new
            assert [line[0] for line in more] == [*(line[0] for line in lines), "mine.py:Mine"], name
            assert set(more[-1][1:]) == {"not run", "-"}
        else:
            assert all(column.startswith("ours: mine.py:Mine") for column in new)
            assert len(new) == (2 if name == "subgoals" else 1), name
            assert [line[: len(head)] for line in more] == lines


def test_what_stands_between_backticks_in_a_note_is_set_as_a_command() -> None:
    assert paper_page.as_commands("see `bench <suite>` & more") == "see <code>bench &lt;suite&gt;</code> &amp; more"
