"""`probe --save`, then `plan` with the saved name: the right pixels through a server with odd habits."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

import wonderful_team as wt
from tests.servers.brains import AgentSession, Tapped, Unmatched, offline_brain
from tests.servers.heard import Heard, Reply
from tests.servers.odd import OddEyes
from tests.servers.server import KEY, Rules, WireServer
from tests.servers.speech import Speech, longest_side
from wonderful_team.cli.app import run
from wonderful_team.lab.marks import marked_scene
from wonderful_team.models.profiles import load_profile, profiles_folder
from wonderful_team.registry.models import make_model

ODD_SPEECH = Speech("yx", None, longest_side(720), offset=(9.0, -7.0), digits=1)
"""y first, pixels after its own resize, with a constant offset: every habit at once."""


class Mind:
    """Plans like `offline` when it is asked what lies on the desk; else it points by colour, in the same odd convention."""

    def __init__(self, desk: AgentSession, speech: Speech, eyes: OddEyes | None = None) -> None:
        self._desk, self._plans = desk, offline_brain(desk, speech)
        self._eyes = eyes or OddEyes(speech)

    def __call__(self, heard: Heard) -> Reply:
        try:
            self._desk.find(heard)
        except Unmatched:
            return self._eyes(heard)
        said = self._plans(heard)
        return said if isinstance(said, Reply) else Reply(said)


@pytest.fixture(autouse=True)
def _config(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WONDERFUL_TEAM_CONFIG", str(tmp_path / "config"))
    monkeypatch.setenv("WONDERFUL_TEAM_SERVER_KEY", KEY)


def _photo(tmp_path: Path, size: tuple[int, int] = (1100, 760)) -> tuple[Path, dict[str, tuple[float, float]]]:
    scene = marked_scene(12, size, background="plain")
    path = tmp_path / "desk.png"
    cv2.imwrite(str(path), scene.picture.rgb[..., ::-1])
    return path, {mark.words: mark.centre for mark in scene.marks}


def _found(plan: wt.PlanResult, words: str) -> np.ndarray:
    target = next(target for target in plan.targets if target.words == words)
    assert target.point_px is not None
    return np.array(target.point_px)


@pytest.mark.parametrize("most", [None, 1])
def test_after_probe_save_a_plan_has_the_right_pixels(
    most: int | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    desk = AgentSession()
    photo, places = _photo(tmp_path)
    first, second = list(places)[:2]
    with WireServer(Mind(desk, ODD_SPEECH), Rules(local=True, models=("my-planner",), max_pictures=most)) as server:
        code = run(["probe", f"{server.url}/v1", "--save", "mine", "--price", "0,0", "--most-pictures", "2", "--json"])
        told = capsys.readouterr()
        assert code == 0, told.err
        model = Tapped(make_model("mine"), desk)
        team = wt.Team(model=model, out=tmp_path / "runs", cache="off", allow_unpriced=True)
        plan = team.plan(wt.Observation.from_files(photo), f"put the {first} on the {second}")
    result = json.loads(told.out)["result"]
    assert result["profile"]["convention"]["order"] == "yx"
    assert result["profile"]["convention"]["resize"]["longest_side"] == pytest.approx(720, abs=2)
    assert result["profile"]["max_pictures"] == (most or 2)
    assert result["profile"]["model"] == f"{server.url}/v1#my-planner"
    assert result["saved"] == str(profiles_folder() / "mine.json")
    assert KEY not in told.out + told.err + (profiles_folder() / "mine.json").read_text(encoding="utf-8")
    assert plan.status == "planned", plan.message
    for words in (first, second):
        assert _found(plan, words) == pytest.approx(places[words], abs=4), words


def test_without_the_profile_the_same_server_is_misread(tmp_path: Path) -> None:
    """The control: it is the profile that makes the pixels right."""
    desk = AgentSession()
    photo, places = _photo(tmp_path)
    first, second = list(places)[:2]
    with WireServer(Mind(desk, ODD_SPEECH), Rules(local=True, models=("my-planner",))) as server:
        model = Tapped(make_model(f"{server.url}/v1"), desk)
        team = wt.Team(model=model, out=tmp_path / "runs", cache="off", allow_unpriced=True)
        plan = team.plan(wt.Observation.from_files(photo), f"put the {first} on the {second}")
    points = [target.point_px for target in plan.targets if target.words == first]
    assert not any(point is not None and np.hypot(*(np.array(point) - places[first])) < 20 for point in points)


def test_a_bad_fit_is_saved_as_labelled_axes_and_list_shows_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with WireServer(OddEyes(nonsense=True), Rules(local=True, key=None)) as server:
        words = ["probe", f"{server.url}/v1#odd", "--save", "bad", "--max-tokens", "9000000", "--most-pictures", "1"]
        assert run(words) == 0
        told = capsys.readouterr().out
        assert "do not use native boxes" in told
        assert load_profile("bad").axes
        assert getattr(make_model("bad"), "weak_pointing", False)
        assert run(["list", "models"]) == 0
    assert "no convention fits: labelled axes, no native boxes" in capsys.readouterr().out


def _sees_nothing(heard: Heard) -> Reply:
    found = dict.fromkeys(re.findall(r"\bT\d+\b", heard.words))
    targets = [{"id": name, "found": False, "box": None, "points": []} for name in found]
    return Reply(json.dumps({"reasoning": "", "targets": targets}))


@pytest.mark.parametrize("brain", [lambda heard: Reply(""), _sees_nothing])
def test_where_nothing_was_measured_no_profile_is_kept_and_the_exit_code_says_so(
    brain: Callable[[Heard], Reply], capsys: pytest.CaptureFixture[str]
) -> None:
    with WireServer(brain, Rules(local=True, key=None)) as server:
        assert run(["probe", f"{server.url}/v1#odd", "--save", "none", "--price", "0,0", "--most-pictures", "4"]) == 1
    told = capsys.readouterr()
    assert "nothing was measured, and no profile is kept" in told.err
    assert "answered rightly" not in told.out + told.err
    assert not (profiles_folder() / "none.json").exists()


def test_a_failure_is_told_with_the_models_name_also_without_save(capsys: pytest.CaptureFixture[str]) -> None:
    with WireServer(OddEyes(), Rules(local=True, key=None)) as server:
        server.always("error_500")
        assert run(["probe", f"{server.url}/v1#odd", "--price", "0,0"]) == 3
    assert f"error: {server.url}/v1#odd: the provider failed" in capsys.readouterr().err


def test_an_unknown_price_needs_a_cap(capsys: pytest.CaptureFixture[str]) -> None:
    with WireServer(OddEyes(), Rules(local=True, key=None)) as server:
        assert run(["probe", f"{server.url}/v1#odd"]) == 2
        assert "--max-tokens" in capsys.readouterr().err
        assert not server.log


def test_wrong_use_is_told_before_anything_is_sent(capsys: pytest.CaptureFixture[str]) -> None:
    with WireServer(OddEyes(), Rules(local=True, key=None)) as server:
        assert run(["probe", f"{server.url}/v1#odd", "--save", "openai", "--price", "0,0"]) == 2
        assert run(["probe", "http://8.8.8.8/v1#odd", "--local-only", "--price", "0,0"]) == 2
        assert run(["probe", "nothing-of-the-kind"]) == 2
        assert not server.log
    assert run(["probe", "http://127.0.0.1:9/v1", "--price", "0,0"]) == 3
    assert "no model server answers" in capsys.readouterr().err


def test_a_cap_that_is_reached_ends_with_code_5_and_keeps_the_profile(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with WireServer(OddEyes(), Rules(local=True, key=None)) as server:
        words = ["probe", f"{server.url}/v1#odd", "--save", "part", "--price", "1,2", "--max-calls", "7", "--json"]
        assert run(words) == 5
    document = json.loads(capsys.readouterr().out)
    assert document["exit_code"] == 5
    assert document["error"]["type"] == "BudgetReached"
    profile = load_profile("part")
    assert profile.native_boxes
    assert (profile.usd_in, profile.usd_out) == (1.0, 2.0)
    assert any("stopped early" in warning for warning in profile.warnings)
