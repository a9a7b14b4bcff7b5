"""Running things: the safety gate and the rollout."""

from wonderful_team.runtime.approval import Approval, Approver, Declined, Proposal, actions_id
from wonderful_team.runtime.gate import check_gate
from wonderful_team.runtime.rollout import rollout

__all__ = ["Approval", "Approver", "Declined", "Proposal", "actions_id", "check_gate", "rollout"]
