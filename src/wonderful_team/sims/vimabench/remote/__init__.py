"""The other side of the pipe: runs in the simulator's own Python environment, with the standard library and numpy alone.

`sims/process/launch.py` loads it by its path, so nothing of wonderful_team needs to be installed there; Python 3.9 or newer.
"""
