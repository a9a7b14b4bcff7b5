"""`--rerun`: a run as a recording of Rerun (https://rerun.io): what was seen, planned and measured, on a timeline of steps.

The timeline `step` counts executed actions: what was seen and planned before the first stands at 0. Rerun is the optional part
`rerun`, and is imported here alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from wonderful_team.core.filesystem import write_private
from wonderful_team.core.geometry import PinholeCamera, PlanarCamera, Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import (
    GateReport,
    Instruction,
    Limits,
    Observation,
    Plan,
    PlannedAction,
    StepReport,
    Trial,
    Verdict,
    View,
)
from wonderful_team.errors import ConfigError, FileNotWrittenError, MissingExtraError
from wonderful_team.record.rerun_layout import layout, title
from wonderful_team.redaction import redact

RERUN_NAME = "recording.rrd"
"""What it is called in the run folder."""
TIMELINE = "step"
JPEG_QUALITY = 90
DEPTH_UNITS = ((10_000.0, 6.5), (1_000.0, 65.0))
"""Depth is kept in 16 bits: so many units of a metre as far as so many metres."""
MOST_SEEN = 20_000
"""Most points of one view in space."""
ROUND_M, SEEN_M, PLANE_M = 0.3, 0.002, 0.12
"""How far round the workspace what is seen is kept, how large a point of it is, and how far from a camera its picture stands [m]."""
BOUNDS = (140, 140, 140)
COLOURS = ((255, 210, 63), (86, 204, 242), (111, 207, 151), (242, 153, 74), (235, 130, 235), (235, 87, 87))
"""Of the targets' boxes, and of their words."""
PLANNED, MEASURED, LEAST = (47, 164, 224), (255, 106, 26), (179, 38, 30)
_PART = "--rerun"


def check_rerun(path: Path | None = None) -> None:
    """Whether a recording can be made, and where it is to go can be written to.

    Raises:
        MissingExtraError: The optional part is not installed; names the command.
        ConfigError: The file's ending is another one, or its folder is missing.
    """
    if path is not None and path.suffix.lower() != ".rrd":
        raise ConfigError(f"{_PART} {str(path)!r}: the file's ending must be .rrd (a recording of Rerun)")
    if path is not None and not path.resolve().parent.is_dir():
        raise ConfigError(f"{_PART} {str(path)!r}: there is no folder {str(path.resolve().parent)!r}")
    if find_spec("rerun") is None:
        raise MissingExtraError(_PART, "rerun")


class RerunRecording:
    """A subscriber that keeps a run for Rerun's viewer; in memory, until `write`.

    A defect here must not lose a run: the first error ends the recording, and `write` says so.
    """

    def __init__(self) -> None:
        check_rerun()
        import rerun as rr

        self._rr = rr
        self._stream = rr.RecordingStream("wonderful_team")
        # Clock times would make every recording another one.
        self._stream.set_log_time_enabled(False)
        self._stream.set_log_tick_enabled(False)
        self._bytes = self._stream.binary_stream()
        self._step = 0
        self._seen, self._main = "", ""
        self._views: dict[str, str] = {}
        self._numbers: set[str] = set()
        self._limits: Limits | None = None
        self._measured: list[Array] = []
        self._broken: Exception | None = None
        self._handlers: dict[str, Callable[[Event], None]] = {
            "run": self._on_run,
            "observe": self._on_observe,
            "stage": self._on_stage,
            "plan": self._on_plan,
            "gate": self._on_gate,
            "execute": self._on_execute,
            "verdicts": self._on_verdicts,
            "warning": self._on_warning,
            "done": self._on_done,
        }
        self._log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)

    def on_event(self, event: Event) -> None:
        """Keep one event. Kinds that are not known are left out."""
        handle = self._handlers.get(event.kind)
        if handle is None or self._broken is not None:
            return
        try:
            self._stream.set_time(TIMELINE, sequence=self._step)
            handle(event)
        except Exception as error:  # noqa: BLE001  told when the file is written; the run goes on
            self._broken = error

    def write(self, path: Path) -> None:
        """Write the recording, whole or not at all.

        Raises:
            FileNotWrittenError: The file cannot be written, or the recording broke off; what there is of it is then written.
        """
        if self._views:
            self._stream.send_blueprint(layout(self._views, self._main, self._numbers, self._limits))
        self._stream.flush()
        content = self._bytes.read(flush=True)
        self._stream.disconnect()
        write_private(path, content or b"")
        if self._broken is not None:
            error = self._broken
            raise FileNotWrittenError(path, f"the recording broke off: {type(error).__name__}: {redact(str(error))}")

    # -- what happens ------------------------------------------------------------------------------------------------

    def _on_run(self, event: Event) -> None:
        content = event.content if isinstance(event.content, Mapping) else {}
        task, limits = content.get("task"), content.get("limits")
        if isinstance(task, Instruction):
            self._log("instruction", self._rr.TextDocument(redact(task.plain_text)), static=True)
        if isinstance(limits, Limits) and max(map(abs, (*limits.low_m, *limits.high_m))) < 50:
            self._limits = limits
            low, high = np.array(limits.low_m), np.array(limits.high_m)
            box = self._rr.Boxes3D(
                mins=[low],
                sizes=[high - low],
                colors=[BOUNDS],
                fill_mode="MajorWireframe",
                labels=["workspace"],
                show_labels=False,
            )
            self._log("world/workspace", box, static=True)

    def _on_observe(self, event: Event) -> None:
        observation: Observation = event.content
        if observation.hash == self._seen:
            return
        self._seen = observation.hash
        self._main = self._main or observation.main.id
        for view in observation.views.values():
            self._keep_view(view)
        robot = observation.robot
        if robot is not None and robot.tool_m is not None:
            self._keep_tool(np.asarray(robot.tool_m, dtype=np.float64))

    def _on_stage(self, event: Event) -> None:
        content = event.content
        text = content.get("text", "") if isinstance(content, Mapping) else str(content or "")
        self._say("log/stages", f"{event.name}: {text}")

    def _on_plan(self, event: Event) -> None:
        plan: Plan = event.content
        for goal in plan.subgoals:
            self._say("log/subgoals", f"{goal.id}: {goal.text}")
        boxes = {name: item for name, item in plan.grounded.items() if item.box is not None}
        corners = [(item.box.x0, item.box.y0, item.box.width, item.box.height) for item in boxes.values() if item.box]
        labels = [redact(f"{name} {item.target.words}") for name, item in boxes.items()]
        image = self._image(self._main)
        colours = [COLOURS[k % len(COLOURS)] for k in range(len(boxes))]
        form = self._rr.Box2DFormat.XYWH
        self._log(f"{image}/targets", self._rr.Boxes2D(array=corners, array_format=form, labels=labels, colors=colours))
        points = [
            (f"{name} {role}", point) for name, item in plan.grounded.items() for role, point in item.points.items()
        ]
        # Where a point belongs its box says; its own words, in the same place, would hide both.
        where, names = [point for _, point in points], [name for name, _ in points]
        self._log(
            f"{image}/points",
            self._rr.Points2D(where, labels=names, show_labels=False, colors=[MEASURED], radii=3.0),
        )

    def _on_gate(self, event: Event) -> None:
        report: GateReport = event.content
        for reason in report.reasons:
            self._say("log/gate", f"{event.name}: refused: {reason}", "WARN")
        profiles = report.profiles
        if not profiles:
            return
        names = [f"action {profile.action + 1}" for profile in profiles]
        strips = [profile.points_m for profile in profiles]
        lines = self._rr.LineStrips3D(strips, labels=names, colors=[PLANNED], radii=0.002, show_labels=False)
        self._log("world/plan/path", lines)
        marks, said, least = [], list[str](), list[tuple[float, int]]()
        for profile in profiles:
            if profile.nearest is not None and profile.clearance_m is not None:
                above = np.array([*profile.points_m[profile.nearest][:2], profile.low_m[profile.nearest]])
                marks.append([above, above - (0.0, 0.0, profile.clearance_m)])
                least.append((profile.clearance_m, len(said)))
                said.append(f"{round(1000 * profile.clearance_m)} mm (action {profile.action + 1})")
        lines = self._rr.LineStrips3D(marks, labels=said, colors=[LEAST], radii=0.001, show_labels=False)
        self._log("world/plan/clearance", lines)
        if least:
            _, number = min(least)
            line = self._rr.LineStrips3D(
                [marks[number]], labels=[f"least clearance {said[number]}"], colors=[LEAST], radii=0.0015
            )
            self._log("world/plan/least_clearance", line)

    def _on_execute(self, event: Event) -> None:
        planned, report = event.content
        assert isinstance(planned, PlannedAction)
        assert isinstance(report, StepReport)
        self._step += 1
        self._stream.set_time(TIMELINE, sequence=self._step)
        self._say(
            "log/actions",
            f"{planned.step.subgoal}: {report.action.kind}: {report.words}",
            "" if report.executed else "WARN",
        )
        path = _positions(report.measured.get("path_m"))
        if path is not None:
            self._log("world/robot/path", self._rr.LineStrips3D([path], colors=[MEASURED], radii=0.0015))
        tool = _positions([report.measured.get("tool_m")])
        if tool is not None:
            yaw = report.measured.get("yaw_rad")
            self._keep_tool(tool[0], float(yaw) if isinstance(yaw, int | float) else None)
        for name, value in report.measured.items():
            if isinstance(value, int | float) and math.isfinite(value):
                if name not in self._numbers:
                    self._numbers.add(name)
                    self._log(f"robot/{name}", self._rr.SeriesLines(names=title(name)), static=True)
                self._log(f"robot/{name}", self._rr.Scalars(float(value)))

    def _on_verdicts(self, event: Event) -> None:
        for verdict in event.content:
            assert isinstance(verdict, Verdict)
            words = f"{verdict.subgoal} {verdict.status.replace('_', ' ')}"
            self._say("log/subgoals", f"{words}: {verdict.cause}" if verdict.cause else words)

    def _on_warning(self, event: Event) -> None:
        self._say("log/warnings", str(event.content), "WARN")

    def _on_done(self, event: Event) -> None:
        content = event.content
        words = f"{content.ending}: {content.reason}" if isinstance(content, Trial) else event.name
        self._say("log/subgoals", words)

    # -- how it is kept ----------------------------------------------------------------------------------------------

    def _log(self, entity: str, value: Any, static: bool = False) -> None:
        self._stream.log(entity, value, static=static)

    def _say(self, entity: str, text: str, level: str = "") -> None:
        self._log(entity, self._rr.TextLog(redact(text), level=level or "INFO"))

    def _image(self, view_id: str) -> str:
        return f"world/cameras/{view_id}/image"

    def _keep_view(self, view: View) -> None:
        entity, camera = self._image(view.id), view.camera
        self._views[view.id] = entity
        width, height = view.size_px
        if isinstance(camera, PinholeCamera):
            pose: Pose = camera.T_base_cam
            w, x, y, z = (float(value) for value in pose.quaternion_wxyz)
            turned = self._rr.Quaternion(xyzw=(x, y, z, w))
            stands = self._rr.Transform3D(translation=pose.position_m, quaternion=turned)
            self._log(f"world/cameras/{view.id}", stands)
            pinhole = self._rr.Pinhole(
                image_from_camera=camera.K, resolution=(width, height), image_plane_distance=PLANE_M
            )
            self._log(entity, pinhole)
        if view.depth_m is not None and camera is not None and not isinstance(camera, PlanarCamera):
            self._log(f"world/seen/{view.id}", self._points(view))
        self._log(f"{entity}/rgb", self._rr.Image(view.rgb).compress(jpeg_quality=JPEG_QUALITY))
        if view.depth_m is not None:
            self._log(f"{entity}/depth", self._depth(view.depth_m))

    def _points(self, view: View) -> Any:
        """What a view shows, as coloured points in space; every n-th pixel, so that they are not too many."""
        assert view.depth_m is not None
        assert view.camera is not None
        stride = max(1, math.ceil(math.sqrt(view.depth_m.size / MOST_SEEN)))
        thinned = np.zeros(view.depth_m.shape, dtype=bool)
        thinned[::stride, ::stride] = True
        rows, columns = np.nonzero(thinned & np.isfinite(view.depth_m) & (view.depth_m > 0))
        points = view.camera.deproject(np.column_stack([columns, rows]) + 0.5, view.depth_m[rows, columns])
        if self._limits is not None:
            # A camera that looks aslant sees floor and walls for metres behind the table.
            low, high = np.array(self._limits.low_m) - ROUND_M, np.array(self._limits.high_m) + ROUND_M
            near = ((points >= low) & (points <= high)).all(axis=1)
            points, rows, columns = points[near], rows[near], columns[near]
        return self._rr.Points3D(points, colors=view.rgb[rows, columns], radii=SEEN_M)

    def _depth(self, depth_m: Array) -> Any:
        """As a PNG of 16 bits, 0 where it is not known."""
        known = np.where(np.isfinite(depth_m) & (depth_m > 0), depth_m, 0.0)
        units, _ = next((one for one in DEPTH_UNITS if float(known.max()) <= one[1]), DEPTH_UNITS[-1])
        good, coded = cv2.imencode(".png", np.clip(known * units, 0, 65535).round().astype(np.uint16))
        assert good
        return self._rr.EncodedDepthImage(blob=coded.tobytes(), media_type="image/png", meter=units)

    def _keep_tool(self, tool_m: Array, yaw_rad: float | None = None) -> None:
        self._measured.append(tool_m)
        self._log("world/robot/tool", self._rr.Points3D([tool_m], colors=[MEASURED], radii=0.006))
        if yaw_rad is not None:
            turned = self._rr.RotationAxisAngle((0.0, 0.0, 1.0), radians=yaw_rad)
            self._log("world/robot/pose", self._rr.Transform3D(translation=tool_m, rotation=turned))
        if len(self._measured) > 1:
            lines = self._rr.LineStrips3D([np.array(self._measured)], colors=[MEASURED], radii=0.001)
            self._log("world/robot/measured", lines)


def _positions(value: Any) -> Array | None:
    """Positions that a robot reported, shape (N, 3) [m]; None where it is something else."""
    if not isinstance(value, Sequence) or isinstance(value, str):
        return None
    try:
        points = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        return None
    good = points.ndim == 2 and points.shape[1:] == (3,) and len(points) and bool(np.isfinite(points).all())
    return points if good else None
