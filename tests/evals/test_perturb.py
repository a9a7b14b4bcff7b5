"""Harder tiers: in the simulator where it can make them, else in its pictures."""

from __future__ import annotations

from pathlib import Path

import pytest

import wonderful_team as wt
from tests.evals.own_files import LENIENT
from wonderful_team.api.trial import make_scene
from wonderful_team.core.protocols import World
from wonderful_team.errors import ConfigError
from wonderful_team.evals.perturb import perturbed
from wonderful_team.evals.trials import Condition, TrialSpec


def test_our_tabletop_makes_harder_scenes_and_other_worlds_change_their_pictures(tmp_path: Path) -> None:
    def scene(tier: str, task: str = "tabletop/rotate") -> World:
        return make_scene(TrialSpec(task, 7, Condition("team", "offline", perturb=tier)))

    (tmp_path / "desk.py").write_text(LENIENT, encoding="utf-8")
    own = f"{tmp_path / 'desk.py'}:AgentSession"
    plain = scene("")
    try:
        before = plain.observe().main
        for tier, physical in (("clutter=2", True), ("camera=2", True), ("lighting=3", True), ("paraphrase=1", False)):
            harder = scene(tier)
            try:
                after = harder.observe().main
                assert (after.rgb != before.rgb).any() == physical
                things = len(harder.privileged.truth()["things"])  # type: ignore[attr-defined]
                assert (things > len(plain.privileged.truth()["things"])) == tier.startswith("clutter")  # type: ignore[attr-defined]
                if tier.startswith("camera"):
                    spot = [(0.5, 0.1, 0.0)]
                    assert abs(after.camera.project(spot) - before.camera.project(spot)).max() > 1.0  # type: ignore[union-attr]
            finally:
                harder.close()
    finally:
        plain.close()
    assert (scene("lighting=2", own).observe().main.rgb != scene("", own).observe().main.rgb).any()
    with pytest.raises(ConfigError, match="cannot put more things on its table; our tabletop can"):
        wt.Study(own, perturb="clutter=1", store=tmp_path / "s.db")


@pytest.mark.parametrize("words", ["lighting=2", "camera=3", "texture=2", "paraphrase=1"])
def test_harder_tiers_change_what_is_seen_or_said_and_keep_the_truth(words: str) -> None:
    plain = wt.make_world("tabletop/rotate", seed=1000)
    harder = perturbed(plain, words, 1000)
    try:
        seen, before = harder.observe(), plain.observe()
        if words.startswith("paraphrase"):
            assert harder.instruction.text != plain.instruction.text
            assert set(harder.instruction.slots) == set(plain.instruction.slots)
        else:
            assert seen.hash != before.hash
            assert seen.hash == harder.observe().hash
        for action in plain.privileged.oracle():  # type: ignore[attr-defined]
            harder.execute(action)
        assert harder.privileged.score().success is True  # type: ignore[attr-defined]
    finally:
        plain.close()
