"""`check` of a detector of one's own: what it returns, whether it does so twice, and what it sees where nothing is."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from wonderful_team.cli.app import run

FILE = """
import numpy as np
import wonderful_team as wt

class Dreaming:
    name = "dreaming"
    def detect(self, rgb, words):
        return [wt.Detection(words[0], wt.Box(0, 0, 5, 5), 0.5)]

class Restless:
    name = "restless"
    def __init__(self):
        self.count = 0
    def detect(self, rgb, words):
        self.count += 1
        return [wt.Detection(words[0], wt.Box(0, 0, 5 + self.count, 5), 0.5)] if rgb.std() > 0 else []

class Wrong:
    name = "wrong"
    def detect(self, rgb, words):
        return [wt.Detection("something else", wt.Box(0, 0, 5, 5), 0.5)]

class Nothing:
    name = "nothing"
"""


@pytest.mark.parametrize(
    ("name", "code", "said"),
    [
        ("Dreaming", 1, "it found 1 in an empty picture"),
        ("Restless", 1, "the same picture gave two different answers"),
        ("Wrong", 1, "detector 'wrong', detection 1 is for 'something else', which was not asked for"),
        ("Nothing", 2, "or a detector (detect)"),
    ],
)
def test_what_is_wrong_with_a_detector_is_named(
    name: str, code: int, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "own.py").write_text(FILE, encoding="utf-8")
    assert run(["check", f"{tmp_path}/own.py:{name}", "--json"]) == code
    told = json.loads(capsys.readouterr().out)
    assert said in json.dumps(told, ensure_ascii=False)
