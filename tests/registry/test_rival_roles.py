"""Rivals have roles of their own: a model for one of them, and truth in the place of a part, reach them as they reach the team."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import wonderful_team as wt
from wonderful_team import registry
from wonderful_team.api.trial import check_isolation
from wonderful_team.cli.app import run
from wonderful_team.errors import ConfigError, UnknownNameError

BLIND = "simulated:perfect:missed=1"
"""Plans rightly and finds nothing."""


def bench(capsys: pytest.CaptureFixture[str], store: Path, *words: str) -> dict[str, str]:
    """Successes of n, by condition."""
    command = [
        "bench",
        *words,
        "--no-control",
        "all",
        "--record",
        "none",
        "--jobs",
        "1",
        "--store",
        str(store),
        "--json",
    ]
    assert run(command) == 0
    told: dict[str, Any] = json.loads(capsys.readouterr().out)["result"]
    return {
        f"{one['method']} {one['model']} {one['isolate']}".strip(): f"{one['successes']}/{one['scored']}"
        for one in told["conditions"]
    }


def test_every_rival_says_whom_it_asks_as() -> None:
    assert registry.roles_of("pivot") == ("drafter", "selector")
    assert registry.roles_of("nlap:privileged") == ("reasoner",)
    assert registry.roles_of("team:-mover") == registry.roles_of("team")
    assert registry.grounding_roles("pivot") == ("selector",)
    assert set(registry.all_roles()) >= {"checker", "selector", "extractor", "pointer"}


def test_a_model_for_a_role_reaches_a_rival(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ("tabletop/rotate", "--seeds", "1000", "--method", "nlap", "--replans", "0")
    found = bench(capsys, tmp_path / "s.db", *words, "--model", f"simulated:perfect,extractor={BLIND}")
    assert found == {f"nlap simulated:perfect, extractor={BLIND}": "1/1"}, "the list holds all that shows"
    words = ("tabletop/rotate", "--seeds", "1000", "--method", "pivot")
    found = bench(capsys, tmp_path / "p.db", *words, "--model", f"simulated:perfect,selector={BLIND}")
    assert found == {f"pivot simulated:perfect, selector={BLIND}": "0/1"}


def test_truth_takes_the_place_of_a_rivals_part(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ("tabletop/rotate", "--seeds", "1000", "--method", "pivot", "--model", BLIND)
    found = bench(capsys, tmp_path / "s.db", *words, "--isolate", "whole,planning,grounding")
    assert found == {f"pivot {BLIND}": "0/1", f"pivot {BLIND} planning": "1/1", f"pivot {BLIND} grounding": "0/1"}


def test_a_role_or_a_part_that_a_rival_has_not_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(UnknownNameError, match="role of method 'direct' 'checker'.*planner"):
        wt.Team(method="direct", model={"*": "offline", "checker": "offline"})
    with pytest.raises(UnknownNameError, match="role of method 'pivot' 'checker'.*drafter, selector"):
        wt.Study("rotate", methods=["team", "pivot"], models=["offline, checker=offline"], store=tmp_path / "s.db")
    with pytest.raises(UnknownNameError, match="role of method 'team' 'selector'"):
        wt.Method(method="team", thinking={"selector": "low"})
    for method in ("direct", "nlap:privileged", "point"):
        with pytest.raises(ConfigError, match="valid: .*pivot.*nlap"):
            check_isolation("grounding", [method])
    check_isolation("planning", ["pivot", "nlap", "nlap:text:no-cot", "team:-verification"])


def test_nlap_says_where_things_are(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    methods = "nlap,nlap:privileged"
    words = ("pointing", "--seeds", "1000:1002", "--method", methods, "--model", "simulated:perfect")
    found = bench(capsys, tmp_path / "s.db", *words)
    assert set(found.values()) == {"2/2"}
    off = bench(capsys, tmp_path / "o.db", *words[:-1], "simulated:perfect:spread=0.2")
    assert off["nlap simulated:perfect:spread=0.2"] != "2/2"
    assert off["nlap:privileged simulated:perfect:spread=0.2"] == "2/2"
