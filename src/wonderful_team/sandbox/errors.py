"""What went wrong with a model's function, in words that help the model to mend it."""

from __future__ import annotations

from wonderful_team.errors import PlanError


class SandboxError(PlanError):
    """A helper function failed or returned something else than a path; the text goes back to its author."""
