"""Asking a person on the terminal: whether a plan may run, and what only the user can settle."""

from __future__ import annotations

import getpass
import os
import re
import sys

import click

from wonderful_team.cli.output import say
from wonderful_team.cli.run_summary import shown_path
from wonderful_team.cli.wording import numbers_line
from wonderful_team.core.text import counted
from wonderful_team.core.values import AskUser
from wonderful_team.runtime import Approval, Declined, Proposal

TRIES = 3
"""How often an answer that is neither yes nor no is asked for again."""
_NO = re.compile(r"(?:n|no)\b[\s,;:.-]*(?:because\b)?[\s,;:.-]*(.*)", re.IGNORECASE | re.DOTALL)


def ask(proposal: Proposal) -> Approval | Declined:
    """Show the actions and the page, and ask."""
    actions, checks = counted(len(proposal.actions), "action"), counted(len(proposal.gate.checks), "check")
    say(f"The gate admits {actions} ({checks}) of plan {proposal.id[:12]}:", err=True)
    for number, planned in enumerate(proposal.actions, start=1):
        say(f"  {number}  {numbers_line(planned)}", err=True)
    if proposal.page is not None:
        say(f"page: {shown_path(proposal.page)}", err=True)
    for _ in range(TRIES):
        click.echo('Run this plan? [y / n / "n, because ..." for one new plan] ', nl=False, err=True)
        try:
            answer = input().strip()
        except (EOFError, OSError, RuntimeError, UnicodeError):  # at its end, gone, closed, or no text
            say("no answer: declined", err=True)
            return proposal.decline(who())
        if answer.lower() in ("y", "yes"):
            return proposal.approve(who())
        no = _NO.fullmatch(answer or "n")
        if no is not None:
            return proposal.decline(who(), no[1].strip())
        say(f"{answer[:40]!r} is neither yes nor no", err=True)
    return proposal.decline(who())


def user_to_ask(as_json: bool) -> AskUser | None:
    """Who answers what neither picture nor instruction settles: the person at the terminal, or nobody."""
    return answer if not as_json and _is_terminal(sys.stdin) and _is_terminal(sys.stderr) else None


def answer(question: str, choices: tuple[str, ...]) -> str | None:
    """Show a planner's question with its choices, and read the answer: a choice's number or words; None for no answer."""
    say(f"A question before the plan: {question}", err=True)
    for number, choice in enumerate(choices, start=1):
        say(f"  {number}  {choice}", err=True)
    wanted = "a number or your own words" if choices else "your own words"
    click.echo(f"Your answer [{wanted}; Enter ends here] ", nl=False, err=True)
    try:
        words = input().strip()
    except (EOFError, OSError, RuntimeError, UnicodeError):  # at its end, gone, closed, or no text
        say("no answer", err=True)
        return None
    if words.isdecimal() and 1 <= int(words) <= len(choices):
        return choices[int(words) - 1]
    return words or None


def _is_terminal(stream: object) -> bool:
    try:
        return bool(stream.isatty())  # type: ignore[attr-defined]
    except (AttributeError, OSError, ValueError):  # none, gone, or closed
        return False


def who() -> str:
    """The user's name; a container may know its number alone."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return f"user {os.getuid()}"
