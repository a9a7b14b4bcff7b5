"""Memory: keeps what later agents need of another agent's answer, or nothing.

Source of the role: Wang, Shen & Stadie 2024, arXiv:2407.19094; the words are ours.
"""

from __future__ import annotations

from wonderful_team.agents.common import ANSWER, DATA, INSTRUCTION, system_words
from wonderful_team.agents.rendering import fenced, listed, words
from wonderful_team.agents.role import Ask, role
from wonderful_team.contracts import Remember
from wonderful_team.core.values import Part

SYSTEM = system_words(
    """
You are the Memory of a team that plans for a robot. You read what one agent was asked and what it answered, and keep
what agents that come later need to know and cannot see for themselves.

You judge only what is worth keeping. Do not correct the answer, do not add to it and do not plan.
""",
    DATA + "\n" + INSTRUCTION,
    ANSWER,
)

REMEMBER = """
Decide whether something in the answer is worth keeping.
- Keep what decides later work: which thing is meant among look-alikes, what the user answered, why the plan is as it is,
  an order or angle that must be held, something that is absent, blocked or was tried without success.
- Leave out coordinates, boxes, routine approvals, and what the plan or the known entries already say.
- keep true: a short key of a few words, and a summary of one or two sentences that can be understood on its own. To
  replace a known entry, use its key again.
- keep false: key and summary are empty.
"""


def _render_remember(question: Remember) -> list[Part]:
    return [
        *words("The user's instruction:", fenced("instruction", question.instruction)),
        *words(f"Agent: {question.role}"),
        *words("What it was asked:", fenced("asked", question.asked)),
        *words("What it answered:", fenced("answered", question.answered)),
        *listed("Keys that are already known", question.known, "none"),
    ]


MEMORY = role("memory", SYSTEM, Ask(Remember, REMEMBER, _render_remember))
