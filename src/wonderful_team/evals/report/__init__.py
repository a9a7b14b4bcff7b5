"""The report of one or several stores: one HTML page, Markdown, CSV, LaTeX, pandas."""

from wonderful_team.evals.report.latex import latex_tables
from wonderful_team.evals.report.page import Written, write_all
from wonderful_team.evals.report.tables import to_csv, to_frame, to_markdown

__all__ = ["Written", "latex_tables", "to_csv", "to_frame", "to_markdown", "write_all"]
