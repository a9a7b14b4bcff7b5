"""Grounding alone: find described things in a picture with the grounding team, without a plan around them."""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.values import NO_WORKSPACE, GroundedTarget, Instruction, Observation, Plan, Target
from wonderful_team.errors import BudgetReached, ModelOutputError, NotUnderstoodError, WonderfulTeamError
from wonderful_team.models.door import Door
from wonderful_team.planning import TeamConfig, grounding
from wonderful_team.planning.desk import Desk, settle
from wonderful_team.planning.scene import SceneShown

STATUS: dict[type[WonderfulTeamError], str] = {NotUnderstoodError: "not_understood", BudgetReached: "budget"}


async def find(
    door: Door, config: TeamConfig, observation: Observation, instruction: Instruction, targets: Sequence[Target]
) -> Plan:
    """A plan that holds nothing but grounded targets; its status is grounded, not_found, not_understood or budget."""
    desk = Desk(door, config, instruction.text)
    jobs = grounding.make_jobs(desk, SceneShown(observation, instruction, PICK_PLACE, NO_WORKSPACE), targets, ())
    status, message, grounded = "grounded", "", {}
    try:
        if not desk.members.manager:
            grounded = await grounding.ground_by_supervisor(jobs)
        elif config.way == "lean":
            grounded = await grounding.settle_reading(jobs, *await grounding.read_scene(jobs))
        else:
            grounded = await grounding.ground_paper(jobs)
    except (NotUnderstoodError, BudgetReached, ModelOutputError) as error:
        status, message = STATUS.get(type(error), "failed"), str(error)
    finally:
        await settle(desk)
    absent = [item for item in grounded.values() if item.status != "found"]
    if absent:
        status, message = (
            "not_found",
            "; ".join(f"{item.target.id} {_says(item)}: {item.target.words}" for item in absent),
        )
    desk.stage("grounded", "   ".join(f"{key} {item.target.words} ({_says(item)})" for key, item in grounded.items()))
    plan = Plan(
        instruction, status, targets=tuple(targets), grounded=grounded, scene_hash=observation.hash, message=message
    )
    door.tell("plan", plan.id, plan)
    return plan


def _says(item: GroundedTarget) -> str:
    return {"found": "found", "absent": "not here", "gave_up": "gave up"}[item.status]
