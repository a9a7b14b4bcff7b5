"""The page of one run: one HTML file, built from the run folder alone; opens without a network."""

from wonderful_team.pages.write import PAGE_NAME, write_page

__all__ = ["PAGE_NAME", "write_page"]
