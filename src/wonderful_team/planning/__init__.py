"""The loops of the team: plan and check, ground, act, remember, replan."""

from wonderful_team.planning.config import ABLATIONS, Bounds, Members, TeamConfig, members_of
from wonderful_team.planning.making import UNTIL, Until
from wonderful_team.planning.team import TeamPolicy

__all__ = ["ABLATIONS", "Bounds", "Members", "TeamConfig", "TeamPolicy", "UNTIL", "Until", "members_of"]
