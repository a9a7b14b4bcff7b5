"""Measuring methods: statistics over trials. Suites and studies build on these."""

from wonderful_team.core.intervals import Rate, wilson_interval
from wonderful_team.evals.statistics import Confusion

__all__ = ["Confusion", "Rate", "wilson_interval"]
