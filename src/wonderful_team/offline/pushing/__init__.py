"""Straight pushes over a table: from where, past what, into what."""
