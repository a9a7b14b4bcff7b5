"""Suites of the toy table: what they are called, and how an answer is scored. The paper's Appendix F."""

from __future__ import annotations

import math
from collections.abc import Sequence

from wonderful_team.core.pictures import Point
from wonderful_team.evals.trials import TrialRow

POINTING = "toy/pointing"
BOXCHECK = "toy/boxcheck/"
ANNOTATION = "toy/annotations/"
ANNOTATIONS = tuple(f"{ANNOTATION}{name}" for name in ("axes", "crop", "crop_verdict", "strips", "before_after"))
"""Questions that are asked with an annotation and without."""
BOX_KINDS = ("perfect", "slightly_off", "around", "wrong_object")
WITHIN = (1, 3, 4)
"""Distances that the paper counts points within [radii of the target]."""
WORDS = ("accept", "revise", "reject")


def is_toy(task: str) -> bool:
    """Whether a task is a question about the toy table."""
    return task == POINTING or task.startswith((BOXCHECK, ANNOTATION))


def score_point(point: Point | None, centre: Point, radius_px: float, rounds: Sequence[Point] = ()) -> TrialRow:
    """Success within the circle; facts in radii. `rounds`: where the middle was said to be before, round by round."""
    facts = {f"within {radii} radii" if radii > 1 else "within 1 radius": 0.0 for radii in WITHIN}
    for number, earlier in enumerate(rounds):
        facts[f"error in round {number} [radii]"] = math.dist(earlier, centre) / radius_px
    if point is None:
        return TrialRow("failure", "grounding", "not found", facts=facts)
    off = math.dist(point, centre) / radius_px
    facts |= {name: float(off <= radii) for name, radii in zip(list(facts)[: len(WITHIN)], WITHIN, strict=True)}
    facts["error [radii]"] = off
    if off <= 1.0:
        return TrialRow("success", None, f"{off:.2f} radii off", facts=facts)
    return TrialRow("failure", "grounding", f"{off:.2f} radii off; valid: at most 1", facts=facts)


def score_verdict(said: str, right: str) -> TrialRow:
    """Success when the verdict is right; the facts of all trials of a kind of box are its row of the confusion matrix."""
    facts = {word: float(word == said) for word in WORDS}
    if said == right:
        return TrialRow("success", None, f"{said}, as is right", facts=facts)
    return TrialRow("failure", "grounding", f"{said}; right: {right}", facts=facts)


def score_turn(said_deg: float | None, right_deg: float) -> TrialRow:
    """Success when the right angle of the list was chosen."""
    if said_deg is None:
        return TrialRow("failure", "grounding", f"no angle was said; right: {right_deg:g} degrees")
    off = abs(math.remainder(said_deg - right_deg, 360.0))
    facts = {"error [degrees]": off}
    if off < 1e-6:
        return TrialRow("success", None, f"{said_deg:g} degrees, as is right", facts=facts)
    return TrialRow("failure", "grounding", f"{said_deg:g} degrees; right: {right_deg:g}", facts=facts)


def score_word(said: str, right: str) -> TrialRow:
    """Success when the right word was said."""
    if said == right:
        return TrialRow("success", None, f"{said}, as is right")
    return TrialRow("failure", "grounding", f"{said}; right: {right}")
