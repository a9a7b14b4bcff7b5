"""The team's roles: the words of each, and how each renders a question into a request."""

from wonderful_team.agents.prompts import ROLES, Prompts
from wonderful_team.agents.request import build_request
from wonderful_team.agents.role import Ask, Role
from wonderful_team.agents.step_words import step_words

__all__ = ["ROLES", "Ask", "Prompts", "Role", "build_request", "step_words"]
