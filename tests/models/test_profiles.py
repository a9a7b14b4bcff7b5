"""Profiles: what was measured comes back as it was, and a broken file says which one it is."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.lab.statistics import counted, distributed
from wonderful_team.models.conventions import CONVENTIONS, Convention, Resize
from wonderful_team.models.error_profile import (
    STATES,
    WORDS,
    Boxes,
    Confusion,
    Detection,
    ErrorProfile,
    Pointing,
    SceneKind,
)
from wonderful_team.models.profiles import (
    FitFigures,
    Profile,
    config_folder,
    load_profile,
    profile_from_json,
    profile_names,
    profile_to_json,
    profiles_folder,
    save_profile,
    saved_profiles,
)


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WONDERFUL_TEAM_CONFIG", str(tmp_path / "config"))


def errors() -> ErrorProfile:
    return ErrorProfile(
        scenes=[SceneKind(kind="synthetic", seeds=[1000], targets=6)],
        detection=Detection(missed=counted(1, 6), imagined=counted(0, 0)),
        pointing=Pointing(radial=distributed([0.01, 0.02]), wild=counted(0, 2), wild_beyond=0.04),
        boxes=Boxes(iou=distributed([0.8]), edge=distributed([]), wild=counted(0, 1)),
        judgement=Confusion(
            counts={state: dict.fromkeys(WORDS, 1) for state in STATES},
            wrongly_accepted=counted(4, 12),
            wrongly_refused=counted(2, 3),
        ),
        failed_requests=counted(0, 9),
    )


@pytest.mark.parametrize("name", CONVENTIONS)
def test_every_convention_comes_back_from_its_file(name: str) -> None:
    profile = Profile(name, "http://127.0.0.1:8000/v1#m", convention=CONVENTIONS[name], warnings=("a", "b"))
    path = save_profile(profile)
    assert path == profiles_folder() / f"{name}.json"
    assert load_profile(name) == profile


@given(
    scale=st.tuples(st.floats(0.1, 9), st.floats(0.1, 9)),
    offset=st.tuples(st.floats(-90, 90), st.floats(-90, 90)),
    side=st.integers(28, 4000),
    clamped=st.none() | st.tuples(st.none() | st.floats(-5, 5), st.floats(900, 1000)),
)
def test_any_measured_profile_survives_json(
    scale: tuple[float, float], offset: tuple[float, float], side: int, clamped: tuple[float | None, float] | None
) -> None:
    convention = Convention(
        "probed", "yx", "pixels", Resize(longest_side=side, always=True), scale=scale, offset=offset
    )
    profile = Profile(
        "mine", "m", convention=convention, fit=FitFigures(24, 20, 1, 1.5, clamped=clamped), errors=errors()
    )
    assert profile_from_json(profile_to_json(profile)) == profile


def test_the_line_says_what_matters() -> None:
    profile = Profile(
        "mine", "http://gpu3:8000/v1#my-planner", "my-planner", "http://gpu3:8000/v1",
        convention=CONVENTIONS["qwen3-vl"], max_pictures=8, max_pictures_reached=True, probed="2026-11-20",
        fit=FitFigures(median_px=6.2),
    )  # fmt: skip
    assert profile.line == (
        "my-planner at http://gpu3:8000/v1 (probed 2026-11-20: 0-1000 x-first, error 6.2 px, 8 pictures)"
    )


def test_unknown_and_broken_profiles_say_so() -> None:
    save_profile(Profile("mine", "m"))
    with pytest.raises(UnknownNameError, match="Did you mean 'mine'"):
        load_profile("mime")
    (profiles_folder() / "old.json").write_text('{"schema_version": 99}', encoding="utf-8")
    (profiles_folder() / "cut.json").write_text('{"schema', encoding="utf-8")
    with pytest.raises(ConfigError, match=r"old\.json.*schema version 1"):
        load_profile("old")
    assert profile_names() == ["cut", "mine", "old"]
    found = saved_profiles()
    assert isinstance(found["mine"], Profile)
    assert "cut.json" in str(found["cut"])


def test_a_value_out_of_range_names_its_field() -> None:
    held = json.loads(profile_to_json(Profile("mine", "m")))
    held["convention"]["order"] = "zx"
    with pytest.raises(ValueError, match=r"convention\.order"):
        profile_from_json(json.dumps(held))


@pytest.mark.parametrize("name", ["offline", "openai", "a:b", "../up", "", "x.py", "http", ".hidden", "a" * 70])
def test_names_that_would_be_mistaken_for_models_or_files_are_refused(name: str) -> None:
    with pytest.raises(ConfigError, match="profile name"):
        save_profile(Profile(name, "m"))


def test_the_folder_follows_the_usual_variables() -> None:
    assert config_folder({"WONDERFUL_TEAM_CONFIG": "/own"}) == Path("/own")
    assert config_folder({"XDG_CONFIG_HOME": "/xdg"}) == Path("/xdg/wonderful-team")
    assert config_folder({}) == Path.home() / ".config" / "wonderful-team"


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(ConfigError, match="WONDERFUL_TEAM_CONFIG"):
        save_profile(Profile("mine", "m"), tmp_path / "file")
