"""Error models by name."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.models.error_profile import QUANTILES, BoxState, Confusion, Count, Distribution, ErrorProfile
from wonderful_team.models.profiles import load_profile, profile_names
from wonderful_team.simulated.paper_models import PAPER_MODELS
from wonderful_team.simulated.profile import Judgement, Profile, Rates

SIGMAS_OF_MEDIAN = 0.6745
"""Half of all values of a normal distribution lie within this many standard deviations."""

PROFILES: dict[str, Profile] = {
    "perfect": Profile("perfect"),
    "coarse": Profile("coarse", spread=(0.01, 0.01), edge=0.08, missed=0.02, judgement=Judgement.erring(0.05, 0.05)),
    "hasty": Profile(
        "hasty", spread=(0.004, 0.004), edge=0.03, missed=0.05, wrong_thing=0.05, wrong_choice=0.05,
        judgement=Judgement.erring(0.1, 0.0), wrong_plan=0.15, overlooks=0.3,
    ),
    **PAPER_MODELS,
}  # fmt: skip
"""Made up for trying how the team copes with errors of a known size; those called paper-... are fitted to what the paper measured."""


SHARES = (
    "missed",
    "imagined",
    "wrong_thing",
    "wrong_choice",
    "wrong_plan",
    "overlooks",
    "accepts_wrong",
    "refuses_right",
)
"""Rates that a name may set, from 0 to 1."""
SIZES = ("spread", "edge", "correction")
"""Sizes of errors that a name may set, 0 or more; `spread` in both directions."""
SETTABLE = (*SHARES, *SIZES, "shifts_boxes", "seed")


def profile_named(name: str) -> Profile:
    """An error model by name: one of PROFILES, one that `probe --full --save NAME` measured, or either with rates of its own,
    as in "perfect:wrong_plan=0.5:overlooks=0.1".

    Raises:
        UnknownNameError: No such profile, or no such rate.
        ConfigError: That profile holds no error model, or a value out of range.
    """
    base, *settings = name.split(":")
    profile = _profile_named(base)
    if not settings:
        return profile
    values = _read_settings(settings, name)
    return replace(_with_rates(profile, values), name=name)


def _read_settings(settings: Sequence[str], name: str) -> dict[str, float]:
    values: dict[str, float] = {}
    for setting in settings:
        key, separator, text = setting.partition("=")
        if key not in SETTABLE:
            raise UnknownNameError("rate of a simulated profile", key, SETTABLE)
        if key in values:
            raise ConfigError(f"simulated profile {name!r}: {key} is set twice")
        limit = "from 0 to 1" if key in SHARES else "0 or 1" if key == "shifts_boxes" else "0 or more"
        if key == "seed":
            limit = "a whole number from 0 on"
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        whole = key in ("shifts_boxes", "seed")
        fits = 0.0 <= value < math.inf and not (key in (*SHARES, "shifts_boxes") and value > 1.0)
        if not separator or not fits or (whole and value != int(value)):
            raise ConfigError(f"simulated profile {name!r}: {key} {text or '(nothing)'}; valid: {limit}, as in {key}=1")
        values[key] = value
    return values


def _with_rates(profile: Profile, values: Mapping[str, float]) -> Profile:
    judged = {key: values[key] for key in ("accepts_wrong", "refuses_right") if key in values}
    fields: dict[str, object] = {key: value for key, value in values.items() if key not in judged}
    made: Mapping[str, Callable[[float], object]] = {
        "spread": lambda value: (value, value), "shifts_boxes": bool, "seed": int,
    }  # fmt: skip
    fields |= {key: make(values[key]) for key, make in made.items() if key in values}
    if "spread" in values:
        fields |= {"radial": (), "bias": (0.0, 0.0)}
    if judged:
        fields["judgement"] = Judgement.erring(judged.get("accepts_wrong", 0.0), judged.get("refuses_right", 0.0))
    return replace(profile, **fields)  # type: ignore[arg-type]


def _profile_named(name: str) -> Profile:
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
    return Profile(
        name,
        spread=measured.pointing.spread,
        bias=measured.pointing.bias,
        edge=_sigma(measured.boxes.edge),
        missed=_rate(measured.detection.missed),
        imagined=_rate(measured.detection.imagined),
        wrong_thing=max(_rate(measured.pointing.wild), _rate(measured.boxes.wild)),
        judgement=_judgement(measured.judgement),
    )


def _judgement(measured: Confusion) -> Judgement:
    """The rates of every state of a box that was judged at all; the others from the two rates over all of them."""
    over_all = Judgement.erring(_rate(measured.wrongly_accepted), _rate(measured.wrongly_refused))

    def rates(states: Sequence[BoxState], otherwise: Rates) -> Rates:
        counts = [
            sum(measured.counts.get(state, {}).get(word, 0) for state in states)
            for word in ("accept", "revise", "reject")
        ]
        total = sum(counts)
        return (counts[0] / total, counts[1] / total, counts[2] / total) if total else otherwise

    return Judgement(
        rates(["tight"], over_all.tight),
        rates(["loose", "cut", "shifted"], over_all.off),
        *[rates(["elsewhere"], over_all.elsewhere)] * 2,
    )


def _rate(count: Count) -> float:
    return count.count / count.n if count.n else 0.0


def _sigma(errors: Distribution) -> float:
    return errors.quantiles[QUANTILES.index(0.5)] / SIGMAS_OF_MEDIAN if errors.quantiles else 0.0
