"""What can go wrong in the sandbox, by whose fault it is."""

from __future__ import annotations

from wonderful_team.errors import ConfigError, PlanError


class SandboxError(PlanError):
    """A helper function failed or returned something other than a path; the text goes back to its author."""


class SandboxUnavailableError(ConfigError):
    """The sandbox itself does not run here, whatever the code is; never the fault of a model's code."""
