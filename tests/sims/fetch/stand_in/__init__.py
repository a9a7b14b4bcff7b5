"""A stand-in for the simulator, behind the real pipe."""
