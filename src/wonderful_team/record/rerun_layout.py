"""What Rerun's viewer shows of a recording at first: space beside the pictures, below them what was said and what the robot measured."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from wonderful_team.core.values import Limits

UNITS = {"m": "m", "n": "N", "rad": "rad", "s": "s", "px": "px"}
"""Unit of what a robot reports, by the end of its name."""
LOOKS_FROM = (1.5, -1.2, 1.3)
"""Where space is looked at from: from the middle of the workspace, in shares of its longest side, before the robot and to its right."""


def quantity(name: str) -> tuple[str, str]:
    """A reported number's name in words and its unit: "held_width_m" is ("held width", "m"); without a unit ""."""
    words, _, end = name.rpartition("_")
    return (words.replace("_", " "), UNITS[end]) if words and end in UNITS else (name.replace("_", " "), "")


def title(name: str) -> str:
    """What a curve is called: "held width [m]"."""
    words, unit = quantity(name)
    return f"{words} [{unit}]" if unit else words


def layout(views: Mapping[str, str], main: str, measured: Iterable[str], limits: Limits | None) -> Any:
    """The blueprint of a recording.

    Args:
        views: Entity of every view's picture, by the view's name.
        main: The view that was planned in.
        measured: Names of the numbers that the robot reported.
        limits: Where the robot may go; None where that is not known or has no bounds.
    """
    import rerun.blueprint as rrb

    # Depth stands in space as coloured points; its picture would cover them in the colours of a rainbow.
    space = ["$origin/**", *(f"- /{image}/depth" for image in views.values())]
    eye = None
    if limits is not None:
        low, high = np.array(limits.low_m), np.array(limits.high_m)
        middle, side = (low + high) / 2, float((high - low).max())
        eye = rrb.EyeControls3D(position=middle + side * np.array(LOOKS_FROM), look_target=middle, eye_up=(0, 0, 1))
    flat = [
        rrb.Spatial2DView(origin=image, contents=["$origin/**", "- $origin/depth"], name=name)
        for name, image in sorted(views.items(), key=lambda view: view[0] != main)
    ]
    said = rrb.TextDocumentView(origin="instruction", name="instruction")
    pictures = rrb.Vertical(said, *flat, row_shares=[0.35, *([1.0] * len(flat))])
    upper = rrb.Horizontal(rrb.Spatial3DView(origin="world", contents=space, name="space", eye_controls=eye), pictures)
    columns = rrb.TextLogColumns(timeline_columns=["step"], text_log_columns=["LogLevel", "Body"])
    log: Any = rrb.TextLogView(origin="log", name="what happened", columns=columns)
    plots = _curves(sorted(measured))
    lower = rrb.Horizontal(log, *plots, column_shares=[1.5, *([1.0] * len(plots))])
    return rrb.Blueprint(
        rrb.Vertical(upper, lower, row_shares=[5, 2]),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="step"),
    )


def _curves(names: Sequence[str]) -> list[Any]:
    """A plot of lengths, and one beside it for every other unit, in tabs: they have no axis in common."""
    import rerun.blueprint as rrb

    units: dict[str, list[str]] = {}
    for name in names:
        units.setdefault(quantity(name)[1], []).append(name)
    plots = [
        rrb.TimeSeriesView(
            origin="robot",
            contents=[f"/robot/{name}" for name in members],
            name=f"robot, in {unit}" if unit else "robot, yes = 1",
        )
        for unit, members in sorted(units.items(), key=lambda one: (one[0] != "m", one[0] == "", one[0]))
    ]
    return [plots[0], rrb.Tabs(*plots[1:])] if len(plots) > 2 else plots
