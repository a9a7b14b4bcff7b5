"""`--rerun`: what happened is in the file, read back with Rerun's own reader; whatever goes wrong with it loses nothing else."""

from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wonderful_team as wt
from tests.motion.block_scenes import Block, looking_down, scene
from tests.pages.arm_run import ArmWorld, Carrying
from wonderful_team.cli.app import run
from wonderful_team.core.protocols import Event
from wonderful_team.errors import ConfigError, FileNotWrittenError, MissingExtraError
from wonderful_team.record import rerun_recording
from wonderful_team.record.rerun_layout import layout, title
from wonderful_team.record.rerun_recording import RERUN_NAME, RerunRecording

needs_rerun = pytest.mark.skipif(
    find_spec("rerun") is None,
    reason="the optional part rerun is not installed: pip install '.[rerun]' (docs/installing.md)",
)


def rows(path: Path) -> dict[str, list[dict[str, Any]]]:
    """From entity to its rows, in order: what the columns hold, with the step under "step" (None: at all times)."""
    from rerun.chunk import RrdReader

    found: dict[str, list[dict[str, Any]]] = {}
    for chunk in RrdReader(str(path)).stream():
        assert chunk.is_static or chunk.timeline_names == ["step"], chunk.entity_path
        for row in chunk.to_record_batch().to_pylist():
            values = {name.split(":")[-1]: value for name, value in row.items()}
            found.setdefault(chunk.entity_path, []).append({"step": None, **values})
    return {entity: sorted(rows, key=lambda row: row["step"] or 0) for entity, rows in found.items()}


@needs_rerun
def test_pictures_plan_poses_and_words_are_read_back(tmp_path: Path) -> None:
    file = tmp_path / "run.rrd"
    world = ArmWorld()
    trial = wt.rollout(Carrying(), world, rerun=file, out=tmp_path / "runs")
    assert trial.unwritten == ()
    held = rows(file)
    image = "/world/cameras/top/image"
    assert {f"{image}/rgb", f"{image}/depth", f"{image}/targets", "/world/plan/path", "/instruction"} <= set(held)
    assert held[f"{image}/targets"][0]["labels"] == ["T1 block T1", "A1 free space"]
    (grounded,) = (plan.grounded for plan in trial.plans)
    box = grounded["T1"].box
    assert box is not None
    assert held[f"{image}/targets"][0]["half_sizes"][0] == pytest.approx([box.width / 2, box.height / 2])
    profiles = next(gate.profiles for gate in trial.gates if gate.profiles)
    path = held["/world/plan/path"][0]
    assert path["step"] == 0
    assert [np.array(strip).shape for strip in path["strips"]] == [one.points_m.shape for one in profiles]
    assert np.array(path["strips"][-1]) == pytest.approx(profiles[-1].points_m, abs=1e-6)
    # One row at the start, and one for each action, at its own step.
    tools = {row["step"]: row["positions"][0] for row in held["/world/robot/tool"]}
    assert sorted(tools) == list(range(len(trial.reports) + 1))
    for step, report in enumerate(trial.reports, start=1):
        assert tools[step] == pytest.approx(report.measured["tool_m"], abs=1e-6)
    said = [row["text"][0] for row in held["/log/subgoals"]]
    assert said[0] == "G1: the cube stands behind the tower"
    assert len(held["/log/actions"]) == len(trial.reports)
    named, *measured = held["/robot/held_width_m"]
    assert named["names"] == ["held width [m]"]
    assert [row["scalars"] for row in measured] == [[pytest.approx(0.0391)]]


@needs_rerun
def test_depth_is_kept_to_a_tenth_of_a_millimetre(tmp_path: Path) -> None:
    import cv2

    wt.rollout(Carrying(), ArmWorld(), rerun=tmp_path / "a.rrd", out=tmp_path / "runs")
    row = rows(tmp_path / "a.rrd")["/world/cameras/top/image/depth"][0]
    coded = cv2.imdecode(np.array(row["blob"][0], dtype=np.uint8), cv2.IMREAD_UNCHANGED)
    seen = ArmWorld().observe().main.depth_m
    assert coded / row["meter"][0] == pytest.approx(seen, abs=1e-4)


@needs_rerun
def test_a_pinhole_stands_where_it_is(tmp_path: Path) -> None:
    camera = looking_down()
    recording = RerunRecording()
    recording.on_event(Event("observe", "start", wt.Observation({"top": scene(camera, Block(0.4, 0.0, 0.5, 0.1))})))
    recording.write(tmp_path / "a.rrd")
    held = rows(tmp_path / "a.rrd")
    assert held["/world/cameras/top"][0]["translation"][0] == pytest.approx(camera.T_base_cam.position_m, abs=1e-6)
    matrix = np.array(held["/world/cameras/top/image"][0]["image_from_camera"][0]).reshape(3, 3).T
    assert matrix == pytest.approx(camera.K)
    assert held["/world/seen/top"][0]["positions"], "in its own colours, not in those of a depth picture"


@needs_rerun
def test_without_a_file_it_lies_in_the_run_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["run", "tabletop/rotate", "--seed", "3", "--out", str(tmp_path), "--json", "--rerun"]) == 0
    told = json.loads(capsys.readouterr().out)["result"]
    file = Path(told["rerun"])
    assert file.name == RERUN_NAME
    assert (file.parent / "record.json").is_file()
    held = rows(file)
    assert 1000 < len(held["/world/seen/top"][0]["positions"]) <= 20_000, "what a camera without a place sees, in space"
    assert [row["step"] for row in held["/world/cameras/top/image/rgb"]][0] == 0
    assert any("G1" in row["text"][0] for row in held["/log/subgoals"])


@needs_rerun
def test_a_file_that_cannot_be_written_is_named_and_loses_nothing(tmp_path: Path) -> None:
    taken = tmp_path / "taken.rrd"
    taken.mkdir()
    trial = wt.rollout(Carrying(), ArmWorld(), rerun=taken, out=tmp_path / "runs")
    assert len(trial.unwritten) == 1
    assert "taken.rrd' cannot be written" in trial.unwritten[0]
    assert trial.folder is not None
    assert trial.reports
    record = json.loads((trial.folder / "record.json").read_text(encoding="utf-8"))
    assert record["state"] == "finished"
    assert record["unwritten"] == ["taken.rrd"]
    assert (trial.folder / "page.html").is_file()


@needs_rerun
def test_a_defect_while_it_is_kept_ends_the_recording_and_not_the_run(tmp_path: Path) -> None:
    recording = RerunRecording()
    recording.on_event(Event("warning", "w", "seen"))
    recording.on_event(Event("execute", "e", ("no action", "no report")))
    recording.on_event(Event("warning", "w", "not kept any more"))
    with pytest.raises(
        FileNotWrittenError, match=r"a\.rrd' cannot be written: the recording broke off: AssertionError"
    ):
        recording.write(tmp_path / "a.rrd")
    assert [row["text"] for row in rows(tmp_path / "a.rrd")["/log/warnings"]] == [["seen"]]


@needs_rerun
def test_an_interrupted_run_leaves_its_recording(tmp_path: Path) -> None:
    class Interrupted(ArmWorld):
        def execute(self, action: Any) -> Any:
            if self.ran == 3:
                raise KeyboardInterrupt
            return super().execute(action)

    with pytest.raises(KeyboardInterrupt):
        wt.rollout(Carrying(), Interrupted(), rerun=tmp_path / "a.rrd", out=tmp_path / "runs")
    assert len(rows(tmp_path / "a.rrd")["/log/actions"]) == 4


@needs_rerun
def test_a_robot_that_reports_odd_things_is_recorded_all_the_same(tmp_path: Path) -> None:
    class Odd(ArmWorld):
        def execute(self, action: Any) -> Any:
            report = super().execute(action)
            odd = {"tool_m": "there", "path_m": [1, 2], "yaw_rad": None, "force_n": float("nan"), "note": "x"}
            return wt.StepReport(report.action, True, odd)

    trial = wt.rollout(Carrying(), Odd(), rerun=tmp_path / "a.rrd", out=tmp_path / "runs")
    assert trial.unwritten == ()
    held = rows(tmp_path / "a.rrd")
    assert len(held["/log/actions"]) == len(trial.reports)
    assert "/robot/force_n" not in held


@needs_rerun
def test_a_key_stays_out_of_it_and_it_is_its_owners_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    key = "sk-ant-api03-" + "K3y" * 12
    monkeypatch.setenv("ANTHROPIC_API_KEY", key)
    world = ArmWorld()
    world.instruction = wt.Instruction(f"put {key} behind the tower")  # type: ignore[misc]
    wt.rollout(Carrying(), world, rerun=tmp_path / "a.rrd", out=tmp_path / "runs")
    held = rows(tmp_path / "a.rrd")
    assert key not in str(held)
    assert "[redacted]" in held["/instruction"][0]["text"][0]
    assert (tmp_path / "a.rrd").stat().st_mode & 0o777 == 0o600


def test_without_the_optional_part_nothing_moves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(rerun_recording, "find_spec", lambda name: None)
    world = ArmWorld()
    with pytest.raises(MissingExtraError, match=r"--rerun needs the optional part 'rerun': .*pip install .*rerun"):
        wt.rollout(Carrying(), world, rerun=tmp_path / "a.rrd", out=tmp_path / "runs")
    assert world.ran == 0
    assert run(["run", "tabletop/rotate", "--out", str(tmp_path / "runs"), "--rerun"]) == 2
    assert "needs the optional part 'rerun'" in capsys.readouterr().err
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize(("name", "words"), [("a.mp4", r"ending must be \.rrd"), ("gone/a.rrd", "there is no folder")])
def test_a_name_that_cannot_be_is_refused_before_anything_moves(tmp_path: Path, name: str, words: str) -> None:
    world = ArmWorld()
    with pytest.raises(ConfigError, match=words):
        wt.rollout(Carrying(), world, rerun=tmp_path / name, out=tmp_path / "runs")
    assert world.ran == 0
    assert not (tmp_path / "runs").exists()


@needs_rerun
def test_what_is_seen_in_space_ends_round_the_workspace(tmp_path: Path) -> None:
    view = scene(looking_down(), Block(0.4, 0.0, 0.5, 0.1))
    recording, limits = RerunRecording(), wt.Limits((0.4, 0.0, 0.0), (0.5, 0.1, 0.4))
    recording.on_event(Event("run", "run", {"limits": limits}))
    recording.on_event(Event("observe", "start", wt.Observation({"top": view})))
    recording.write(tmp_path / "a.rrd")
    points = np.array(rows(tmp_path / "a.rrd")["/world/seen/top"][0]["positions"])
    assert len(points)
    assert (points >= np.array(limits.low_m) - rerun_recording.ROUND_M - 1e-6).all()
    assert (points <= np.array(limits.high_m) + rerun_recording.ROUND_M + 1e-6).all()


@needs_rerun
def test_the_viewer_opens_with_space_pictures_words_and_a_plot_for_every_unit(tmp_path: Path) -> None:
    measured = ["opening_m", "force_n", "yaw_rad", "holding"]
    made = layout({"front": "world/cameras/front/image", "top": "world/cameras/top/image"}, "top", measured, None)
    upper, lower = made.root_container.contents
    space, beside = upper.contents
    assert "- /world/cameras/top/image/depth" in space.contents
    assert [view.name for view in beside.contents] == ["instruction", "top", "front"]
    log, lengths, others = lower.contents
    assert (log.name, lengths.name) == ("what happened", "robot, in m")
    assert [plot.name for plot in others.contents] == ["robot, in N", "robot, in rad", "robot, yes = 1"]


@pytest.mark.parametrize(
    ("name", "words"), [("held_width_m", "held width [m]"), ("force_n", "force [N]"), ("holding", "holding")]
)
def test_a_curve_says_its_unit(name: str, words: str) -> None:
    assert title(name) == words
