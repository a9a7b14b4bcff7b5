"""`--record`: which trials keep their run folder, and what is said of those that do not."""

from __future__ import annotations

import json
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import wonderful_team as wt
from wonderful_team.api.trial import run_trial
from wonderful_team.cli.app import run
from wonderful_team.core.caps import Caps
from wonderful_team.errors import ConfigError, FileNotWrittenError
from wonderful_team.evals.again import command_again
from wonderful_team.evals.store import Store
from wonderful_team.evals.trials import Condition, RunSettings, TrialSpec
from wonderful_team.record import run_files

MODELS = "simulated:perfect,simulated:perfect:missed=1"
"""One that solves the scene, one that finds nothing in it."""


def bench(tmp_path: Path, record: str) -> int:
    return run(
        ["bench", "rotate", "--seeds", "1000", "--model", MODELS, "--no-control", "all", "--jobs", "1"]
        + ["--record", record, "--out", str(tmp_path / "runs"), "--store", str(tmp_path / "s.db")]
    )  # fmt: skip


def pages(tmp_path: Path) -> dict[str, str]:
    """What the store says of pages, by outcome."""
    with Store(tmp_path / "s.db") as store:
        return {row.result.outcome: row.result.page for row in store.rows() if row.result is not None}


def told(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    assert run([*words, "--json"]) == 0
    found: dict[str, Any] = json.loads(capsys.readouterr().out)["result"]
    return found


def test_failures_alone_keep_their_record_and_the_rest_say_how_to_get_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert bench(tmp_path, "failures") == 0
    assert "records: 1 of 2 trials keep a run folder (--record failures)" in capsys.readouterr().out
    kept = pages(tmp_path)
    assert kept["success"] == ""
    assert Path(kept["failure"]).is_file()
    assert (Path(kept["failure"]).parent / "record.json").is_file()
    trials = {one["ended"].partition(" ")[0]: one for one in told(capsys, "show", str(tmp_path / "s.db"))["trials"]}
    assert trials["FAILURE"]["again"] is None
    # The command that is told makes the record that is missing.
    words = shlex.split(trials["SUCCESS"]["again"])
    assert words[:3] == ["wonderful-team", "bench", "tabletop/rotate"]
    again = [*words[1:-1], str(tmp_path / "again.db"), "--out", str(tmp_path / "again"), "--jobs", "1"]
    assert run(again) == 0
    with Store(tmp_path / "again.db") as store:
        (row,) = store.rows()
    assert row.result is not None
    assert Path(row.result.page).is_file()
    capsys.readouterr()
    assert run(["list", "runs", "--out", str(tmp_path / "runs")]) == 0
    assert "1 trial of studies with a record" in capsys.readouterr().out


def test_without_records_the_report_says_how_to_get_one_and_nothing_is_run_twice(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert bench(tmp_path, "none") == 0
    assert pages(tmp_path) == {"success": "", "failure": ""}
    assert not (tmp_path / "runs").exists()
    assert run(["report", str(tmp_path / "s.db")]) == 0
    html = (tmp_path / "s.html").read_text(encoding="utf-8")
    assert "its record was not kept" in html
    assert "bench tabletop/rotate --seeds 1000 --method team --model simulated:perfect:missed=1" in html
    before = (tmp_path / "s.db").read_bytes()
    assert bench(tmp_path, "full") == 0, "what ended is not run again for its record alone"
    assert pages(tmp_path) == {"success": "", "failure": ""}
    assert len(before) > 0
    capsys.readouterr()
    assert run(["show", "runs/trials/0123456789ab", "--out", str(tmp_path / "runs")]) == 2
    assert "show STORE.db" in capsys.readouterr().err


def test_the_command_says_all_that_the_trial_is() -> None:
    how = "thinking high, checker thinking low, thorough, detector owlv2, at most 9 calls, at most 0.5 USD"
    condition = Condition("team", "big, checker=small", "planning", "clutter=2", 3, how, 1)
    words = shlex.split(command_again(TrialSpec("tabletop/rotate", 1003, condition, 2)))
    pairs = dict(zip(words[3::2], words[4::2], strict=False))
    assert pairs["--seeds"] == "1003"
    assert "--model big,checker=small" in " ".join(words)
    for said in (
        "--isolate planning", "--perturb clutter=2", "--replans 3", "--reobserve 1", "--repeats 3", "--thinking high",
        "--thinking checker=low", "--thorough", "--detector owlv2", "--trial-max-calls 9", "--trial-max-usd 0.5",
    ):  # fmt: skip
        assert said in " ".join(words)
    assert "--seeds" not in command_again(TrialSpec("p.json", 3, condition))


def test_the_old_name_works_and_a_wrong_word_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ConfigError, match="valid are full, failures, none"):
        wt.Study("rotate", store=tmp_path / "s.db", record="some")  # type: ignore[arg-type]
    with pytest.warns(DeprecationWarning, match="record"):
        assert wt.Study("rotate", store=tmp_path / "s.db", pages="all").record == "full"  # type: ignore[call-arg]
    words = ["bench", "toy/pointing", "--seeds", "1000", "--method", "point", "--jobs", "1", "--pages", "all"]
    assert run([*words, "--store", str(tmp_path / "s.db")]) == 0
    assert "--pages is called --record now" in capsys.readouterr().err


def test_of_a_trial_that_succeeds_no_picture_and_no_page_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []
    real = run_files.RunFiles.write
    monkeypatch.setattr(
        run_files.RunFiles, "write", lambda self, name, content: (written.append(name), real(self, name, content))[1]
    )
    settings = RunSettings(record="failures", out=tmp_path)
    spec = TrialSpec("tabletop/rotate", 1000, Condition("team", "simulated:perfect"))
    assert run_trial(spec, settings).outcome == "success"
    assert written == []
    # With a limit on time a trial is written as it goes: at its end there may be no time left.
    limited = run_trial(spec, replace(settings, caps=Caps(seconds=500.0)))
    assert (limited.outcome, limited.page) == ("success", "")
    assert "record.json" in written
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_a_trial_whose_records_have_no_place_ends_before_it_asks_anything(tmp_path: Path) -> None:
    (tmp_path / "runs").write_text("a file", encoding="utf-8")
    spec = TrialSpec("tabletop/rotate", 1000, Condition("team", "simulated:perfect"))
    with pytest.raises(FileNotWrittenError, match="runs"):
        run_trial(spec, RunSettings(record="failures", out=tmp_path / "runs"))
