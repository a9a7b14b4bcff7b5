"""Check what a user made: shapes and units of a world, its scorer against the controls, a method, a model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

from wonderful_team.core.filesystem import make_private_folder, write_private
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.intervals import Rate
from wonderful_team.core.protocols import World
from wonderful_team.core.text import counted
from wonderful_team.core.values import View
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.evals.controls import CONTROLS, control_faults
from wonderful_team.evals.trials import TrialRow
from wonderful_team.images import to_png

SEEDS = 20
TILE_PX = 320
COLUMNS = 4
NEAR_M, FAR_M = 0.02, 20.0
"""Depths outside this range are taken for another unit than metres."""


@dataclass
class Findings:
    """What a check found: every line is good, bad, or a note."""

    good: list[str] = field(default_factory=list)
    bad: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def add(self, ok: bool, good: str, bad: str) -> None:
        if ok:
            self.good.append(good)
        else:
            self.bad.append(bad)

    def lines(self) -> list[str]:
        """For reading."""
        kinds = (("ok   ", self.good), ("note ", self.notes), ("BAD  ", self.bad))
        return [f"{mark} {text}" for mark, texts in kinds for text in texts]


def check_looks(make: Callable[[int], World], seeds: Sequence[int], findings: Findings) -> list[tuple[str, Array]]:
    """Shapes, units and repeatability of what a world shows; returns one labelled picture per seed.

    Args:
        make: The world of a seed.
        seeds: Those that are looked at.
        findings: Gets what is found.
    """
    tiles, hashes, problems = [], [], dict[str, int]()
    for seed in seeds:
        world = make(seed)
        try:
            seen = world.observe()
            hashes.append(seen.hash)
            for view in seen.views.values():
                for problem in view_problems(view, world):
                    problems.setdefault(problem, seed)
            tiles.append((f"{seed}: {world.instruction.text}", seen.main.rgb))
        finally:
            world.close()
    for problem, seed in problems.items():
        findings.bad.append(f"{problem} (first at seed {seed})")
    if not problems:
        findings.good.append(f"shapes and units of all views are right on {counted(len(seeds), 'seed')}")
    again = make(seeds[0])
    try:
        same = again.observe().hash == hashes[0]
    finally:
        again.close()
    findings.add(
        same,
        "the same seed shows the same scene",
        f"seed {seeds[0]} shows another scene the second time: use the seed for all that is random",
    )
    different = len(set(hashes))
    findings.add(
        different > len(seeds) // 2 or len(seeds) == 1,
        f"{counted(different, 'different scene')} on {counted(len(seeds), 'seed')}",
        f"only {counted(different, 'different scene')} on {counted(len(seeds), 'seed')}: the seed is not used",
    )
    return tiles


def view_problems(view: View, world: World) -> list[str]:
    """What is wrong with the depth or the camera of a view, in words."""
    found = []
    where = f"view {view.id!r}"
    if int(view.rgb.max()) <= 1:
        found.append(f"{where}: rgb goes from 0 to {int(view.rgb.max())}; expected 0 to 255")
    depth = None if view.depth_m is None else view.depth_m[np.isfinite(view.depth_m)]
    if depth is not None and depth.size and not (NEAR_M <= float(np.median(depth)) <= FAR_M):
        found.append(
            f"{where}: the median depth is {float(np.median(depth)):.3g}; in metres {NEAR_M} to {FAR_M} is expected"
        )
    if view.camera is None:
        found.append(f"{where}: no camera, so nothing can be run from it")
        return found
    width, height = view.size_px
    pixels = np.array([(0.5 * width, 0.5 * height), (0.4 * width, 0.6 * height)])
    try:
        back = view.camera.project(view.camera.on_plane(pixels, 0.0))
        if float(np.abs(back - pixels).max()) > 0.5:
            found.append(f"{where}: project(on_plane(pixel)) is {float(np.abs(back - pixels).max()):.1f} px off")
        middle = (np.array(world.limits.low_m) + np.array(world.limits.high_m)) / 2
        u, v = view.camera.project([(middle[0], middle[1], 0.0)])[0]
        if not (0 <= u <= width and 0 <= v <= height):
            found.append(
                f"{where}: the middle of the workspace is projected to ({u:.0f}, {v:.0f}), outside {width} x {height} px"
            )
    except (ValueError, WonderfulTeamError) as error:
        found.append(f"{where}: {error}")
    return found


def check_controls(results: dict[str, list[TrialRow]], findings: Findings) -> None:
    """The oracle succeeds, no-op and random do not."""
    counts = {}
    for name in CONTROLS:
        mine = results.get(name, [])
        errors = [one for one in mine if one.outcome == "error"]
        if errors:
            findings.bad.append(f"{name}: {len(errors)} of {counted(len(mine), 'trial')} broke: {errors[0].reason}")
        scored = [one for one in mine if one.outcome in ("success", "failure")]
        counts[name] = (sum(one.outcome == "success" for one in scored), len(scored))
        if mine and not scored:
            findings.bad.append(f"{name}: no trial was scored: {mine[0].reason}")
        else:
            findings.good.append(f"{name}: {Rate(*counts[name])}")
    findings.bad += control_faults(counts)
    if counts.get("oracle", (0, 0))[1] and not control_faults(counts):
        findings.good.append("the scorer tells the oracle from doing nothing and from random actions")


def contact_sheet(tiles: Sequence[tuple[str, Array]], path: Path) -> Path:
    """Write pictures with their labels as one PNG."""
    drawn = [_tile(label, rgb) for label, rgb in tiles]
    height = max(tile.shape[0] for tile in drawn)
    blank = np.full((height, TILE_PX, 3), 255, np.uint8)
    padded = [np.vstack([tile, blank[: height - tile.shape[0]]]) for tile in drawn]
    padded += [blank] * (-len(padded) % COLUMNS)
    rows = [np.hstack(padded[start : start + COLUMNS]) for start in range(0, len(padded), COLUMNS)]
    make_private_folder(path.parent)
    write_private(path, to_png(np.vstack(rows)))
    return path


def _tile(label: str, rgb: Array) -> Array:
    scale = (TILE_PX - 8) / rgb.shape[1]
    small = cv2.resize(rgb, (TILE_PX - 8, max(1, round(rgb.shape[0] * scale))), interpolation=cv2.INTER_AREA)
    tile = np.full((small.shape[0] + 40, TILE_PX, 3), 255, np.uint8)
    tile[36:-4, 4:-4] = small
    for line, start in enumerate(range(0, min(len(label), 96), 48)):
        text = label[start : start + 48].encode("ascii", "replace").decode()
        cv2.putText(tile, text, (5, 14 + 15 * line), cv2.FONT_HERSHEY_SIMPLEX, 0.38, (30, 30, 30), 1, cv2.LINE_AA)
    return tile
