"""A question becomes a request: the role's words, the question rendered into words and pictures, the notes."""

from __future__ import annotations

from wonderful_team.agents.passages import fill
from wonderful_team.agents.prompts import ROLES, Prompts
from wonderful_team.agents.rendering import note_parts
from wonderful_team.agents.repeats import without_repeats
from wonderful_team.agents.role import Role
from wonderful_team.contracts import Question
from wonderful_team.core.values import Note, Part, Request, Words
from wonderful_team.errors import ConfigError, UnknownNameError


def build_request(
    question: Question,
    *,
    id: str,  # noqa: A002  the request's field has this name
    stage: str,
    role: Role | str | None = None,
    notes: tuple[Note, ...] = (),
    sample: int = 0,
    prompts: Prompts | None = None,
) -> Request:
    """Render a question as a request.

    The question's own content comes first, then the notes, then the words of the ask: requests of one role about one
    task so share a long prefix, and the ask stands next to the answer. A picture whose pixels another one shows is not sent.

    Args:
        question: What is asked; every field of it is shown, and nothing else.
        id: The request's id.
        stage: plan | ground | act | memory | replan | other.
        role: Who asks: a role of the team by name, a role of one's own, or None for the one that normally asks this kind of
            question. A role of one's own brings its own words.
        notes: The role's notebook and the system memory; shown as lines.
        sample: Number of this independent sample.
        prompts: Words of the team's roles; None for the built-in ones.

    Raises:
        ConfigError: No such role, or the role does not ask this kind of question.
    """
    asker = role_for(question, role)
    texts = prompts or Prompts.default() if ROLES.get(asker.name) is asker else Prompts.of(asker)
    ask = asker.asks[question.contract]
    shown = [*ask.render(question), *note_parts(notes)]
    system, asked = fill((texts.system(asker.name), texts.ask(asker.name, question.contract)), question, shown)
    parts: list[Part] = [*shown, Words(asked)]
    return Request(
        id=id,
        stage=stage,
        role=asker.name,
        question=question,
        parts=without_repeats(parts),
        output=question.output(),
        system=system,
        notes=notes,
        sample=sample,
    )


def role_for(question: Question, role: Role | str | None = None) -> Role:
    """The role that asks: the one that is meant, or the one that normally asks this kind of question."""
    if role is not None:
        if isinstance(role, str) and role not in ROLES:
            raise UnknownNameError("role", role, ROLES)
        asker = ROLES[role] if isinstance(role, str) else role
        if question.contract not in asker.asks:
            raise ConfigError(f"role {asker.name!r} does not ask {question.contract}; it asks {', '.join(asker.asks)}")
        return asker
    askers = [asker for asker in ROLES.values() if question.contract in asker.asks]
    if not askers:
        raise ConfigError(f"no role asks {question.contract}")
    # Both the Manager and, with grounding switched off, the Supervisor point; normally it is the Manager.
    return askers[-1]
