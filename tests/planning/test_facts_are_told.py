"""What is known of the robot, and where nothing may enter, reaches every member that plans by it."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import Any

import numpy as np

import wonderful_team as wt
from tests.planning.helpers import asked, plan_with, scripted
from tests.planning.rounds import photo
from tests.planning.stub_model import stub_script
from tests.runtime.runtime_fakes import SquaresWorld
from wonderful_team.api.photos import unknown_robot
from wonderful_team.core.actions import PICK_PLACE, VOCABULARIES
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import RegionMark
from wonderful_team.core.protocols import Situation, World, facts_of, offers
from wonderful_team.core.values import Instruction, KeepOut, Request, Words
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.runtime import rollout
from wonderful_team.sims.tabletop import make_world

FACTS = "Tool: a hook.\n\nNorth is the left edge."
TOLD = "What is known of the robot and its place:\n- Tool: a hook.\n- North is the left edge."


def text(request: Request) -> str:
    return "\n".join(part.text for part in request.parts if isinstance(part, Words))


def test_supervisor_and_verification_are_told_the_facts_in_every_question_of_the_task() -> None:
    for mode in ("lean", "paper"):
        model = scripted()
        plan_with(model, TeamConfig(mode=mode), facts=FACTS)  # type: ignore[arg-type]
        for contract in ("DraftPlan", "ReviewPlan", "WriteSteps", "ReviewSteps"):
            assert all(TOLD in text(request) for request in asked(model, contract)), contract


def test_a_world_may_leave_its_facts_out() -> None:
    world = SquaresWorld()
    assert not hasattr(world, "facts")
    assert offers(world, World)
    assert facts_of(world) == ""


@dataclass
class _Keeps:
    """A method that keeps what it is told and gives up."""

    name: str = "keeps"
    told: tuple[Situation, ...] = ()

    def decide(self, situation: Situation) -> Any:
        self.told = (*self.told, situation)
        return wt.GaveUp("enough", "plan")


def test_a_method_is_told_what_the_world_says() -> None:
    class Hooked(SquaresWorld):
        facts = FACTS

    method = _Keeps()
    rollout(method, Hooked())
    assert [situation.facts for situation in method.told] == [FACTS]


def test_the_tabletop_says_its_tool_width_views_north_and_turns() -> None:
    sweeping, picking = (make_world(task, 1) for task in ("sweep_without_touching", "rotate"))
    try:
        assert sweeping.limits.blade_m == 0.04
        assert "4 cm wide" in sweeping.facts
        assert "Nothing is lifted" in sweeping.facts
        assert picking.limits.blade_m is None
        assert "suction cup" in picking.facts
        assert "carried over all others" in picking.facts
        for world in (sweeping, picking):
            for said in (
                "Reach:",
                "North is the upper edge",
                "without a direction is clockwise",
                "top camera looks straight",
            ):
                assert said in world.facts
    finally:
        sweeping.close()
        picking.close()


def test_a_photo_says_that_the_robot_is_not_known() -> None:
    assert "Nothing is known of the robot's tool" in unknown_robot(PICK_PLACE)
    assert "carried over all others" in unknown_robot(PICK_PLACE)
    assert "how wide the tool is, is not known" in unknown_robot(VOCABULARIES["push"])


def test_regions_that_nothing_may_enter_are_drawn_and_named_for_all_who_plan_or_place() -> None:
    for mode, contracts in {
        "lean": ("DraftPlan", "ReviewPlan", "ReadScene", "WriteSteps", "ReviewSteps"),
        "paper": ("DraftPlan", "ReviewPlan", "LocatePoints", "GiveBox", "ReviewSteps"),
    }.items():
        model = scripted()
        plan_with(model, TeamConfig(mode=mode), keep_out=(KeepOut("cup", Box(5, 5, 25, 20)),))  # type: ignore[arg-type]
        for contract in contracts:
            for request in asked(model, contract):
                drawn = [mark for shown in request.pictures for mark in shown.marks if isinstance(mark, RegionMark)]
                assert any(mark.label == "cup" for mark in drawn), contract
                assert "a region that nothing may enter labelled cup" in text(request), contract


def test_a_push_that_was_made_is_not_announced_as_a_mistake() -> None:
    model = scripted()
    team = TeamPolicy(model, TeamConfig())
    done = ("[G1] push from T1 to T2 (for 'push the first thing into the second thing')",)
    asyncio.run(
        team.make_plan(photo(), Instruction("put the first thing into the second thing"), PICK_PLACE, done=done)
    )
    # Who checks a plan has to know what was done too: with nothing left to do, an empty plan is right.
    for contract in ("DraftPlan", "ReviewSteps"):
        (request,) = asked(model, contract)
        assert "Already carried out, as planned; the views are newer." in text(request)
        assert done[0] in text(request)
        assert "went wrong" not in text(request)


def test_verification_knows_what_went_wrong_before() -> None:
    model = scripted()
    plan_with(model, advice=("the lid was closed",))
    assert all("What went wrong before this plan: the lid was closed" in text(r) for r in asked(model, "ReviewPlan"))
    assert asked(model, "ReviewPlan")


def test_the_scale_of_the_main_view_is_told_where_a_camera_says_it() -> None:
    model, world = scripted(), make_world("rotate", seed=3)
    team = TeamPolicy(model, TeamConfig())
    asyncio.run(team.make_plan(world.observe(), world.instruction, PICK_PLACE, world.limits))
    (request,) = asked(model, "DraftPlan")
    camera, (width, height) = world.observe().main.camera, world.observe().main.size_px
    left, right = camera.on_plane(np.array([[0, height / 2], [width, height / 2]]), 0.0)
    span_cm = 100 * float(np.linalg.norm(right - left))
    assert f"the main view shows {span_cm:.3g} cm of the table" in text(request)
    photographed = scripted()
    plan_with(photographed)
    assert "Scale:" not in text(asked(photographed, "DraftPlan")[0])


def test_without_a_grounding_team_an_area_is_asked_for_as_a_place() -> None:
    def drafted(request: Request) -> Any:
        draft = stub_script()["DraftPlan"](request)
        return {**draft, "targets": [draft["targets"][0], {**draft["targets"][1], "kind": "area"}]}

    model = scripted(DraftPlan=drafted)
    plan_with(model, TeamConfig(ablation="s7"))
    wanted = {request.question.target.id: request.question.purpose for request in asked(model, "LocatePoints")}
    assert wanted == {"T1": "centre", "T2": "place"}
