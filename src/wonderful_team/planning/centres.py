"""The Grounding Manager's proposals: several independent points and a choice among them."""

from __future__ import annotations

from typing import Literal

from wonderful_team.contracts import BoxAnswer, ChooseMark, GiveBox, LocatePoints, MarkChoice, Points
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Candidates, Point, PointMark
from wonderful_team.core.together import together
from wonderful_team.planning.jobs import Job
from wonderful_team.planning.spending import agree


async def propose(job: Job, purpose: Literal["centre", "place"]) -> list[Point]:
    """Independent proposals in view pixels; empty when most samples say that the target is not there."""
    view, said = job.with_rejected(job.scene.labelled)
    question = LocatePoints(
        job.target, purpose, job.plan, view, job.scene.views[1:], job.examples, 1, said, job.instruction
    )
    samples: list[Points] = await together(
        [
            job.session.ask(question, stage="ground", branch=job.target.id, sample=number)
            for number in range(job.session.config.bounds.samples)
        ]
    )
    found = [view.frame.point_to_view(point.as_tuple) for sample in samples for point in sample.points]
    if 2 * len(found) < len(samples):
        job.tell("absent", f"{len(samples) - len(found)} of {len(samples)} samples say it is not there")
        return []
    job.tell("centre" if purpose == "centre" else "point", f"{len(found)} proposals", points=tuple(found))
    return found


async def choose(job: Job, proposals: list[Point], purpose: Literal["centre", "place"]) -> Point | None:
    """The best of the proposals, in view pixels; None when none is on the target.

    In `lean` nobody is asked to choose among guesses that agree.
    """
    agreed = agree(proposals, job.first_box, job.scene.view.size_px)
    if agreed is not None and job.session.config.sparing:
        job.session.skip("ChooseMark", "the guesses agree", job.target.id)
        job.tell("chosen", f"{len(proposals)} proposals agree", points=(agreed,))
        return agreed
    view = job.scene.labelled
    marked = view.marked(Candidates(tuple(view.frame.point_to_picture(point) for point in proposals)))
    choice: MarkChoice = await job.session.ask(
        ChooseMark(job.target, purpose, job.plan, marked, job.examples, job.instruction),
        stage="ground",
        branch=job.target.id,
    )
    if choice.number is None:
        job.tell("chosen", "no proposal is on the target", points=tuple(proposals))
        return None
    if agreed is None:
        job.unsure = choice.reasoning or "the guesses lay apart"
    job.tell("chosen", f"proposal {choice.number} chosen", points=(proposals[choice.number - 1],))
    return proposals[choice.number - 1]


async def give_box(job: Job, centre: Point) -> Box | None:
    """A first box round a centre, in view pixels; None when the Manager finds nothing there."""
    view, said = job.with_rejected(job.scene.labelled)
    # Without a label: on a small thing it would hide the edges that are asked for.
    marked = view.marked(PointMark(view.frame.point_to_picture(centre)))
    answer = await job.session.ask_whole(
        GiveBox(job.target, job.plan, marked, job.examples, said, job.instruction), stage="ground", branch=job.target.id
    )
    given: BoxAnswer = answer.value
    if given.box is None:
        job.tell("absent", "no box: the Manager finds nothing at this centre", points=(centre,))
        return None
    box = view.frame.box_to_view(given.box.as_box)
    job.tell("box", "Manager's first box", box, (centre,), provenance=answer.provenance)
    return box
