"""Detectors by name: one table, options in the name, own files, and clear words for what is missing."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

import wonderful_team as wt
from wonderful_team.cli.app import run
from wonderful_team.detectors import loading
from wonderful_team.errors import ConfigError, DetectorCodeError, MissingExtraError, UnknownNameError
from wonderful_team.registry.detectors import DETECTORS, DetectorRow, detector_label, make_detector
from wonderful_team.registry.files import names_no_code

OWN = '''
import wonderful_team as wt

class Corner:
    """Finds everything in the top left corner."""

    name = "corner"

    def __init__(self, side: int = 10):
        self.side = side

    def detect(self, rgb, words):
        return [wt.Detection(text, wt.Box(0, 0, self.side, self.side), 0.9) for text in words]

class Nameless:
    def detect(self, rgb, words):
        return []

class Broken:
    def __init__(self):
        raise OSError("no camera")

thing = 3
'''


@pytest.fixture
def own(tmp_path: Path) -> str:
    (tmp_path / "own.py").write_text(OWN, encoding="utf-8")
    return str(tmp_path / "own.py")


def test_the_default_needs_nothing_and_is_made_once() -> None:
    assert make_detector().name == "classical"
    assert make_detector() is make_detector("classical")


def test_every_row_has_a_factory_that_says_what_it_is() -> None:
    for row in DETECTORS.values():
        assert row.words
        assert (row.factory().__doc__ or "").strip()


def test_a_detector_of_ones_own(own: str) -> None:
    made = make_detector(f"{own}:Corner?side=7")
    assert (made.name, made.side) == ("corner", 7)  # type: ignore[attr-defined]
    assert make_detector(made) is made
    assert (detector_label(made), detector_label("owlv2:x")) == ("corner", "owlv2:x")


@pytest.mark.parametrize(
    ("name", "error", "message"),
    [
        ("owlv3", UnknownNameError, "unknown detector 'owlv3'. Did you mean 'owlv2'"),
        ("owlv2:", ConfigError, "the model is empty; valid: owlv2:MODEL"),
        ("classical:big", ConfigError, "'big' is no model of it; valid: classical"),
        ("owlv2:x?treshold=1", UnknownNameError, "unknown argument of owlv2 'treshold'. Did you mean 'threshold'"),
        ("owlv2:x?threshold=high", ConfigError, "argument threshold='high' is not of type float"),
        ("owlv2:x?threshold", ConfigError, "'threshold' is not NAME=VALUE"),
        ("OWN:Nameless", ConfigError, "needs an attribute `name`"),
        ("OWN:thing", ConfigError, r"needs a method detect\(rgb, words\); int has none"),
        ("OWN:Broken", DetectorCodeError, r"raised OSError: no camera \(own.py:"),
        ("OWN:Corne", UnknownNameError, "Did you mean 'Corner'"),
    ],
)
def test_what_is_no_detector_says_why(own: str, name: str, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        make_detector(name.replace("OWN", own))


def test_a_record_names_no_code(own: str) -> None:
    with names_no_code("the record"), pytest.raises(ConfigError, match="the record names code"):
        make_detector(f"{own}:Corner")


@pytest.mark.parametrize("name", ["owlv2", "groundingdino", "langsam"])
def test_a_missing_part_names_the_command_that_brings_it(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loading.importlib.util, "find_spec", lambda module: None)
    with pytest.raises(MissingExtraError, match="'detectors'") as told:
        make_detector(name)
    assert f"{sys.executable} -m pip install" in str(told.value)


def test_a_method_of_ones_own_may_ask_for_the_chosen_detector(own: str, tmp_path: Path) -> None:
    (tmp_path / "looking.py").write_text(
        "import wonderful_team as wt\n\nclass Looking:\n    name = 'looking'\n\n    def __init__(self, make_detector):\n"
        "        self.detector = make_detector()\n\n    def decide(self, situation):\n        return wt.Done('')\n",
        encoding="utf-8",
    )
    for chosen, name in ((None, "classical"), (f"{own}:Corner", "corner")):
        policy = wt.Method(method=f"{tmp_path}/looking.py:Looking", detector=chosen).policy()
        assert policy.detector.name == name  # type: ignore[attr-defined]


def test_a_new_detector_is_its_file_and_one_row(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Corner:
        name = "corner"

        def __init__(self, model: str = "small", side: int = 10) -> None:
            self.model, self.side = model, side

        def detect(self, rgb: object, words: Sequence[str]) -> list[wt.Detection]:
            return [wt.Detection(text, wt.Box(0, 0, self.side, self.side), 0.5) for text in words]

    monkeypatch.setitem(DETECTORS, "corner", DetectorRow("everything in the corner", lambda: Corner))
    made = make_detector("corner:large?side=20")
    assert (made.model, made.side) == ("large", 20)  # type: ignore[attr-defined]
    assert run(["list", "detectors"]) == 0
    assert "everything in the corner" in capsys.readouterr().out
    plan = wt.Team(method="detector-grounding", detector="corner").ground("examples/desk.png", "anything at all")
    assert plan.targets[0].box_px == (0, 0, 10, 10)
