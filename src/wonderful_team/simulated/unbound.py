"""A simulated model before it has a world."""

from __future__ import annotations

from wonderful_team.core.values import Answer, Request
from wonderful_team.errors import ConfigError


class Unbound:
    """Stands for a simulated model until a world is known whose truth it can answer from."""

    needs_world = True

    def __init__(self, name: str) -> None:
        self.name = name

    def answer(self, request: Request) -> Answer:
        """Raises ConfigError: there is no truth to answer from."""
        raise ConfigError(
            f"model {self.name!r} was asked {request.contract} without a world: it answers from a simulator's truth only"
        )
