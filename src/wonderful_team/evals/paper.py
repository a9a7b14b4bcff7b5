"""The paper's columns beside ours: its published figures with their n, interval and source. Nothing of it was run here."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from wonderful_team.core.intervals import wilson_interval
from wonderful_team.evals.ablation import SETTINGS, left_out
from wonderful_team.evals.trials import Condition

COLUMNS = {
    "trajectory": "tg",
    "trajectory_generator": "tg",
    "tg": "tg",
    "moka": "moka",
    "nlap": "nlap",
    "instruct2act": "instruct2act",
    "vima": "vima_200m",
}
"""Names of rival methods and their column in the paper's table."""


@dataclass(frozen=True)
class PaperFigure:
    """A published success rate.

    Attributes:
        percent: As printed.
        n: Runs behind it; None where the paper does not say.
        source: Table it stands in.
    """

    percent: float
    n: int | None
    source: str

    @property
    def interval(self) -> tuple[float, float] | None:
        """95 % Wilson interval as shares; None without n."""
        return None if self.n is None else wilson_interval(round(self.percent * self.n / 100), self.n)

    def __str__(self) -> str:
        if self.interval is None:
            return f"{self.percent:g} % (n not stated)"
        low, high = self.interval
        return f"{self.percent:g} % (n = {self.n}; {100 * low:.0f} to {100 * high:.0f})"


@lru_cache
def published() -> dict[str, Any]:
    """The data file: source, conditions, and success per task and column."""
    found = json.loads(Path(__file__).with_name("paper_figures.json").read_text(encoding="utf-8"))
    assert isinstance(found, dict)
    return found


def paper_figure(task: str, method: str) -> PaperFigure | None:
    """What the paper reports for a task and a method; None where it reports nothing."""
    name, column = task.partition("/")[2], _column(method)
    if column is None:
        return None
    table, key = ("settings", name) if column.startswith("s") else ("vima17", name)
    folder = name.partition("/")[0]
    for real_robot in ("implicit", "spatial"):
        if folder in published()[real_robot]["success_percent"]:
            table, key = real_robot, folder
    part = published()[table]
    percent = part["success_percent"].get(key, {}).get(column)
    if percent is None:
        return None
    own = column == "ours" or table == "settings"
    n = int(part.get("n_own", published()["n_own"])) if own else None
    return PaperFigure(float(percent), n, str(part["table"]))


def paper_beside(task: str, condition: Condition) -> PaperFigure | None:
    """What of the paper may stand beside a condition: nothing beside an isolated part or a harder tier."""
    return None if condition.isolate or condition.perturb else paper_figure(task, condition.method)


def _column(method: str) -> str | None:
    words = method.split(":")
    read = left_out(method)
    if read is not None:
        off = read[1]
        return next((name for name, members in SETTINGS.items() if members == off), None) if off else "ours"
    if words[0] == "nlap":
        # What the paper reports had true coordinates; rows in which the model finds them stand in another table.
        if "privileged" not in words:
            return None
        return "nlap_wo_cot" if "no-cot" in words else "nlap"
    return COLUMNS.get(words[0].lower())
