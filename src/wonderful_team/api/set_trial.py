"""One question about a picture of the user's own in the suites `pointing` and `boxcheck`."""

from __future__ import annotations

from wonderful_team.api.observation import Observation
from wonderful_team.api.photo_trial import Looking, middle_of
from wonderful_team.core.pictures import BoxMark, PointMark
from wonderful_team.evals.photos import SET
from wonderful_team.evals.pointing_sets import boxes_of, scenes_of, score_place
from wonderful_team.evals.toy import score_verdict
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialSpec
from wonderful_team.images import whole
from wonderful_team.lab.toy import RIGHT, BoxKind, judged_request


def run_set(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    """Ask a method one question.

    Raises:
        ConfigError: A method that answers no such question, or a set whose files are not what they should be.
    """
    if spec.task.startswith(f"{SET}boxcheck/"):
        return _judged(spec, settings)
    scene = scenes_of(spec.task)[spec.seed]
    seen = Observation.from_files(scene.picture)
    right = scene.right(seen.main.size_px)
    with Looking(spec, settings, [scene.words]) as looking:

        def pointed() -> TrialRow:
            if looking.config is not None:
                (item,) = looking.by_team(seen, scene.kind)
                point = middle_of(item)
            else:
                (place,) = looking.by_own(seen)
                point = place.point or (None if place.box is None else place.box.centre)
            true = [] if scene.box is None else [BoxMark(scene.box, "after", "true")]
            said = [] if point is None else [PointMark(point, "said")]
            looking.show(whole(seen.main, "picture"), *true, *said)
            return score_place(point, right)

        return looking.row(pointed)


def _judged(spec: TrialSpec, settings: RunSettings) -> TrialRow:
    one = boxes_of(spec.task)[spec.seed]
    kind: BoxKind = next(kind for kind in RIGHT if f"boxcheck/{kind}/" in spec.task)
    seen = Observation.from_files(one.scene.picture)
    with Looking(spec, settings, [one.scene.words]) as looking:

        def judged() -> TrialRow:
            true = [] if one.scene.box is None else [BoxMark(one.scene.box, "after", "true")]
            looking.show(whole(seen.main, "picture"), *true, BoxMark(one.box, "target", "judged"))
            if looking.config is not None:
                request = judged_request(seen.main, one.scene.words, one.box)
                said = str(looking.wait_for(looking.client.ask(request)).value.decision)
            else:
                judge = looking.offered("judge(observation, words, box)", "accept, revise or reject, as point says")
                said = str(looking.wait_for(judge(seen, one.scene.words, one.box)))
            return score_verdict(said, RIGHT[kind])

        return looking.row(judged)
