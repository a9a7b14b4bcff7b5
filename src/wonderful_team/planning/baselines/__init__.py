"""Rival methods, one a file. None sees what the team alone has: memory, Verification, the grounding team, the Replanner."""
