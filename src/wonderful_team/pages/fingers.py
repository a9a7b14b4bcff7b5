"""The two fingers to scale where they close on a thing: as planned, and as they came to hold it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from wonderful_team.core.geometry import Camera, Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.pages.figures import crop_drawing, window_round
from wonderful_team.pages.legs import camera_of, positions
from wonderful_team.pages.look_up import main_key, scene_of
from wonderful_team.pages.pictures import Album


@dataclass(frozen=True, eq=False)
class _Grasp:
    """Fingers that close.

    Attributes:
        index: Of the action that closes them, from 0.
        centre_m: Middle between the fingertips as planned, shape (3,) [m].
        yaw_rad: Heading of the gripper; the fingers close across it.
        open_m: How far they are open before; None when nobody says.
        how: Where the numbers come from, in the plan's words.
    """

    index: int
    centre_m: Array
    yaw_rad: float
    open_m: float | None
    how: str


def grasps(
    record: dict[str, Any], album: Album, content: dict[str, Any], executed: Sequence[dict[str, Any]]
) -> tuple[list[dict[str, Any]], list[str]]:
    """One drawing for every grasp of a plan, and what is missing for them; none for tools without fingers."""
    fingers = (record["planner"].get("limits") or {}).get("fingers")
    if fingers is None:
        return [], []
    found, missing = [], []
    for grasp in _planned(content, fingers, _start(record)):
        scene = _scene_at(record, content, grasp.index)
        camera = camera_of(scene)
        number = grasp.index + 1
        if camera is None or grasp.open_m is None:
            lacks = "no camera was given" if camera is None else "nothing says how far the fingers are open before it"
            missing.append(f"No fingers at action {number}: {lacks}.")
            continue
        measured = executed[grasp.index]["measured"] if grasp.index < len(executed) else None
        try:
            drawing = _drawing(album, scene, camera, grasp, fingers, measured)
        except ValueError:
            missing.append(f"No fingers at action {number}: the camera does not see where they close.")
            continue
        found.append(
            {"number": number, "drawing": drawing, "facts": _facts(grasp, fingers, measured), "how": grasp.how}
        )
    return found, missing


def _start(record: dict[str, Any]) -> float | None:
    """How far the gripper is open at the start, as a share; None when the robot did not say."""
    observations = record["planner"]["observations"]
    robot = observations[0].get("robot") if observations else None
    share = None if robot is None else robot.get("gripper")
    return float(share) if isinstance(share, int | float) else None


def _planned(content: dict[str, Any], fingers: Mapping[str, Any], start: float | None) -> list[_Grasp]:
    """Every closing of the fingers in a plan, with where the tool stands and how it is turned by then."""
    found: list[_Grasp] = []
    open_m = None if start is None else start * fingers["opening_m"]
    at: Array | None = None
    yaw, how = 0.0, ""
    for index, planned in enumerate(content["actions"]):
        action = planned["action"] or {}
        match action.get("type"):
            case "MoveTo":
                pose = action["pose"]
                at, how = np.array(pose["position_m"]), next((one["how"] for one in planned["sources"]), "")
                yaw = Pose(at, np.array(pose["quaternion_wxyz"])).yaw_rad
            case "RotateGripper":
                yaw += action["yaw_rad"]
                # What the move said of the turn holds no longer.
                how = f"{how}; then turned {turned(action['yaw_rad'])}" if how else ""
            case "Trajectory":
                at, how = np.array(action["waypoints_m"][-1]), ""
            case "Home":
                at = None
            case "Gripper" if action["state"] == "open":
                open_m = fingers["opening_m"]
            case "Gripper":
                if at is not None:
                    found.append(_Grasp(index, at, math.remainder(yaw, 2 * math.pi), open_m, how))
                open_m = None
    return found


def _scene_at(record: dict[str, Any], content: dict[str, Any], index: int) -> dict[str, Any] | None:
    """The last observation before the subgoal of an action ran, else that which the plan was made from."""
    planner, ends = record["planner"], 0
    for run in planner["subgoals"]:
        if run["plan"] is None or planner["plans"][run["plan"]]["id"] != content["id"]:
            continue
        ends += run["actions"]
        if index < ends:
            for observation in planner["observations"]:
                if observation["views"] == run["before"]:
                    return dict(observation)
    return scene_of(record, content)


def pads_m(centre_m: Array, yaw_rad: float, opening_m: float, fingers: Mapping[str, Any]) -> list[Array]:
    """Corners of the two fingers seen from above, shape (4, 3) each [m]."""
    along = np.array([math.cos(yaw_rad), math.sin(yaw_rad), 0.0])
    across = np.array([math.sin(yaw_rad), -math.cos(yaw_rad), 0.0])
    breadth, thickness = along * fingers["breadth_m"] / 2, across * fingers["thickness_m"] / 2
    pads = []
    for side in (1.0, -1.0):
        middle = centre_m + side * across * (opening_m + fingers["thickness_m"]) / 2
        pads.append(np.array([middle + a * breadth + b * thickness for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]))
    return pads


def _drawing(
    album: Album,
    scene: dict[str, Any] | None,
    camera: Camera,
    grasp: _Grasp,
    fingers: Mapping[str, Any],
    measured: Mapping[str, Any] | None,
) -> Markup:
    assert scene is not None
    assert grasp.open_m is not None
    planned = [camera.project(pad) for pad in pads_m(grasp.centre_m, grasp.yaw_rad, grasp.open_m, fingers)]
    layers = [_pad(pad, "planned", "a finger, open, as planned") for pad in planned]
    held = held_width_m(measured)
    if held is not None and measured is not None:
        centre, yaw = _measured_pose(grasp, measured)
        layers += [
            _pad(camera.project(pad), "measured", "a finger that holds, as measured")
            for pad in pads_m(centre, yaw, held, fingers)
        ]
    corners = np.vstack(planned)
    (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
    box = {"x0": float(x0), "y0": float(y0), "x1": float(x1), "y1": float(y1)}
    window = window_round([box], [], scene["size_px"])
    alt = f"the fingers at action {grasp.index + 1}, to scale"
    return crop_drawing(album, main_key(scene), window, alt, layers)


def _measured_pose(grasp: _Grasp, measured: Mapping[str, Any]) -> tuple[Array, float]:
    """Where the fingers came to hold, as far as the robot says so."""
    tool, yaw = positions([measured.get("tool_m")]), measured.get("yaw_rad")
    return tool[0] if len(tool) else grasp.centre_m, float(yaw) if isinstance(yaw, int | float) else grasp.yaw_rad


def held_width_m(measured: Mapping[str, Any] | None) -> float | None:
    """The width that a robot says it holds; None when it holds nothing or does not say [m]."""
    width = None if measured is None else measured.get("held_width_m")
    return float(width) if isinstance(width, int | float) and not isinstance(width, bool) else None


def _pad(corners: Array, css: str, title: str) -> Markup:
    points = " ".join(f"{x:.2f},{y:.2f}" for x, y in corners)
    return Markup(
        '<polygon points="{0}" class="pad-rim"/><polygon points="{0}" class="pad {1}"><title>{2}</title></polygon>'
    ).format(points, css, title)


def _facts(grasp: _Grasp, fingers: Mapping[str, Any], measured: Mapping[str, Any] | None) -> list[tuple[str, str]]:
    """Numbers beside the drawing."""
    assert grasp.open_m is not None
    pads = f"{1000 * fingers['thickness_m']:.0f} by {1000 * fingers['breadth_m']:.0f} mm"
    facts = [
        ("opening, planned", f"{1000 * grasp.open_m:.0f} mm"),
        ("yaw, planned", turned(grasp.yaw_rad)),
        ("each finger", pads),
    ]
    held = held_width_m(measured)
    if measured is None:
        return [*facts, ("held, measured", "not run")]
    if held is None:
        opening = measured.get("opening_m")
        apart = f", fingers {1000 * opening:.1f} mm apart" if isinstance(opening, float) else ""
        said = "nothing" + apart if measured.get("holding") is False else "not reported"
        return [*facts, ("held, measured", said)]
    yaw = measured.get("yaw_rad")
    return [
        *facts,
        ("held, measured", f"{1000 * held:.1f} mm"),
        *([("yaw, measured", turned(float(yaw)))] if isinstance(yaw, int | float) else []),
    ]


def turned(yaw_rad: float) -> str:
    """A heading in degrees, seen from above."""
    degrees = math.degrees(yaw_rad)
    return f"{abs(degrees):.1f}° {'clockwise' if degrees <= 0 else 'anticlockwise'}"
