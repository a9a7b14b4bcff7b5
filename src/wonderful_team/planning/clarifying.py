"""A question that only the user can settle: asked, its answer told to everyone and to Memory, and planning goes on."""

from __future__ import annotations

import inspect
from typing import Any

from wonderful_team.core.interrupts import in_thread
from wonderful_team.core.values import AskUser, Clarification
from wonderful_team.core.values.clarification import asked_words
from wonderful_team.errors import ConfigError, MethodCodeError, NeedsClarification, code_of
from wonderful_team.planning.session import AgentSession

LONGEST_ANSWER = 1000
"""Most characters of an answer that are used; what comes after them is left out, with a warning."""
CALLBACK = "ask(question, choices)"


async def clarify(
    session: AgentSession, ask: AskUser | None, open_question: NeedsClarification, said: tuple[str, ...]
) -> Clarification:
    """What the user answered.

    Args:
        session: Whose planning stopped.
        ask: Who asks the user; None where nobody can be asked.
        open_question: What stopped it.
        said: What the user said before: a question that was answered is not asked again.

    Raises:
        NeedsClarification: The same: nobody can be asked, nobody answered, or it was answered before.
        MethodCodeError, ConfigError: The user's function raised, or gave no words.
    """
    question, choices = open_question.question, open_question.choices
    if ask is None or any(asked_words(question, choices) in line for line in said):
        raise open_question
    # What Memory is still writing comes first: nothing else happens while a person thinks.
    await session.memory.barrier()
    with code_of(CALLBACK, MethodCodeError):
        answer: Any = await _called(ask, question, choices)
    if answer is not None and not isinstance(answer, str):
        raise ConfigError(f"{CALLBACK} gave a {type(answer).__name__}; valid: the user's words, or None for no answer")
    words = " ".join((answer or "").split())
    if not words:
        raise open_question
    if len(words) > LONGEST_ANSWER:
        session.warn(f"the answer has {len(words)} characters; the first {LONGEST_ANSWER} are used")
        words = words[:LONGEST_ANSWER]
    settled = Clarification(question, choices, words)
    session.client.tell("clarified", question, settled)
    session.stage("clarified", settled.words)
    session.remember("user", "plan", f"The instruction left open: {asked_words(question, choices)}", words)
    return settled


async def _called(ask: AskUser, question: str, choices: tuple[str, ...]) -> Any:
    if inspect.iscoroutinefunction(ask):
        return await ask(question, choices)
    return await in_thread(ask, question, choices, name="ask")
