"""How long one reply may take, from every door."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

import wonderful_team as wt
from tests.models.providers.asking import question
from wonderful_team.api.study import Study
from wonderful_team.cli.app import run
from wonderful_team.errors import ConfigError, ModelUnavailableError
from wonderful_team.models.providers import Provider

SERVER = "http://127.0.0.1:9/v1#m"


def providers(team: wt.Team) -> set[float | None]:
    """The time-outs of a team's providers, inside of their caches."""
    held: list[Any] = [getattr(model, "settings", None) for model in team._models.values()]
    return {settings.timeout_s for settings in held}


def test_a_team_hands_its_timeout_to_every_provider() -> None:
    assert providers(wt.Team(model=SERVER, timeout=777, allow_unpriced=True, cache="off")) == {777}
    assert providers(wt.Team(model=SERVER, allow_unpriced=True, cache="off")) == {None}
    with pytest.raises(ConfigError, match="seconds above 0"):
        wt.Team(model=SERVER, timeout=0, allow_unpriced=True)


def test_a_model_of_ones_own_has_it_as_its_deadline() -> None:
    class Slow:
        name = "slow"

        async def answer(self, request: Any) -> Any:
            await asyncio.sleep(30)

    client = wt.Team(model=Slow(), timeout=0.2).client()
    with pytest.raises(ModelUnavailableError, match=r"within 0\.2 s"):
        asyncio.run(client.ask(question()))


def test_every_method_waits_as_long_for_a_model_of_ones_own() -> None:
    class Own:
        name = "own"

        async def answer(self, request: Any) -> Any:
            return "none"

    for method in ("team", "team:paper"):
        assert wt.Team(model=Own(), method=method, timeout=0.2).policy()._client._deadline_s == 0.2


def test_a_study_hands_it_on() -> None:
    study = Study(suite="rotate", models=["offline"], seeds=range(1, 2), timeout=12.5)
    assert study._asked()["timeout"] == 12.5


@pytest.mark.parametrize("command", ["plan", "ground", "run", "bench", "probe"])
def test_every_command_that_asks_a_model_takes_it(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([command, "--help"]) == 0
    assert "--timeout" in capsys.readouterr().out


def test_the_flag_reaches_the_provider(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    seen = []

    async def answer(self: Provider, request: Any) -> Any:
        seen.append(self.settings.timeout_s)
        raise ConfigError("enough")

    monkeypatch.setattr(Provider, "answer", answer)
    picture = tmp_path / "p.png"
    from tests.models.providers.asking import small_scene
    from wonderful_team.images import to_png

    picture.write_bytes(to_png(small_scene().rgb))
    words = ["plan", str(picture), "put the cube there", "--model", SERVER, "--timeout", "9", "--max-tokens", "99999"]
    assert run([*words, "--cache", "off", "--out", str(tmp_path / "runs")]) == 2
    assert set(seen) == {9.0}
