"""One question about the toy table in a study: where the circle is, or whether a box is good."""

from __future__ import annotations

from wonderful_team.api.annotation_trial import run_annotation
from wonderful_team.api.photo_trial import Looking, middle_of, point_marks
from wonderful_team.core.pictures import BoxMark, Point
from wonderful_team.core.values import GroundedTarget
from wonderful_team.errors import ConfigError
from wonderful_team.evals.toy import ANNOTATION, BOXCHECK, score_point, score_verdict
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialSpec
from wonderful_team.images import whole
from wonderful_team.lab.toy import BOX_KINDS, RADIUS_PX, RIGHT, BoxKind, ToyTable, checker_request


def run_toy(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Ask a method one question about a toy table.

    Raises:
        ConfigError: A method that answers no such question, or a task that there is not.
    """
    if spec.task.startswith(ANNOTATION):
        return run_annotation(spec, settings)
    table = ToyTable(spec.seed)
    with Looking(spec, settings, [table.target.words], table) as looking:
        if spec.task.startswith(BOXCHECK):
            kind = _kind(spec.task)
            return looking.row(lambda: score_verdict(_verdict(looking, table, kind), RIGHT[kind]))
        return looking.row(lambda: _pointed(looking, table))


def _verdict(looking: Looking, table: ToyTable, kind: BoxKind) -> str:
    """What is said of a box of that kind."""
    box = table.box(kind)
    looking.show(
        whole(table.view, "toy table"), BoxMark(table.target.box, "after", "true"), BoxMark(box, "target", "judged")
    )
    if looking.config is not None:
        return str(looking.wait_for(looking.client.ask(checker_request(table, box))).value.decision)
    judge = looking.offered("judge(observation, words, box)", "accept, revise or reject, as point and point:axes say")
    return str(looking.wait_for(judge(table.observe(), table.target.words, box)))


def _pointed(looking: Looking, table: ToyTable) -> TrialRow:
    """How far off the circle's middle is said to be."""
    if looking.config is not None:
        (item,) = looking.by_team(table.observe())
        point, rounds = middle_of(item), _rounds(item)
    else:
        (place,) = looking.by_own(table.observe())
        point, rounds = place.point or (None if place.box is None else place.box.centre), []
    looking.show(whole(table.view, "toy table"), *point_marks(point, table.target.centre, RADIUS_PX))
    return score_point(point, table.target.centre, RADIUS_PX, rounds)


def _kind(task: str) -> BoxKind:
    kind = task.removeprefix(BOXCHECK)
    if kind not in BOX_KINDS:
        raise ConfigError(f"task {task!r}: valid are {', '.join(BOXCHECK + one for one in BOX_KINDS)}")
    return kind


def _rounds(item: GroundedTarget | None) -> list[Point]:
    """The middles of the boxes as they became: first as it was given, then after every change of the Mover that was kept."""
    boxes = [] if item is None else [event.box for event in item.history if event.box is not None]
    middles: list[Point] = []
    for box in boxes:
        if not middles or middles[-1] != box.centre:
            middles.append(box.centre)
    return middles
