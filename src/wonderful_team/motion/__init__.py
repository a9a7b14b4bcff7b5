"""Steps, grounded targets and a view become actions: heights, clearances, pixels to metres."""

from wonderful_team.motion.ground import ground_actions

__all__ = ["ground_actions"]
