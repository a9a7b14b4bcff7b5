"""A study with a detector: it goes to the methods that look with one, is part of what the store knows a trial by, and is told."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import wonderful_team as wt
from wonderful_team.api.trial_setup import fingerprint, method_options, reproduce
from wonderful_team.cli.app import run
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.evals.store import Store
from wonderful_team.evals.trials import Condition, TrialSpec

OWN = """
import wonderful_team as wt

class Blind:
    name = "blind"
    def detect(self, rgb, words):
        return []
"""


def test_two_detectors_are_two_conditions_of_one_store(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], runs_folder: Path
) -> None:
    (tmp_path / "own.py").write_text(OWN, encoding="utf-8")
    store = tmp_path / "s.db"
    for more in ((), ("--detector", f"{tmp_path}/own.py:Blind")):
        words = ["bench", "tabletop/everyday/tidy_up", "--seeds", "1000:1001", "--method", "detector-grounding"]
        words += [
            "--replans",
            "0",
            "--no-control",
            "all",
            "--jobs",
            "1",
            "--record",
            "full",
            "--store",
            str(store),
            *more,
        ]
        assert run(words) == 0, capsys.readouterr()
    with Store(store) as opened:
        rows = {row.spec.condition.how: row.result for row in opened.rows()}
    assert set(rows) == {"", f"detector {tmp_path}/own.py:Blind"}
    plain, blind = rows[""], rows[f"detector {tmp_path}/own.py:Blind"]
    assert plain is not None
    assert plain.outcome == "success", plain.reason
    assert blind is not None
    assert (blind.outcome, blind.stage) == ("failure", "grounding")
    named = [json.loads(file.read_text())["configuration"]["detector"] for file in runs_folder.rglob("record.json")]
    assert sorted(named) == sorted(["classical", f"{tmp_path}/own.py:Blind"])


def test_a_detector_is_for_the_methods_that_look_with_one() -> None:
    asked = {"detector": "owlv2", "timeout": 3.0}
    assert method_options(asked, "team") == {"timeout": 3.0}
    assert method_options(asked, "detector-grounding") == asked
    spec = TrialSpec("tabletop/rotate", 1000, Condition("detector-grounding", "offline"))
    assert "--method detector-grounding --detector owlv2" in reproduce(spec, asked)


def test_a_study_in_which_nothing_looks_with_a_detector_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="none of the methods looks with one: team"):
        wt.Study("tabletop/rotate", detector="classical", store=tmp_path / "s.db")
    with pytest.raises(ConfigError, match="lets truth ground, and in 'detector-grounding' a detector does"):
        wt.Study("tabletop/rotate", methods="detector-grounding", isolate="planning", store=tmp_path / "s.db")
    with pytest.raises(UnknownNameError, match="unknown detector 'owl'"):
        wt.Study("tabletop/rotate", methods="detector-grounding", detector="owl", store=tmp_path / "s.db")


def test_a_result_names_the_detectors_file_by_its_hash(tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text(OWN, encoding="utf-8")
    asked = {"detector": f"{tmp_path}/own.py:Blind"}
    spec = TrialSpec("tabletop/rotate", 1000, Condition("detector-grounding", "offline"))
    assert set(fingerprint(spec, asked)) - set(fingerprint(spec)) == {asked["detector"]}
    team = TrialSpec("tabletop/rotate", 1000, Condition("team", "offline"))
    assert fingerprint(team, asked) == fingerprint(team)
