"""wonderful-team: pictures and instructions to checked, grounded, executable robot plans."""

__version__ = "0.1.0"
