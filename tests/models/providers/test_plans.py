"""Whole plans through every wire format and family of models, with the real offline model behind the server."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from tests.servers.brains import AgentSession, Tapped, offline_brain
from tests.servers.server import Rules, WireServer
from tests.servers.wiring import OTHER_FAMILIES, WIRES, Wire
from wonderful_team.core.values import Plan
from wonderful_team.offline import OfflineModel
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.sims.tabletop import make_world

COARSEST_PX = 0.6
"""Half of a thousandth of the picture's longest side, and half a pixel: what whole numbers lose."""


@pytest.fixture(scope="module")
def scene() -> Any:
    """What `make_plan` takes: observation, instruction, vocabulary, limits."""
    world = make_world("visual_manipulation", seed=3)
    asked = world.observe(), world.instruction, world.vocabulary, world.limits
    world.close()
    return asked


def planned(model: Any, scene: Any, thorough: bool = False) -> Plan:
    async def plan() -> Plan:
        return await TeamPolicy(model, TeamConfig(thorough=thorough)).make_plan(*scene)

    return asyncio.run(plan())


@pytest.fixture(scope="module")
def right(scene: Any) -> Plan:
    """What the offline model plans without any wire."""
    return planned(OfflineModel(), scene)


def planned_over(
    wire: Wire, rules: Rules, scene: Any, fault: str = "", thorough: bool = False, **options: Any
) -> tuple[Plan, WireServer]:
    desk = AgentSession()
    with WireServer(offline_brain(desk, wire.speech), rules) as server:
        if fault:
            server.always(fault)
        model = Tapped(wire.provider(server, deadline_s=30.0, **options), desk)
        return planned(model, scene, thorough), server


def assert_same(plan: Plan, right: Plan, tolerance_px: float = COARSEST_PX) -> None:
    assert plan.status == right.status == "planned"
    assert plan.steps == right.steps
    assert plan.subgoals == right.subgoals
    assert set(plan.grounded) == set(right.grounded)
    for name, target in right.grounded.items():
        for role, point in target.points.items():
            assert plan.grounded[name].points[role] == pytest.approx(point, abs=tolerance_px)


@pytest.mark.parametrize("name", [*WIRES, *OTHER_FAMILIES])
def test_the_plan_is_the_offline_models_own(name: str, scene: Any, right: Plan) -> None:
    wire = {**WIRES, **OTHER_FAMILIES}[name]
    plan, server = planned_over(wire, Rules(local=not wire.vendor), scene)
    assert_same(plan, right)
    assert [seen.problem for seen in server.log if seen.problem] == []


@pytest.mark.parametrize("name", ["server", "openai-chat", "google"])
def test_a_server_that_takes_one_picture_gets_one(name: str, scene: Any, right: Plan) -> None:
    """The first request is refused, its pictures are then pasted on one sheet, and so are all later ones."""
    wire = WIRES[name]
    plan, server = planned_over(wire, Rules(local=not wire.vendor, max_pictures=1), scene)
    assert_same(plan, right, tolerance_px=2.0)
    refused = [seen for seen in server.log if seen.status == 400]
    assert len(refused) <= 3
    assert all(len(heard.pictures) <= 1 for heard in (s.heard for s in server.log if s.status == 200) if heard)


@pytest.mark.parametrize(
    "rules",
    [
        Rules(local=True, schemas="ignored"),
        Rules(local=True, schemas="refused"),
        Rules(local=True, thinks="inline"),
        Rules(local=True, thinks="field"),
        Rules(local=True, key=None),
    ],
    ids=["schemas ignored", "schemas refused", "thinks aloud", "thinks in a field", "no key asked"],
)
def test_odd_servers_are_understood(rules: Rules, scene: Any, right: Plan) -> None:
    plan, _ = planned_over(WIRES["server"], rules, scene)
    assert_same(plan, right)


def test_thinking_can_be_switched_off(scene: Any, right: Plan) -> None:
    plan, server = planned_over(WIRES["server"], Rules(local=True, thinks="switch"), scene, thinking="off")
    assert_same(plan, right)
    assert all(heard.body["chat_template_kwargs"] == {"enable_thinking": False} for heard in server.heard)


def test_system_words_come_first_and_are_the_same_for_all_requests_of_a_role_that_begin_alike(scene: Any) -> None:
    """Stable prefixes are what services give a discount for."""
    _, server = planned_over(WIRES["openai-chat"], Rules(), scene, thorough=True)
    systems = [heard.system for heard in server.heard]
    assert all(heard.body["messages"][0]["role"] in ("system", "developer") for heard in server.heard)
    assert 1 < len(set(systems)) <= 7
    assert len(systems) > len(set(systems))
    # One text for each role and what it is shown first, whatever it is asked.
    begun = {(heard.system[:30], heard.pictures[0].tobytes()) for heard in server.heard}
    assert len({(heard.system, heard.pictures[0].tobytes()) for heard in server.heard}) == len(begun)
