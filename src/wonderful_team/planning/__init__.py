"""The loops of the team: plan and check, ground, act, remember, replan."""

from wonderful_team.planning.config import SETTINGS, Bounds, Members, TeamConfig
from wonderful_team.planning.team import UNTIL, Team, Until

__all__ = ["SETTINGS", "UNTIL", "Bounds", "Members", "Team", "TeamConfig", "Until"]
