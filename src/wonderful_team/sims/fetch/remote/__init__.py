"""The other side of the pipe: runs where gymnasium-robotics is, with it, MuJoCo, the standard library and numpy alone.

`sims/process/launch.py` loads it by its path, so nothing of wonderful_team needs to be installed there; Python 3.9 or newer.
"""
