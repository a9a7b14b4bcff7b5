"""Steps in words: what a kind of step does, and one step in one line."""

from __future__ import annotations

from wonderful_team.core.actions import (
    At,
    Beside,
    CloseStep,
    FollowStep,
    HomeStep,
    MoveStep,
    NavigateStep,
    OpenStep,
    OriginOf,
    PickPlaceStep,
    Place,
    PushStep,
    RotateGripperStep,
    Step,
)

STEP_KINDS: dict[str, str] = {
    "pick_place": "pick one target up, carry it, and put it down at a place, turned by an angle if one is stated",
    "push": "push along the table from one place to another",
    "move": "move the tool above a place, down to it (at), or up until it is clear of everything",
    "open": "open the gripper",
    "close": "close the gripper; tight keeps squeezing",
    "rotate_gripper": "turn the gripper by an angle, clockwise seen from above",
    "follow": "move the tool along the path that a helper function computed",
    "home": "go to the home pose",
    "navigate": "drive the mobile base to a place",
}
"""Every kind of step that a planner may write, with what it does."""

_BESIDE = {"left": "to the left of", "right": "to the right of", "above": "above (in the picture)", "below": "below"}
_HEIGHTS = {"above": "just above", "at": "down to", "clear": "clear of everything over"}


def place_words(place: Place) -> str:
    """A place in words."""
    match place:
        case At():
            return place.target
        case Beside():
            return f"the spot {_BESIDE[place.side]} {place.target}"
        case OriginOf():
            return f"where {place.target} stood at the start"


def turn_words(rotate_deg: float) -> str:
    """A turn in words: degrees, clockwise or anticlockwise seen from above."""
    return f"{abs(rotate_deg):g} degrees {'clockwise' if rotate_deg >= 0 else 'anticlockwise'}"


def step_words(step: Step) -> str:
    """One step in one line, with the subgoal that it serves."""
    return f"[{step.subgoal}] {_what(step)}"


def _what(step: Step) -> str:
    match step:
        case PickPlaceStep():
            turned = f", turned {turn_words(step.rotate_deg)}" if step.rotate_deg else ""
            return f"pick {step.pick}, put it at {place_words(step.place)}{turned}"
        case PushStep():
            return f"push from {place_words(step.start)} to {place_words(step.end)}"
        case MoveStep():
            return f"move the tool {_HEIGHTS[step.height]} {place_words(step.to)}"
        case OpenStep():
            return "open the gripper"
        case CloseStep():
            return "close the gripper and keep squeezing" if step.tight else "close the gripper"
        case RotateGripperStep():
            return f"turn the gripper {turn_words(step.rotate_deg)}"
        case FollowStep():
            return f"follow the path of {step.function}"
        case HomeStep():
            return "go to the home pose"
        case NavigateStep():
            return f"drive to {place_words(step.to)}"
