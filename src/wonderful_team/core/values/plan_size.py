"""How large a plan may be: every part of it is asked about, drawn and checked, so no number of parts is without a limit."""

from __future__ import annotations

MAX_SUBGOALS = 100
"""The longest task of the suites has fewer than twenty."""
MAX_TARGETS = 100
MAX_ACTIONS = 500
"""Five for each subgoal, or a chunk of a learned policy."""

MAX_FUNCTIONS = 12
"""Helper functions that a trial keeps: four a plan, with three replans, is more than any task asks for."""


def size_problem(*, subgoals: int = 0, targets: int = 0, actions: int = 0, functions: int = 0) -> str:
    """What of a plan is too many, with its number and the limit; "" when nothing is."""
    held = (
        ("subgoals", subgoals, MAX_SUBGOALS),
        ("targets", targets, MAX_TARGETS),
        ("actions", actions, MAX_ACTIONS),
        ("helper functions", functions, MAX_FUNCTIONS),
    )
    return "; ".join(f"{number} {name}, at most {most} are allowed" for name, number, most in held if number > most)
