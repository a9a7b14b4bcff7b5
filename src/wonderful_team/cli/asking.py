"""Asking a person on the terminal whether a plan may run."""

from __future__ import annotations

import getpass
import os
import re

import click

from wonderful_team.cli.output import say
from wonderful_team.cli.run_summary import shown_path
from wonderful_team.cli.wording import numbers_line
from wonderful_team.core.text import counted
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


def who() -> str:
    """The user's name; a container may know its number alone."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return f"user {os.getuid()}"
