"""Measuring methods: statistics over trials. Suites and studies build on these."""

from wonderful_team.evals.statistics import Confusion, Rate, wilson_interval

__all__ = ["Confusion", "Rate", "wilson_interval"]
