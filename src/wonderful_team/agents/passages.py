"""Passages of the words that are sent with some requests only: what a model is told fits what it is asked and shown.

In a prompt file such a passage stands between `{% if NAME %}` and `{% endif %}` (Jinja; `not`, `and`, `or` and
`{% else %}` work too). The names are those of PASSAGES; nothing else of a request can be read there.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache, lru_cache
from types import MappingProxyType
from typing import Any

from jinja2 import Template, TemplateError, TemplateSyntaxError, meta, nodes
from jinja2.sandbox import ImmutableSandboxedEnvironment

from wonderful_team.contracts import JudgeBoxes, Question, ReviewPlan
from wonderful_team.core.actions import OpenStep
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Part, Target, Words
from wonderful_team.errors import ConfigError

PUSHES = {"push_start", "push_end"}


def _targets(question: Any) -> Sequence[Target]:
    """The targets that a question is about; () where they are not known yet, or it is about other things."""
    if isinstance(question, JudgeBoxes):
        return [box.target for box in question.boxes]
    own = getattr(question, "target", None)
    return [own] if isinstance(own, Target) else getattr(question, "targets", ())


def _uses(question: Any) -> set[str]:
    """What points are asked for or judged."""
    if isinstance(question, JudgeBoxes):
        return {use for box in question.boxes for use in box.uses}
    if hasattr(question, "role"):
        return {question.role}
    if hasattr(question, "uses"):
        return set(question.uses)
    return {role for target in _targets(question) for role in target.roles}


def _examples(question: Any) -> bool:
    if isinstance(question, JudgeBoxes):
        return any(_examples(box) for box in question.boxes)
    task = getattr(question, "task", None)
    slots = getattr(question, "slots", ()) if task is None else task.slots
    return bool(slots or getattr(question, "examples", ()) or getattr(question, "goal", None) is not None)


def _whole(question: Any) -> bool:
    if isinstance(question, JudgeBoxes):
        return any(_whole(box) for box in question.boxes)
    return getattr(question, "whole", None) is not None


def _can(question: Any, kind: str) -> bool:
    """The robot has this kind of step, as far as the question knows."""
    return kind in (getattr(question, "step_kinds", ()) or (kind,))


_CONDITIONS: dict[str, Callable[[Any], bool]] = {
    "examples": _examples,
    "listing": lambda question: getattr(question, "with_targets", True),
    "can_push": lambda question: _can(question, "push"),
    "can_follow": lambda question: _can(question, "follow"),
    "plan_too": lambda question: not getattr(question, "plan_checked", True),
    "carries": lambda question: any(isinstance(step, OpenStep) for step in getattr(question, "steps", ())),
    "several": lambda question: getattr(question, "count", 1) > 1,
    "centre": lambda question: getattr(question, "purpose", "centre") == "centre",
    "picked": lambda question: bool(_uses(question) & {"pick", "grasp"}),
    "placed": lambda question: "place" in _uses(question),
    "pushed": lambda question: bool(_uses(question) & PUSHES),
    "areas": lambda question: any(target.kind == "area" for target in _targets(question)),
    "parts": lambda question: any(target.part for target in _targets(question)),
    "rejected": lambda question: bool(getattr(question, "rejected", ())),
    "fine": lambda question: getattr(question, "fine", False),
    "whole": _whole,
}
PASSAGES: Mapping[str, str] = MappingProxyType(
    {
        "marks": "marks were drawn over pictures",
        "names": "words name a picture in braces",
        "positions": "pixels are counted in what is said or answered, and no line of the request says how",
        "examples": "pictures of the instruction are shown",
        "listing": "targets are listed with the plan",
        "can_push": "the robot pushes things",
        "can_follow": "the robot follows the paths of helper functions",
        "plan_too": "the plan is checked together with its steps",
        "carries": "a gripper carries things, by steps of its own",
        "several": "more than one point may be given",
        "centre": "the middle of a target is wanted, else a place",
        "picked": "a point to pick or grasp is asked for or judged",
        "placed": "a point to put something at is asked for or judged",
        "pushed": "a point to push from or to is asked for or judged",
        "areas": "a target is an area",
        "parts": "a part of a target is named",
        "rejected": "points are marked that were wrong",
        "fine": "it is the second round of points, or of turns",
        "whole": "the whole view is shown beside a crop",
    }
)
"""What a passage may depend on: its name, and when it holds."""

_READ = (nodes.Output, nodes.TemplateData, nodes.If, nodes.Name, nodes.Not, nodes.And, nodes.Or)
_NAME = re.compile(r"\{\w+\}")

# Marks of Jinja that nobody needs here are ones that no text holds by chance.
_ENVIRONMENT = ImmutableSandboxedEnvironment(
    trim_blocks=True,
    lstrip_blocks=True,
    autoescape=False,
    variable_start_string="<%=",
    variable_end_string="%=>",
    comment_start_string="<%#",
    comment_end_string="%#>",
)


@cache
def _compiled(text: str) -> Template:
    check("of a record, or a role's own", text)  # files were checked when they were read
    return _ENVIRONMENT.from_string(text)


def fill(texts: Sequence[str], question: Question, parts: Sequence[Part]) -> tuple[str, ...]:
    """Texts with the passages that hold for this question, which is shown as these parts."""
    held = {name: holds(question) for name, holds in _CONDITIONS.items()}
    # ReviewPlan begins like ReviewSteps: services give a discount for a beginning that they have seen.
    marked = any(isinstance(part, Picture) and part.marks for part in parts)
    held["marks"] = marked or isinstance(question, ReviewPlan)
    # A request that asks for positions says itself how they are counted, in the model's unit.
    said = any(isinstance(part, Words) and part.says == "positions" for part in parts)
    held["positions"] = not said and not question.any_size
    held["names"] = any(isinstance(part, Words) and _NAME.search(part.text) for part in parts)
    return tuple(_filled(text, frozenset(name for name in held if held[name])) for text in texts)


@lru_cache(maxsize=512)
def _filled(text: str, held: frozenset[str]) -> str:
    if "{%" not in text:
        return text
    return re.sub(r"\n{3,}", "\n\n", _compiled(text).render({name: name in held for name in PASSAGES})).strip()


def check(name: str, text: str) -> None:
    """Whether the passages of a prompt file can be read.

    Raises:
        ConfigError: They cannot, or depend on something unknown.
    """
    try:
        read = _ENVIRONMENT.parse(text)
    except TemplateError as error:
        line = f" (line {error.lineno})" if isinstance(error, TemplateSyntaxError) else ""
        raise ConfigError(
            f"prompt file {name!r}{line}: {error}; a passage stands between {{% if NAME %}} and {{% endif %}}"
        ) from error
    others = [node.lineno for node in read.find_all(nodes.Node) if not isinstance(node, _READ)]
    if others:
        raise ConfigError(
            f"prompt file {name!r} (line {others[0]}): a passage may depend on names, with not, and, or; nothing else is read"
        )
    unknown = meta.find_undeclared_variables(read) - set(PASSAGES)
    if unknown:
        raise ConfigError(
            f"prompt file {name!r}: a passage depends on {', '.join(sorted(unknown))}; known are {', '.join(PASSAGES)}"
        )
