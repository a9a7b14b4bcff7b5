"""Models that answer from a simulator's truth, seen through the pictures that they are shown."""

from wonderful_team.simulated.model import SimulatedModel
from wonderful_team.simulated.profile import Profile
from wonderful_team.simulated.profiles import PROFILES, profile_named
from wonderful_team.simulated.unbound import Unbound

__all__ = ["PROFILES", "Profile", "SimulatedModel", "Unbound", "profile_named"]
