"""One question of the suite `annotations`: put with an annotation or without, on the same toy table, and scored in code."""

from __future__ import annotations

import math
from typing import Any

from wonderful_team.api.photo_trial import Looking, point_marks
from wonderful_team.core.pictures import BoxMark, Point
from wonderful_team.errors import ConfigError
from wonderful_team.evals.toy import ANNOTATION, ANNOTATIONS, score_point, score_turn, score_word
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialSpec
from wonderful_team.images import whole
from wonderful_team.lab.annotations import ANSWERS_DEG, TurnTable, box_to_judge, change_to_judge, crop_window
from wonderful_team.lab.toy import RADIUS_PX, ToyTable


def run_annotation(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Ask a method one question.

    Raises:
        ConfigError: A method that puts no such question, or a task that there is not.
    """
    asked = ASKED.get(spec.task)
    if asked is None:
        raise ConfigError(f"task {spec.task!r}: valid are {', '.join(ANNOTATIONS)}")
    table = TurnTable(spec.seed) if asked is _turn else ToyTable(spec.seed)
    words = table.words if isinstance(table, TurnTable) else table.target.words
    with Looking(spec, settings, [words], table) as looking:
        return looking.row(lambda: asked(looking, table))


def _ask(looking: Looking, question: str, *given: Any) -> Any:
    put = looking.offered(f"{question}(...)", "the suite annotations is for the methods annotated and bare")
    return looking.wait_for(put(*given))


def _axes(looking: Looking, table: ToyTable) -> TrialRow:
    return _pointed(looking, table, _ask(looking, "point", table.view, table.target.words))


def _crop(looking: Looking, table: ToyTable) -> TrialRow:
    return _pointed(looking, table, _ask(looking, "point", table.view, table.target.words, crop_window(table)))


def _pointed(looking: Looking, table: ToyTable, said: Point | None) -> TrialRow:
    row = score_point(said, table.target.centre, RADIUS_PX)
    looking.show(whole(table.view, "toy table"), *point_marks(said, table.target.centre, RADIUS_PX))
    return row


def _verdict(looking: Looking, table: ToyTable) -> TrialRow:
    box, right = box_to_judge(table)
    row = score_word(_ask(looking, "verdict", table.view, table.target.words, box), right)
    looking.show(
        whole(table.view, "toy table"), BoxMark(table.target.box, "after", "true"), BoxMark(box, "target", "judged")
    )
    return row


def _turn(looking: Looking, table: TurnTable) -> TrialRow:
    said = _ask(looking, "turn", table.view, table.box, table.goal, table.goal_at, ANSWERS_DEG, table.words)
    looking.show(whole(table.view, "toy table"), *turn_marks(table, said))
    return score_turn(said, table.turn_deg)


def turn_marks(table: TurnTable, said_deg: float | None) -> tuple[BoxMark, ...]:
    """The block with what was said of it."""
    said = "no angle" if said_deg is None else f"{math.remainder(said_deg, 360):g} deg said"
    return (BoxMark(table.box, "target", f"{said}, right {math.remainder(table.turn_deg, 360):g}"),)


def _revision(looking: Looking, table: ToyTable) -> TrialRow:
    before, after, right = change_to_judge(table)
    row = score_word(_ask(looking, "revision", table.view, table.target.words, before, after), right)
    looking.show(whole(table.view, "toy table"), BoxMark(before, "before", "before"), BoxMark(after, "after", "after"))
    return row


ASKED: dict[str, Any] = {
    f"{ANNOTATION}axes": _axes,
    f"{ANNOTATION}crop": _crop,
    f"{ANNOTATION}crop_verdict": _verdict,
    f"{ANNOTATION}strips": _turn,
    f"{ANNOTATION}before_after": _revision,
}
"""Who asks what, by task."""
