"""Measuring methods: suites, studies in a durable store, statistics and reports."""

from wonderful_team.core.intervals import Rate, wilson_interval

__all__ = ["Rate", "wilson_interval"]
