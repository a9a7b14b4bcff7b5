"""How often and how far a model errs, as `probe --full` measured it: what simulated models will be made of.

Every distance is a share of something in the picture, so that it carries over to other picture sizes. Counts are kept, not
only rates, so that an interval can be given to every figure.
"""

from __future__ import annotations

from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

SCHEMA_VERSION: Final = 1
QUANTILES: tuple[float, ...] = (0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95)
"""Quantiles that a distribution is kept as."""

BoxState = Literal["tight", "loose", "cut", "shifted", "elsewhere"]
"""What was wrong with a box that was judged: nothing, too large, part of the target outside, moved, on something else."""
BoxWord = Literal["accept", "revise", "reject", "no answer"]
STATES: tuple[BoxState, ...] = ("tight", "loose", "cut", "shifted", "elsewhere")
WORDS: tuple[BoxWord, ...] = ("accept", "revise", "reject", "no answer")

Share = Annotated[FiniteFloat, Field(ge=0)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


class Count(_Part):
    """So many of so many, with a 95 % interval of the rate; the interval is None when nothing was counted."""

    count: int = Field(ge=0)
    n: int = Field(ge=0)
    low: Share | None = None
    high: Share | None = None


class Distribution(_Part):
    """Sizes of errors, as quantiles (levels in QUANTILES), over `n` values; the interval is of the median (95 %)."""

    n: int = Field(ge=0)
    quantiles: list[Share] = Field(default_factory=list)
    median_low: Share | None = None
    median_high: Share | None = None


class Pointing(_Part):
    """Points given for targets that are there.

    Attributes:
        radial: Distance to the true point, as a share of the picture's diagonal; wild points left out.
        bias: Mean error (x, y) as shares of width and height; wild points left out.
        spread: Standard deviation of the error (x, y) in the same shares.
        wild: Points further off than `wild_beyond` diagonals: on another thing or nowhere.
    """

    radial: Distribution
    bias: tuple[FiniteFloat, FiniteFloat] = (0.0, 0.0)
    spread: tuple[FiniteFloat, FiniteFloat] = (0.0, 0.0)
    wild: Count
    wild_beyond: Share


class Boxes(_Part):
    """Boxes given for targets that are there.

    Attributes:
        iou: Overlap with the true box (intersection over union).
        edge: Distance of an edge to where it should be, as a share of the true box's side across it; wild boxes left out.
        wild: Boxes that do not overlap the true one at all.
    """

    iou: Distribution
    edge: Distribution
    wild: Count


class Detection(_Part):
    """Whether it says that targets are there: of those that are, how many it misses; of those that are not, how many it
    finds all the same.
    """

    missed: Count
    imagined: Count


class Confusion(_Part):
    """Verdicts on boxes: `counts[state][word]` for every state of STATES and word of WORDS."""

    counts: dict[BoxState, dict[BoxWord, int]]
    wrongly_accepted: Count
    wrongly_refused: Count


class SceneKind(_Part):
    """Which scenes were shown: synthetic (marks on drawn backgrounds) or rendered (a simulator's), by seed."""

    kind: str
    seeds: list[int]
    targets: int = Field(ge=0)


class ErrorProfile(_Part):
    """Everything that `probe --full` measures of how a model errs. JSON, schema version 1; docs/profiles.md explains it."""

    schema_version: Literal[1] = SCHEMA_VERSION
    scenes: list[SceneKind]
    detection: Detection
    pointing: Pointing
    boxes: Boxes
    judgement: Confusion
    failed_requests: Count
