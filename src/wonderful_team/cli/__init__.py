"""The command line `wonderful-team`: one file per command, imported only when it is asked for."""

from wonderful_team.cli.app import main

__all__ = ["main"]
