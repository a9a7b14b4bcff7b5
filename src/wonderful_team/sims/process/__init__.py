"""A simulator in a process, and a Python environment, of its own: started, asked over a pipe, and never left behind.

`launch.py`, `serving.py` and `frames.py` run on the other side too, with the standard library and numpy alone; Python 3.9 or newer.
"""
