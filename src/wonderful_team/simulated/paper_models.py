"""Error models of the three models that the paper measured: what it measured, and stated guesses for what it did not.

Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Appendix F: the share of points within 1, 3 and 4 radii of a circle of 50 px (of
how many it does not say), and verdicts on 25 boxes of each of four kinds. The paper gives no size for its toy pictures: 1,000 x 1,000 px are assumed
(`RADIUS`), and points beyond 4 radii are spread to `FARTHEST_RADII`. `GUESSED` is what the paper does not measure; it is the same for all
three, so that they differ by what was measured alone. One profile serves every task: nothing is fitted to a table of successes.
"""

from __future__ import annotations

from dataclasses import replace

from wonderful_team.simulated.profile import Judgement, Profile, Rates

RADIUS = 50.0 / (1000.0 * 2.0**0.5)
"""The circle's radius as a share of the picture's diagonal, for the assumed size."""
FARTHEST_RADII = 8.0

GUESSED = Profile(
    "guessed", shifts_boxes=True, edge=0.1, correction=0.25, missed=0.05, imagined=0.05, wrong_thing=0.05, wrong_choice=0.05,
    wrong_plan=0.2, overlooks=0.3,
)  # fmt: skip
"""Free parameters. That a box lies off as a point does is one of them."""


def _profile(
    name: str, within_1_3_4: tuple[int, int, int], tight: tuple[int, int, int], off: tuple[int, int, int],
    beside: tuple[int, int, int], elsewhere: tuple[int, int, int],
) -> Profile:  # fmt: skip
    within = zip((1.0, 3.0, 4.0, FARTHEST_RADII), (*within_1_3_4, 100), strict=True)
    radial = tuple((radii * RADIUS, percent / 100.0) for radii, percent in within)
    judgement = Judgement(*(_rates(counts) for counts in (tight, off, beside, elsewhere)))
    return replace(GUESSED, name=name, radial=radial, judgement=judgement)


def _rates(counts: tuple[int, int, int]) -> Rates:
    accept, revise, reject = counts
    total = sum(counts)
    return accept / total, revise / total, reject / total


PAPER_MODELS: dict[str, Profile] = {
    profile.name: profile
    for profile in (
        _profile("paper-gpt-4o", (33, 89, 97), (25, 0, 0), (1, 24, 0), (0, 2, 23), (0, 0, 25)),
        _profile("paper-gpt-4-turbo", (5, 46, 68), (18, 6, 1), (0, 24, 1), (0, 11, 14), (0, 9, 16)),
        _profile("paper-claude-3-opus", (4, 19, 58), (22, 2, 1), (19, 4, 2), (23, 0, 2), (19, 1, 5)),
    )
}
"""Percent of points within 1, 3 and 4 radii; boxes accepted, sent back and rejected: perfect, slightly off, around, on a wrong object."""
