"""Measuring methods: suites, studies in a durable store, statistics and reports."""

from wonderful_team.core.intervals import Rate, wilson_interval
from wonderful_team.evals.statistics import Confusion

__all__ = ["Confusion", "Rate", "wilson_interval"]
