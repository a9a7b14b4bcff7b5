"""What a role keeps in its notebook of its own answers: a sentence in one line, or nothing.

Nothing that the next question shows anyway is kept (plans, doubts with their answers, boxes, earlier revisions), no
approval, no coordinates: positions are shown, and would be stale as soon as a box is corrected.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from wonderful_team.agents import step_words
from wonderful_team.contracts import (
    ChooseMark,
    JudgeOutcome,
    JudgeSubgoal,
    Question,
    ReadScene,
    Replan,
    RevisePlan,
    WriteSteps,
)
from wonderful_team.core.actions import Step

LONGEST = 300
"""Characters of a note."""
_NUMBER = r"[-+]?\d+(?:\.\d+)?"
_COORDINATES = re.compile(
    rf"\s*[(\[]\s*{_NUMBER}(?:\s*(?:px)?\s*[,;x]\s*{_NUMBER})+\s*(?:px)?\s*[)\]]"
    rf"|\s*\b[xy]\d?\s*[=:]\s*{_NUMBER}(?:\s*px)?|\s*\b{_NUMBER}\s*(?:px|pixels?)\b"
)


def one_line(text: str) -> str:
    """Words of a model as one line without coordinates, at most LONGEST characters."""
    line = re.sub(r"\s+", " ", _COORDINATES.sub("", text)).strip()
    return line if len(line) <= LONGEST else line[:LONGEST].rsplit(" ", 1)[0] + " …"


def steps_note(steps: tuple[Step, ...]) -> str:
    """The steps as they were last written: a doubt about them is answered by someone who knows them."""
    return one_line("The steps so far: " + "; ".join(f"{k}. {step_words(step)}" for k, step in enumerate(steps, 1)))


def note_of(question: Question, answer: Any) -> str:
    """What the role that answered keeps of it; "" for nothing."""
    keep = _NOTES.get(type(question))
    return one_line(keep(question, answer)) if keep is not None else ""


def _revised(question: RevisePlan, answer: Any) -> str:
    what = "changed the plan" if answer.plan is not None else "kept the plan"
    return f"On the doubt '{question.doubt.question}' you {what}: {answer.answer}"


def _chosen(question: ChooseMark, answer: Any) -> str:
    return "" if answer.number is not None else f"None of the points proposed for '{question.target.words}' was on it."


def _read(question: ReadScene, answer: Any) -> str:
    words = {target.id: target.words for target in question.targets}
    missing = [words[item.id] for item in answer.targets if not item.found]
    return f"You did not see in the picture: {'; '.join(missing)}." if missing else ""


def _judged(_: JudgeOutcome, answer: Any) -> str:
    said = [f"{v.subgoal} {v.status.replace('_', ' ')}" + (f" ({v.cause})" if v.cause else "") for v in answer.verdicts]
    return f"After an attempt: {'; '.join(said)}."


def _checked(question: JudgeSubgoal, answer: Any) -> str:
    return f"{question.subgoal.id}: the plan was stopped: {answer.stop}" if answer.stop else ""


def _advised(_: Replan, answer: Any) -> str:
    return f"You advised: {answer.advice}" if answer.advice else ""


_NOTES: dict[type[Question], Callable[[Any, Any], str]] = {
    RevisePlan: _revised,
    WriteSteps: lambda _, answer: steps_note(answer.to_steps()),
    ChooseMark: _chosen,
    ReadScene: _read,
    JudgeSubgoal: _checked,
    JudgeOutcome: _judged,
    Replan: _advised,
}
"""The kinds of question of which anything is kept."""
