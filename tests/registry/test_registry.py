"""Names to things, files to things, and who is handed the truth."""

from __future__ import annotations

from pathlib import Path

import pytest

import wonderful_team as wt
from wonderful_team import registry
from wonderful_team.core.protocols import Privileged, offers, privileged
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.planning import ABLATIONS


class Echo:
    name = "echo"

    def answer(self, request: wt.Request) -> None:
        return None


def file(tmp_path: Path, content: str) -> str:
    path = tmp_path / "own.py"
    path.write_text(content, encoding="utf-8")
    return str(path)


def test_the_team_and_the_team_with_another_grounding_are_configurations_of_it_and_no_rival_is() -> None:
    for name in registry.METHODS:
        mode = registry.team_mode(name)
        assert (mode is not None) == (name.partition(":")[0] == "team" or name.endswith("-grounding"))
        if mode is None:
            continue
        assert mode.ablation in ABLATIONS
        assert wt.Team(method=name).name == name
    assert {row.team.ablation for row in registry.METHODS.values() if row.team is not None} == set(ABLATIONS)


@pytest.mark.parametrize(
    ("name", "off"),
    [
        ("team:-verification-mover", {"verification", "mover"}),
        ("team:paper:-memory", {"memory"}),
        ("team:-manager", {"manager", "checker", "mover"}),
        ("single-call-grounding:-verification", {"verification", "manager", "checker", "mover"}),
    ],
)
def test_any_members_can_be_left_out_by_name(name: str, off: set[str]) -> None:
    made = wt.Team(method=name)
    members = made.policy().config.members  # type: ignore[attr-defined]
    assert {field for field, there in vars(members).items() if not there} == off
    assert made.policy().name == name
    row = registry.method_row(name)
    assert row is not None
    assert row.words.startswith(name.partition(":-")[0])


@pytest.mark.parametrize(
    "name",
    ["team:-checker-verification", "team:-mover-mover", "team:-critic", "team:-", "team:s1:-memory", "direct:-memory"],
)
def test_a_combination_has_one_name_and_its_members_are_there(name: str) -> None:
    with pytest.raises(UnknownNameError):
        wt.Team(method=name)


def test_the_planner_carries_the_name_it_was_asked_for_by() -> None:
    for name in ("team", "team:paper", "team:s3", "team:paper:s3"):
        assert wt.Team(method=name).policy().name == name


def test_models_by_role_share_the_default() -> None:
    echo = Echo()
    made = registry.make_models({"*": "offline", "checker": echo}, ("supervisor", "checker"))
    assert made["checker"] is echo
    assert made["supervisor"] is not echo
    with pytest.raises(ConfigError, match="no model for: supervisor"):
        registry.make_models({"checker": echo}, ("supervisor", "checker"))
    with pytest.raises(ConfigError, match="needs a method answer"):
        registry.make_model(3)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("openai:x", "OPENAI_API_KEY"),
        ("anthropic:x", "ANTHROPIC_API_KEY"),
        ("google:x", "GOOGLE_API_KEY"),
        ("openrouter:x/y", "OPENROUTER_API_KEY"),
    ],
)
def test_a_vendor_without_its_key_names_the_variable(name: str, key: str) -> None:
    with pytest.raises(ConfigError, match=key):
        registry.make_model(name)


def test_a_file_that_fails_says_how(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="ZeroDivisionError: division by zero"):
        registry.make_model(file(tmp_path, "1 / 0\n") + ":M")


def test_a_file_without_the_name_lists_what_it_has(tmp_path: Path) -> None:
    name = file(tmp_path, "class Mine:\n    def answer(self, request): ...\n")
    with pytest.raises(UnknownNameError, match="Did you mean 'Mine'"):
        registry.make_model(name + ":Mina")
    with pytest.raises(ConfigError, match=r"own\.py:Mine"):
        registry.make_model(name)


def test_a_constructor_that_asks_for_what_nobody_offers(tmp_path: Path) -> None:
    name = file(
        tmp_path, "class Mine:\n    name = 'm'\n    def __init__(self, engine): ...\n    def decide(self, s): ...\n"
    )
    with pytest.raises(ConfigError, match="parameter 'engine'; it may ask for: client"):
        wt.Method(method=name + ":Mine").policy()


def test_a_method_from_a_file_asks_through_a_capped_door(tmp_path: Path) -> None:
    name = file(
        tmp_path,
        "class Mine:\n    name = 'm'\n    def __init__(self, client): self.client = client\n    def decide(self, s): ...\n",
    )
    policy = wt.Method(method=name + ":Mine", max_calls=7).policy()
    assert policy.client.budget.caps.calls == 7  # type: ignore[attr-defined]
    with pytest.raises(ConfigError, match="is not the team"):
        wt.Team(method=name + ":Mine")


def test_an_object_that_is_no_world_says_what_it_lacks() -> None:
    with pytest.raises(ConfigError, match="lacks vocabulary, limits, observe, execute"):
        wt.make_world(Echo())


def test_the_truth_is_handed_out_for_the_worlds_own_instruction_only() -> None:
    world = wt.make_world("tabletop/rotate", seed=1)
    assert offers(privileged(world), Privileged)
    world.close()
    other = wt.make_world("tabletop/rotate", seed=1, instruction="put the largest thing on the left")
    assert privileged(other) is None
    assert other.instruction.slots == {}
    other.close()


def test_a_world_without_an_instruction_asks_for_one() -> None:
    class Bare:
        vocabulary, limits = wt.PICK_PLACE, wt.Limits((0, 0, 0), (1, 1, 1))

        def observe(self) -> None: ...

        def execute(self, action: object) -> None: ...

    with pytest.raises(ConfigError, match="brings no instruction"):
        wt.make_world(Bare())
    assert wt.make_world(Bare(), instruction="tidy up").instruction.text == "tidy up"


def test_keep_out_regions_are_added_to_a_worlds_own_limits_and_keep_its_scorer():
    from wonderful_team.core.geometry import Box
    from wonderful_team.core.values import KeepOut

    region = KeepOut("fixture", Box(0.3, -0.2, 0.4, 0.1), "m")
    world = registry.make_world("tabletop/rotate", seed=3, keep_out=[region])
    assert world.limits.keep_out == (region,)
    assert world.privileged is not None
    assert world.horizon == registry.make_world("tabletop/rotate", seed=3).horizon
    world.close()
