"""A plan drawn over the picture that it was made from."""

from __future__ import annotations

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.text import picture_names
from wonderful_team.core.values import Limits, Plan, View
from wonderful_team.images import action_arrows, action_turns, overview, swept_widths


def plan_picture(plan: Plan, view: View, limits: Limits | None) -> Array:
    """The view with the plan's targets, actions and regions, shape (H, W, 3), uint8."""
    said = plan.instruction
    return overview(
        view,
        plan.grounded,
        names=picture_names(said.text, said.slots),
        arrows=action_arrows(plan.actions),
        turns=action_turns(plan.actions, plan.grounded, view),
        widths=swept_widths(plan.actions, limits.blade_m if limits else None, view.camera),
        keep_out=plan.keep_out,
        workspace=limits,
    )
