"""`python -m wonderful_team`."""

from wonderful_team.cli import main

main()
