"""Running things: the safety gate, the rollout, the recorder and the page of one run."""

from wonderful_team.runtime.approval import Approval, Approver, Declined, Proposal, actions_id
from wonderful_team.runtime.gate import check_gate
from wonderful_team.runtime.page import write_page
from wonderful_team.runtime.plan_file import plan_from_json, plan_to_json, read_plan, write_plan
from wonderful_team.runtime.plan_scene import read_plan_scene, read_run_plan
from wonderful_team.runtime.recorder import Recorder
from wonderful_team.runtime.rollout import rollout

__all__ = [
    "Approval",
    "Approver",
    "Declined",
    "Proposal",
    "Recorder",
    "actions_id",
    "check_gate",
    "plan_from_json",
    "plan_to_json",
    "read_plan",
    "read_plan_scene",
    "read_run_plan",
    "rollout",
    "write_page",
    "write_plan",
]
