"""Names that everything in a study shares, and how a reader wants them. Imports nothing heavy: every worker needs it."""

from __future__ import annotations

import re

ORACLE, NO_OP, RANDOM = "oracle", "no-op", "random"
CONTROLS: dict[str, str] = {
    ORACLE: "control: the simulator's own solution; must succeed",
    NO_OP: "control: does nothing; must fail",
    RANDOM: "control: one random action for each of the oracle's; must fail nearly always",
}
NO_MODEL = "-"
"""Stands for the model of a condition that asks none."""
_FOLDERS = re.compile(r"[^\s·,=]*/(?=[^\s·,=/]*\.py:)")


def short_names(text: str) -> str:
    """The text with every FILE.py:NAME without its folders: a long path would leave no room for figures."""
    return _FOLDERS.sub("", text)
