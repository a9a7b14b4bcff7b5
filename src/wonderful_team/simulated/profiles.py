"""Error models by name: how far and how often a simulated model errs."""

from __future__ import annotations

from dataclasses import dataclass

from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.models.error_profile import QUANTILES, Count, Distribution, ErrorProfile
from wonderful_team.models.profiles import load_profile, profile_names

SIGMAS_OF_MEDIAN = 0.6745
"""Half of all values of a normal distribution lie within this many standard deviations."""


@dataclass(frozen=True)
class Profile:
    """A stated error model. Every error follows from the request and the profile alone, so that a run can be repeated.

    Attributes:
        spread: Standard deviation of a point's error in x and y, as shares of the picture's width and height.
        bias: Its mean, in the same shares.
        edge: Standard deviation of a box edge's error, as a share of the box's side across it.
        missed: How often a target that is there is not found.
        imagined: How often something is found for a target that is not there.
        wrong_thing: How often another thing is taken for the target.
        accepts_wrong, refuses_right: How often a box is judged the other way round.
        wrong_choice: How often a wrong one of several numbered marks is chosen.
        wrong_plan: How often a plan leaves out its last move or swaps its first two.
        overlooks: How often a mistake in a plan is not noticed when it is checked, or an outcome judged the other way round.
        seed: Another seed errs elsewhere.
    """

    name: str
    spread: tuple[float, float] = (0.0, 0.0)
    bias: tuple[float, float] = (0.0, 0.0)
    edge: float = 0.0
    missed: float = 0.0
    imagined: float = 0.0
    wrong_thing: float = 0.0
    accepts_wrong: float = 0.0
    refuses_right: float = 0.0
    wrong_choice: float = 0.0
    wrong_plan: float = 0.0
    overlooks: float = 0.0
    seed: int = 0

    @property
    def errs(self) -> bool:
        """Whether it makes any errors at all."""
        return self != Profile(self.name, seed=self.seed)


PROFILES: dict[str, Profile] = {
    "perfect": Profile("perfect"),
    "coarse": Profile("coarse", spread=(0.01, 0.01), edge=0.08, missed=0.02, refuses_right=0.05, accepts_wrong=0.05),
    "hasty": Profile(
        "hasty", spread=(0.004, 0.004), edge=0.03, missed=0.05, wrong_thing=0.05, accepts_wrong=0.1, wrong_choice=0.05,
        wrong_plan=0.15, overlooks=0.3,
    ),
}  # fmt: skip
"""Made up, not measured from any model: for trying how the team copes with errors of a known size."""


def profile_named(name: str) -> Profile:
    """An error model by name: one of PROFILES, or one that `probe --full --save NAME` measured.

    Raises:
        UnknownNameError: No such profile.
        ConfigError: That profile holds no error model.
    """
    if name in PROFILES:
        return PROFILES[name]
    saved = profile_names()
    if name not in saved:
        raise UnknownNameError("simulated profile", name, [*PROFILES, *saved])
    measured = load_profile(name).errors
    if measured is None:
        raise ConfigError(
            f"profile {name!r} holds no error model: measure one with: wonderful-team probe MODEL --full --save {name}"
        )
    return from_measured(name, measured)


def from_measured(name: str, measured: ErrorProfile) -> Profile:
    """The error model that `probe --full` measured: what it did not measure (plans, outcomes) is without error."""
    words = measured.judgement
    return Profile(
        name,
        spread=measured.pointing.spread,
        bias=measured.pointing.bias,
        edge=_sigma(measured.boxes.edge),
        missed=_rate(measured.detection.missed),
        imagined=_rate(measured.detection.imagined),
        wrong_thing=max(_rate(measured.pointing.wild), _rate(measured.boxes.wild)),
        accepts_wrong=_rate(words.wrongly_accepted),
        refuses_right=_rate(words.wrongly_refused),
    )


def _rate(count: Count) -> float:
    return count.count / count.n if count.n else 0.0


def _sigma(errors: Distribution) -> float:
    return errors.quantiles[QUANTILES.index(0.5)] / SIGMAS_OF_MEDIAN if errors.quantiles else 0.0
