"""7: the tool's way: fingers to scale at every grasp, heights over what is seen, planned and measured path in space.

All numbers are the record's: those of the gate's profiles, of the plan's actions and of the robot's reports.
"""

from __future__ import annotations

from typing import Any

from wonderful_team.core.text import counted
from wonderful_team.pages.fingers import grasps
from wonderful_team.pages.height_profile import profile_drawing
from wonderful_team.pages.legs import Leg, camera_of, executions_of, leg_of, millimetres, touches
from wonderful_team.pages.look_up import chapters, main_key, scene_of
from wonderful_team.pages.pictures import Album
from wonderful_team.pages.space import picture_drawing, space_drawing


def motions(record: dict[str, Any], album: Album) -> list[dict[str, Any]]:
    """For every plan that went through the gate: drawings of its motion, and what is missing for them."""
    found = []
    for number, name, content in chapters(record):
        gates = [gate for gate in record["planner"]["gates"] if gate["plan"] == number]
        # A plan in pixels has no way in metres, and the page warns of that already.
        if gates and any(planned["action"] is not None for planned in content["actions"]):
            found.append({"name": name, **_motion(record, album, number, content, gates)})
    return found


def _motion(
    record: dict[str, Any], album: Album, number: int, content: dict[str, Any], gates: list[dict[str, Any]]
) -> dict[str, Any]:
    executed = executions_of(record, number)
    profiles: list[dict[str, Any]] = next((gate["profiles"] for gate in reversed(gates) if gate.get("profiles")), [])
    legs = [leg_of(profile, executed) for profile in profiles]
    scene = scene_of(record, content)
    camera = camera_of(scene)
    shown: dict[str, Any] = {"profile": None, "space": None, "picture": None, "deviation": "", "smallest": ""}
    missing = _missing(legs, camera is not None)
    if legs:
        if any(value is not None for leg in legs for value in leg.profile["surface_m"]):
            shown["profile"] = profile_drawing(legs)
            shown["smallest"] = _smallest(legs)
        else:
            missing.append("No height profile: depth shows no surface under the way.")
        limits = record["planner"].get("limits")
        shown["space"] = space_drawing(legs, limits, camera)
        if camera is not None and scene is not None:
            shown["picture"] = picture_drawing(album, main_key(scene), legs, camera)
        shown["deviation"] = _deviation(legs)
        if executed and not any(len(leg.measured_m) for leg in legs):
            missing.append("No measured path: this robot does not report where its tool was (`tool_m`, `path_m`).")
    fingers, lacking = grasps(record, album, content, executed)
    return {**shown, "fingers": fingers, "missing": [*missing, *lacking]}


def _missing(legs: list[Leg], camera: bool) -> list[str]:
    if legs:
        return [] if camera else ["No path over the picture: no camera was given."]
    return [
        "No path and no heights: the record holds none of the gate's for this plan; those of earlier releases have none."
    ]


def _deviation(legs: list[Leg]) -> str:
    known = [(leg.off_m, leg.number, len(leg.measured_m)) for leg in legs if leg.off_m is not None]
    if not known:
        return ""
    worst, number, _ = max(known)
    positions = counted(sum(count for _, _, count in known), "measured position")
    return f"Largest deviation from the plan: {1000 * worst:.1f} mm, in action {number} ({positions})."


def _smallest(legs: list[Leg]) -> str:
    """The smallest clearance, and where something touches as the gate allows it to: it is lifted off, put down, or led along."""
    known = [(leg.profile["clearance_m"], leg) for leg in legs if leg.profile.get("clearance_m") is not None]
    if not known:
        return "Nothing is seen that the tool would have to clear."
    apart = [(clearance, leg) for clearance, leg in known if not touches(leg.profile)]
    words = []
    if apart:
        clearance, leg = min(apart, key=lambda one: one[0])
        least = millimetres(leg.profile["least_m"])
        words.append(
            f"Smallest clearance: {millimetres(clearance)}, in action {leg.number} (the gate wants at least {least})."
        )
    near = [f"action {leg.number} ({millimetres(clearance)})" for clearance, leg in known if touches(leg.profile)]
    if near:
        words.append(f"Lifted off, put down or led along what is seen, as the gate allows: {', '.join(near)}.")
    return " ".join(words)
