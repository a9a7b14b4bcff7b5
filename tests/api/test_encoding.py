"""Which files pictures are sent as, from every door."""

from __future__ import annotations

from typing import Any

import pytest

import wonderful_team as wt
from wonderful_team.api.study import Study
from wonderful_team.api.trial_setup import reproduce
from wonderful_team.errors import ConfigError
from wonderful_team.evals.trials import Condition, TrialSpec

SERVER = "http://127.0.0.1:9/v1#m"


def encodings(**how: Any) -> set[str]:
    team = wt.Team(model=SERVER, allow_unpriced=True, cache="off", **how)
    assert team.configuration()["encoding"] == how.get("encoding", "auto")
    return {model.settings.encoding for model in team._models.values()}  # type: ignore[attr-defined]


def test_a_team_hands_it_to_every_provider() -> None:
    assert encodings() == {"auto"}
    assert encodings(encoding="png") == {"png"}
    with pytest.raises(ConfigError, match="encoding 'gif': valid are auto, png, jpeg"):
        encodings(encoding="gif")


def test_a_study_hands_it_on_and_its_trials_are_others() -> None:
    study, plain = (Study(suite="rotate", seeds=range(1, 2), **how) for how in ({"encoding": "png"}, {}))
    assert study._asked()["encoding"] == "png"
    assert study._how() != plain._how()
    assert "pictures as png" in study._how()
    trial = TrialSpec("tabletop/rotate", 1, Condition("team", SERVER))
    assert "--encoding png" in reproduce(trial, {"encoding": "png"})
    assert "--encoding" not in reproduce(trial, {"encoding": "auto"})
