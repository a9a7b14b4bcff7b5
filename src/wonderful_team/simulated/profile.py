"""An error model: how far and how often a simulated model errs."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from wonderful_team.errors import ConfigError

Judged: TypeAlias = Literal["tight", "off", "beside", "elsewhere"]
"""A box that is right, one that touches its target and does not fit, one beside it, and one on another thing or on nothing near it."""
Rates: TypeAlias = tuple[float, float, float]
"""How often a box is accepted, sent back and rejected; they sum to 1."""


@dataclass(frozen=True)
class Judgement:
    """How boxes are judged, by what is wrong with them; without error by default."""

    tight: Rates = (1.0, 0.0, 0.0)
    off: Rates = (0.0, 1.0, 0.0)
    beside: Rates = (0.0, 0.0, 1.0)
    elsewhere: Rates = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        for name in ("tight", "off", "beside", "elsewhere"):
            rates = getattr(self, name)
            if min(rates) < 0.0 or abs(sum(rates) - 1.0) > 1e-6:
                raise ConfigError(f"judgement of {name} boxes: {rates}; valid: three shares that sum to 1")

    @classmethod
    def erring(cls, accepts_wrong: float, refuses_right: float) -> Judgement:
        """A bad box is accepted, a tight one sent back so often; else it is judged rightly."""
        seen = 1.0 - accepts_wrong
        far = (accepts_wrong, 0.0, seen)
        return cls((1.0 - refuses_right, refuses_right, 0.0), (accepts_wrong, seen, 0.0), far, far)


@dataclass(frozen=True)
class Profile:
    """A stated error model. Every error follows from the request and the profile alone, so that a run can be repeated.

    Attributes:
        spread: Standard deviation of a point's error in x and y, as shares of the picture's width and height.
        bias: Its mean, in the same shares.
        radial: Instead of both: how far points lie off, as (distance [share of the picture's diagonal], share of points
            nearer than it), both rising from (0, 0) to a share of 1. Between two entries points are spread evenly over the
            ring, in every direction.
        shifts_boxes: Whether a box lies off as its middle would when pointed at.
        edge: Standard deviation of a box edge's error, as a share of the box's side across it.
        correction: Standard deviation of the error of a correction (by the Mover), as a share of the correction itself.
        missed: How often a target that is there is not found.
        imagined: How often something is found for a target that is not there.
        wrong_thing: How often another thing is taken for the target.
        judgement: How boxes are judged. Points are judged as boxes are: wrong ones as boxes that are off.
        wrong_choice: How often a wrong one of several numbered marks is chosen.
        wrong_plan: How often a plan leaves out its last move or swaps its first two.
        overlooks: How often a mistake in a plan is not noticed when it is checked, or an outcome judged the other way round.
        seed: Another seed errs elsewhere.
    """

    name: str
    spread: tuple[float, float] = (0.0, 0.0)
    bias: tuple[float, float] = (0.0, 0.0)
    radial: tuple[tuple[float, float], ...] = ()
    shifts_boxes: bool = False
    edge: float = 0.0
    correction: float = 0.0
    missed: float = 0.0
    imagined: float = 0.0
    wrong_thing: float = 0.0
    judgement: Judgement = field(default_factory=Judgement)
    wrong_choice: float = 0.0
    wrong_plan: float = 0.0
    overlooks: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        knots = ((0.0, 0.0), *self.radial)
        rising = all(a[0] < b[0] and a[1] <= b[1] for a, b in zip(knots, knots[1:], strict=False))
        if self.radial and not (rising and self.radial[-1][1] == 1.0):
            raise ConfigError(f"radial of profile {self.name!r}: {self.radial}; valid: both rise, the last share is 1")

    @property
    def errs(self) -> bool:
        """Whether it makes any errors at all."""
        return self != Profile(self.name, seed=self.seed)
