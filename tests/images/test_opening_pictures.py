"""Pictures of formats that start programs are refused, whatever they are called and wherever they are met."""

from __future__ import annotations

import ast
import base64
import json
import shutil
import subprocess
from pathlib import Path

import pytest
from PIL import EpsImagePlugin, Image

import wonderful_team as wt
from tests.desk import WORDS, draw_desk, read_record
from wonderful_team.errors import BadPictureError, ConfigError
from wonderful_team.images import load_depth, load_picture
from wonderful_team.images.thumbnail import run_thumbnail
from wonderful_team.pages import write_page
from wonderful_team.record import read_plan_scene
from wonderful_team.record.plan_file import plan_from_json
from wonderful_team.record.stored import stored_observation

SOURCE = Path(__file__).parents[2] / "src" / "wonderful_team"
EPS = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 64 64\n%%EndComments\nshowpage\n%%EOF\n"


@pytest.fixture
def started(tmp_path, monkeypatch):
    """What is there once Ghostscript was started; and an EPS that is called PNG."""
    shown, program = tmp_path / "started", tmp_path / "gs"
    program.write_text(f"#!/bin/sh\ntouch {shown}\nexit 1\n", encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setattr(EpsImagePlugin, "gs_binary", str(program))
    return shown


@pytest.fixture
def eps(tmp_path):
    file = tmp_path / "picture.png"
    file.write_bytes(EPS)
    return file


def test_pillow_by_itself_starts_it(started, eps):
    with pytest.raises(subprocess.CalledProcessError), Image.open(eps) as opened:
        opened.load()
    assert started.exists()


def test_a_picture_and_depth_of_a_users(started, eps):
    with pytest.raises(BadPictureError, match="not a picture"):
        load_picture(eps)
    with pytest.raises(BadPictureError, match="not a picture"):
        load_depth(eps)
    assert not started.exists()


def test_the_pictures_of_a_run(started, tmp_path, eps):
    (tmp_path / "desk").mkdir()
    desk = draw_desk(tmp_path / "desk")
    photo = wt.Observation.from_files(desk / "desk.png", camera=desk / "camera.json", depth=desk / "depth.png")
    plan = wt.Team(out=tmp_path / "runs").plan(photo, WORDS)
    for file in [*plan.folder.rglob("*.png")]:
        shutil.copy(eps, file)
    write_page(plan.folder)
    assert run_thumbnail(plan.folder) == ""
    assert read_plan_scene(plan.folder, plan.plan) is None
    assert not started.exists()


def test_a_picture_inside_of_a_plan(started, tmp_path):
    world = wt.make_world("tabletop/visual_manipulation", seed=3)
    try:
        folder = wt.Team(out=tmp_path / "runs").plan(world.observe(), world.instruction).folder
    finally:
        world.close()
    held = json.loads((folder / "plan.json").read_text(encoding="utf-8"))
    text = json.dumps(held)
    assert '"png": "' in text
    start = text.index('"png": "') + len('"png": "')
    spoiled = text[:start] + base64.b64encode(EPS).decode() + text[text.index('"', start) :]
    with pytest.raises(ConfigError, match="picture cannot be read"):
        plan_from_json(json.loads(spoiled), "the plan")
    assert not started.exists()


@pytest.mark.parametrize("kind", ["above", "whole", "link", "depth"])
def test_a_record_names_files_of_its_own_folder_only(kind, tmp_path):
    (tmp_path / "desk").mkdir()
    desk = draw_desk(tmp_path / "desk")
    photo = wt.Observation.from_files(desk / "desk.png", camera=desk / "camera.json", depth=desk / "depth.png")
    plan = wt.Team(out=tmp_path / "runs").plan(photo, WORDS)
    record = read_record(plan.folder)
    seen = record["planner"]["observations"][0]
    (key,) = seen["views"].values()
    inside, outside = plan.folder / record["files"][key], tmp_path / "outside.png"
    # The very picture: only where it lies is wrong.
    shutil.move(inside, outside)
    if kind == "link":
        inside.symlink_to(outside)
    elif kind == "depth":
        shutil.move(outside, inside)
        (stored,) = seen["stored"].values()
        shutil.move(plan.folder / stored["depth"], tmp_path / "outside.npz")
        stored["depth"] = "../../outside.npz"
    else:
        record["files"][key] = str(outside) if kind == "whole" else "../../outside.png"
    (plan.folder / "record.json").write_text(json.dumps(record), encoding="utf-8")
    with pytest.raises(ConfigError, match="not in its folder"):
        stored_observation(plan.folder, record, 0)
    if kind != "depth":
        assert read_plan_scene(plan.folder, plan.plan) is None
    # The page shows none of it either.
    if kind == "link":
        assert "picture missing" in write_page(plan.folder).read_text(encoding="utf-8")
    else:
        with pytest.raises(ConfigError, match="leads out of the run folder"):
            write_page(plan.folder)


def test_no_other_call_opens_a_picture():
    """One function lists the formats; whoever opens a picture beside it opens all that Pillow or OpenCV know."""
    found = []
    for path in SOURCE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                name = f"{getattr(node.func.value, 'id', '')}.{node.func.attr}"
                if name in ("Image.open", "cv2.imread", "cv2.imdecode", "plt.imread", "io.imread"):
                    found.append(f"{path.relative_to(SOURCE)}: {name}")
            if isinstance(node, ast.ImportFrom) and node.module == "PIL.Image":
                found += [f"{path.relative_to(SOURCE)}: {a.name}" for a in node.names if a.name != "Image"]
    assert found == ["images/load.py: Image.open"]
