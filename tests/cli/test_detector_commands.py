"""Detectors on the command line: listed with their forms, told by doctor, refused where nothing looks with one."""

from __future__ import annotations

import importlib
import json

import pytest

from wonderful_team.cli.app import run
from wonderful_team.registry.detectors import DETECTORS


def test_list_names_every_detector_and_how_one_is_written(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["list", "detectors", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)["result"]["detectors"]
    assert set(DETECTORS) <= set(listed)
    assert {"NAME:MODEL", "NAME?OPTION=VALUE&...", "FILE.py:NAME"} <= set(listed)
    assert run(["list", "methods"]) == 0
    said = capsys.readouterr().out
    assert "detector-grounding" in said
    assert "single-call-grounding" in said


def test_doctor_says_whether_the_optional_part_is_there(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    doctor = importlib.import_module("wonderful_team.cli.doctor")
    monkeypatch.setattr(doctor, "find_spec", lambda name: None if name == "torch" else object())
    assert run(["doctor", "--json"]) == 0
    found = {item["name"]: item for item in json.loads(capsys.readouterr().out)["result"]["findings"]}["extras"]
    assert "detectors not installed (optional)" in found["text"]
    assert "detectors: " in found["optional"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--detector", "owl"], "unknown detector 'owl'. Did you mean 'owlv2'"),
        (["--detector", "classical", "--method", "team:paper"], "method 'team:paper' looks with no detector"),
        (["--detector", "classical?size=3"], "argument of classical 'size'"),
    ],
)
def test_a_wrong_detector_is_refused_before_anything_is_done(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["ground", "examples/desk.png", "red block", *words]) == 2
    assert said in capsys.readouterr().err
