"""Grounding alone: find described things in a picture with the grounding team, without a plan around them."""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team.agents.scene import SceneShown
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.protocols import Detector
from wonderful_team.core.values import NO_WORKSPACE, GroundedTarget, Instruction, Observation, Plan, Target
from wonderful_team.errors import BudgetReached, ModelOutputError, NotUnderstoodError, WonderfulTeamError
from wonderful_team.models.client import ModelClient
from wonderful_team.planning import TeamConfig, grounding
from wonderful_team.planning.session import AgentSession, needed_detector, settle

STATUS: dict[type[WonderfulTeamError], str] = {NotUnderstoodError: "not_understood", BudgetReached: "budget"}


async def find(
    client: ModelClient,
    config: TeamConfig,
    observation: Observation,
    instruction: Instruction,
    targets: Sequence[Target],
    detector: Detector | None = None,
) -> Plan:
    """A plan that holds nothing but grounded targets; its status is grounded, not_found, not_understood or budget."""
    session = AgentSession(client, config, instruction.text, detector=needed_detector(config, detector))
    jobs = grounding.make_jobs(session, SceneShown(observation, instruction, PICK_PLACE, NO_WORKSPACE), targets, ())
    status, message, grounded = "grounded", "", {}
    try:
        grounded = await grounding.ground(jobs)
    except (NotUnderstoodError, BudgetReached, ModelOutputError) as error:
        status, message = STATUS.get(type(error), "failed"), str(error)
    finally:
        await settle(session)
    absent = [item for item in grounded.values() if item.status != "found"]
    if absent:
        status, message = (
            "not_found",
            "; ".join(f"{item.target.id} {_says(item)}: {item.target.words}" for item in absent),
        )
    session.stage(
        "grounded", "   ".join(f"{key} {item.target.words} ({_says(item)})" for key, item in grounded.items())
    )
    session.tell_skipped()
    plan = Plan(
        instruction, status, targets=tuple(targets), grounded=grounded, scene_hash=observation.hash, message=message
    )
    client.tell("plan", plan.id, plan)
    return plan


def _says(item: GroundedTarget) -> str:
    return {"found": "found", "absent": "not here", "gave_up": "gave up"}[item.status]
