"""Choosing models on the command line and in Python: names, thinking, prices, where they may be."""

from __future__ import annotations

from pathlib import Path

import pytest

import wonderful_team as wt
from tests.servers.brains import AgentSession, Tapped, offline_brain
from tests.servers.server import KEY, Rules, WireServer
from tests.servers.wiring import WIRES
from wonderful_team.cli import main
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.models.prices import GivenPrice
from wonderful_team.models.profiles import CONFIG_VARIABLE, Profile, save_profile
from wonderful_team.models.providers import VENDORS
from wonderful_team.models.providers.options import model_options
from wonderful_team.registry.models import make_models
from wonderful_team.registry.role_models import read_roles

SERVER = "http://127.0.0.1:9/v1#mine"
ROLES = ("supervisor", "manager", "checker")


@pytest.fixture(autouse=True)
def nothing_set(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in [key for vendor in VENDORS.values() for key in vendor.keys]:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv(CONFIG_VARIABLE, str(tmp_path / "config"))
    monkeypatch.setenv("WONDERFUL_TEAM_RUNS", str(tmp_path / "runs"))


def run(*words: str) -> int:
    try:
        main(["run", "tabletop/rotate", *words])
    except SystemExit as done:
        return int(done.code or 0)
    raise AssertionError("main returned")


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["--model", "openai:gpt-5"], 2, "set the environment variable OPENAI_API_KEY"),
        (["--model", "anthropic:x"], 2, "ANTHROPIC_API_KEY"),
        (["--model", "google:x"], 2, "GOOGLE_API_KEY or GEMINI_API_KEY"),
        (["--model", "openai:gpt-5", "--local-only"], 2, "--local-only"),
        (
            ["--model", "http://127.0.0.1:9/v1", "--allow-unpriced"],
            3,
            "no model server answers at http://127.0.0.1:9/v1",
        ),
        (["--model", SERVER], 2, "no price is known for http://127.0.0.1:9/v1#mine"),
        (["--model", SERVER, "--max-usd", "1"], 2, "no price is known"),
        (["--model", f"checker={SERVER}"], 2, "no price is known"),
        (["--thinking", "hard"], 2, "valid are off, low, medium, high"),
        (["--thinking", "chequer=low"], 2, "Did you mean 'checker'?"),
        (["--thinking", "low", "--thinking", "high"], 2, "two values"),
        (["--price", "cheap"], 2, "--price 'cheap'"),
    ],
)
def test_wrong_choices_are_told_before_anything_runs(
    words: list[str], code: int, says: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run(*words) == code
    told = capsys.readouterr().err
    assert says in told
    assert "Traceback" not in told
    assert not (tmp_path / "runs").exists()


def test_an_unpriced_server_may_be_used_with_a_cap_consent_or_a_price() -> None:
    for options in ({"max_tokens": 100_000}, {"allow_unpriced": True}, {"price": "0,0"}, {"price": {"*": "1,2"}}):
        assert wt.Team(model=SERVER, **options).model_name == SERVER  # type: ignore[arg-type]


def test_each_role_may_have_its_own_model_thinking_and_price() -> None:
    options = model_options({"*": "low", "checker": "off"}, {"*": "1,2", "manager": "3,4"}, False, ROLES)
    made = make_models({"*": SERVER, "supervisor": "offline"}, ROLES, options)
    manager, checker = made["manager"], made["checker"]
    assert type(made["supervisor"]).__name__ == "OfflineModel"
    assert (manager.settings.thinking, manager.prices) == ("low", GivenPrice(3, 4))  # type: ignore[attr-defined]
    assert (checker.settings.thinking, checker.prices) == ("off", GivenPrice(1, 2))  # type: ignore[attr-defined]


def test_roles_that_share_a_name_and_options_share_a_model() -> None:
    made = make_models(SERVER, ROLES, model_options("high", None, False, ROLES))
    assert len({id(model) for model in made.values()}) == 1


def test_a_role_that_does_not_exist_is_refused() -> None:
    with pytest.raises(UnknownNameError):
        model_options({"chequer": "low"}, None, False, ROLES)


def test_values_by_role_are_read() -> None:
    assert read_roles(["low", "checker=off"], "--thinking", "LEVEL") == {"*": "low", "checker": "off"}
    with pytest.raises(ConfigError, match="--thinking 'checker='"):
        read_roles(["checker="], "--thinking", "LEVEL")


def test_a_saved_profile_is_a_models_name() -> None:
    save_profile(Profile("mine", SERVER, native_boxes=False, axes=True, usd_in=1.0, usd_out=1.0))
    team = wt.Team(model="mine")
    assert team.model_name == "mine"
    assert team.configuration()["axes"]


def test_weak_pointers_get_labelled_axes_and_others_do_not() -> None:
    assert wt.Team(model=SERVER, allow_unpriced=True).configuration()["axes"]
    strong = "http://127.0.0.1:9/v1#gemini-x"
    assert not wt.Team(model=strong, allow_unpriced=True).configuration()["axes"]
    assert not wt.Team(model="offline").configuration()["axes"]


def test_a_plan_over_the_wire_names_its_model_and_leaves_no_key_in_any_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("WONDERFUL_TEAM_SERVER_KEY", KEY)
    wire, desk = WIRES["server"], AgentSession()
    world = wt.make_world("tabletop/rotate", seed=3)
    with WireServer(offline_brain(desk, wire.speech), Rules(local=True)) as server:
        model = Tapped(wire.provider(server, api_key=None, price=GivenPrice(1, 1), deadline_s=60), desk)
        made = wt.Team(model=model, out=tmp_path / "runs", cache="off").plan(world.observe(), world.instruction)
    assert made.status == "planned"
    assert made.usage.usd == pytest.approx(made.usage.tokens / 1e6)
    for path in (tmp_path / "runs").rglob("*"):
        assert path.is_dir() or KEY.encode() not in path.read_bytes()
