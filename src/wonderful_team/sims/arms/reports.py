"""What a robot that grips reports of an action, whichever simulator ran it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from wonderful_team.core.actions import Action, Gripper
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import StepReport

LEANS_RAD = 0.01
AWAY_M = 0.012
"""A motion that ends farther than this from its goal did not do what was asked [m]."""
HELD_AWAY_M = 0.03
"""What is held may come to lie on another thing so much before its goal; farther, it was stopped on its way there [m]."""
REASONS = {
    "reach": "out of the arm's reach",
    "collision": "stopped: something pressed on the arm",
    "contact": "stopped: the tool touched something on its way down",
    "stop": "the world was stopped",
    "wrist": "the wrist does not turn so far from how it stands: let go, turn back, and take hold again",
}
EMPTY = "the fingers have closed on nothing"
LOST = "the fingers hold nothing any more: what they held slipped or was knocked out"


@dataclass(frozen=True)
class Moved:
    """How a motion ended.

    Attributes:
        error_m, error_rad: How far the tool is from its goal.
        force_n: Largest force that pressed on the tool, or on what it holds.
        stopped_by: "" when it came to its end, else contact, collision, stop, reach or wrist.
    """

    error_m: float
    error_rad: float
    force_n: float
    stopped_by: str = ""


class Ended(Protocol):
    """How a motion ended: how far from its goal, the largest force on the way, and what stopped it (a key of REASONS, or "")."""

    @property
    def error_m(self) -> float: ...
    @property
    def force_n(self) -> float: ...
    @property
    def stopped_by(self) -> str: ...


def measured(tool_m: Array, opening_m: float, holding: bool, moved: Ended | None) -> dict[str, Any]:
    """Where the tool is, what the fingers do, and what the motion measured; shape of `tool_m` (3,) [m]."""
    found: dict[str, Any] = {
        "tool_m": tuple(round(float(v), 4) for v in tool_m),
        "opening_m": round(opening_m, 4),
        "holding": holding,
        "held_width_m": round(opening_m, 4) if holding else None,
    }
    if moved is not None:
        found |= {
            "pose_error_m": round(moved.error_m, 4),
            "force_n": round(moved.force_n, 1),
            "contact": moved.stopped_by == "contact" or moved.force_n > 0.5,
        }
        found |= {"stopped_by": moved.stopped_by} if moved.stopped_by else {}
    return found


def report(
    action: Action, fault: str, moved: Ended | None, found: dict[str, Any], *, held: bool, holding: bool
) -> StepReport:
    """Whether an action did what was asked.

    Args:
        action: What ran.
        fault: Why nothing moved.
        moved: How the motion ended; None when nothing moved.
        found: What was measured.
        held: Whether the fingers held something before.
        holding: Whether they do now.
    """
    lost = _lost(action, held, holding)
    if lost:
        return StepReport(action, False, found, lost)
    if moved is None:
        return StepReport(action, False, found, fault)
    landed = moved.stopped_by == "contact" and holding
    limit_m = HELD_AWAY_M if landed else AWAY_M
    away, millimetres = moved.error_m > limit_m, f"{1000 * moved.error_m:.0f} mm"
    if moved.stopped_by == "contact":
        said = f"{REASONS['contact']}, {millimetres} before its goal (limit {1000 * limit_m:.0f} mm)"
        return StepReport(action, not away, found, said if moved.error_m > AWAY_M else None)
    if moved.stopped_by:
        return StepReport(action, False, found, REASONS[moved.stopped_by])
    if away and not isinstance(action, Gripper):
        return StepReport(action, False, found, f"ended {millimetres} from its goal (limit {1000 * AWAY_M:.0f} mm)")
    return StepReport(action, True, found)


def _lost(action: Action, held: bool, holding: bool) -> str:
    """What is wrong with what the fingers hold; "" when nothing is."""
    if isinstance(action, Gripper):
        return EMPTY if action.state != "open" and not holding else ""
    return LOST if held and not holding else ""


def out_of_reach(points_m: Array, low_m: tuple[float, float, float], high_m: tuple[float, float, float]) -> str:
    """Why points of shape (N, 3) cannot be reached [m]; "" when all can."""
    for point in points_m:
        for axis, value in enumerate(float(v) for v in point):
            low, high = low_m[axis], high_m[axis]
            if not low - 1e-6 <= value <= high + 1e-6:
                return f"{'xyz'[axis]} = {value:.3f} m is out of reach [{low}, {high}] m"
    return ""
