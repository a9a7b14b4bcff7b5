"""The grounding of one target on its way: what is known, what was rejected, and its story so far."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import ReadScene, SceneReading, ShownSlot, Strip, WrongPoint
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, BoxMark, Picture, Point, PointMark
from wonderful_team.core.together import batches, together
from wonderful_team.core.values import Answer, GroundedTarget, GroundingEvent, PointRole, Provenance, Target
from wonderful_team.images import crop, edge_strips
from wonderful_team.planning.session import AgentSession

ENDS: tuple[PointRole, ...] = ("push_end", "place")
"""Uses of what something is brought to."""
Fate: TypeAlias = Literal["found", "absent", "gave_up"]


@dataclass(frozen=True)
class Rejected:
    """A point of the view that was wrong [view px], and what was said of it."""

    point: Point
    why: str


@dataclass
class Job:
    """The grounding of one target: what is known, and its story so far.

    Attributes:
        number: Place of the target among all, which orders what Memory keeps.
        goal: Id of the target that this one is pushed to; None when it is not pushed.
        accepted: Targets whose boxes the Checker accepted [view px], by id; shared by the jobs of one plan.
        avoid: Points that were tried and rejected, and why.
        problem: What the Checker last found wrong with the box; "" while nothing was.
        wrong_points: What it found wrong with the points that were chosen together with the box.
        towards: Where this target is pushed to [view px], once it is known.
        judged: The Checker's first word, where it was asked about several boxes at once.
        first_box, first_points: What was read with all other targets (`lean`) [view px].
        unsure: Why it was not clear which thing is meant; "" where it was.
        outlined: A helper function computes a path from its box: an area too needs one then.
    """

    session: AgentSession
    scene: SceneShown
    target: Target
    number: int
    plan: tuple[str, ...]
    examples: tuple[ShownSlot, ...]
    goal: str | None = None
    accepted: dict[str, tuple[Target, Box]] = field(default_factory=dict)
    history: list[GroundingEvent] = field(default_factory=list)
    avoid: list[Rejected] = field(default_factory=list)
    problem: str = ""
    wrong_points: tuple[WrongPoint, ...] = ()
    towards: Point | None = None
    judged: Answer | None = None
    first_box: Box | None = None
    first_points: dict[PointRole, Point] = field(default_factory=dict)
    unsure: str = ""
    outlined: bool = False

    @property
    def instruction(self) -> str:
        """What the user wants, in words."""
        return self.scene.instruction.text

    @property
    def view_box(self) -> Box:
        return Box(0, 0, *self.scene.view.size_px)

    def reject(self, points: Iterable[Point], why: str) -> None:
        """These points [view px] were wrong: the Manager is shown them, and told why, when it looks again."""
        self.avoid += [Rejected(point, why) for point in points]

    def with_rejected(self, picture: Picture) -> tuple[Picture, tuple[str, ...]]:
        """A picture with the rejected points that it shows marked on it, and what was said of each, by its label."""
        at = [(picture.frame.point_to_picture(item.point), item.why) for item in self.avoid]
        shown = [(point, why) for point, why in at if picture.frame.valid.contains(point)]
        labels = ["rejected"] if len(shown) == 1 else [f"rejected {number}" for number in range(1, len(shown) + 1)]
        marks = [PointMark(point, label) for label, (point, _) in zip(labels, shown, strict=True)]
        return picture.marked(*marks), tuple(f"{label}: {why}" for label, (_, why) in zip(labels, shown, strict=True))

    def tell(
        self,
        what: str,
        text: str,
        box: Box | None = None,
        points: tuple[Point, ...] = (),
        provenance: Provenance = "model",
    ) -> None:
        """Add a line to the target's story; coordinates are view pixels."""
        self.history.append(GroundingEvent(what, text, box, points, provenance))

    def crop_with(self, name: str, window: Box, box: Box, style: Literal["target", "before", "after"]) -> Picture:
        """A crop round `window` with `box` marked on it (both view pixels).

        Its axes are labelled in the whole view's pixels, so that it can be found there.
        """
        picture = crop(self.scene.view, window, name)
        return picture.marked(self.view_axes, BoxMark(picture.frame.box_to_picture(box), style))

    @property
    def view_axes(self) -> Axes:
        """Axes of a crop, labelled in pixels of the whole view as it is shown."""
        return Axes(self.scene.views[0].frame)

    def strips(self, box: Box) -> tuple[Strip, ...]:
        return tuple(Strip(edge, side, cut) for (edge, side), cut in edge_strips(self.scene.view, box).items())

    def end(self, status: Fate, box: Box | None, points: Mapping[PointRole, Point] | None = None) -> GroundedTarget:
        """How the target was grounded in the end; box and points are view pixels."""
        chosen: dict[str, Point] = {role: point for role, point in (points or {}).items()}
        return GroundedTarget(self.target, status, self.scene.view.id, box, chosen, tuple(self.history))


async def read_scene(jobs: Sequence[Job]) -> tuple[SceneReading, Provenance]:
    """Boxes and points of all targets, in one answer where they are not too many for it."""
    parts = list(batches(jobs, jobs[0].session.config.bounds.targets))
    read = await together([_read_some(part) for part in parts])
    targets = [target for reading, _ in read for target in reading.targets]
    reasoning = " ".join(reading.reasoning for reading, _ in read)
    return SceneReading(reasoning=reasoning, targets=targets), read[0][1]


async def _read_some(jobs: Sequence[Job]) -> tuple[SceneReading, Provenance]:
    session, scene = jobs[0].session, jobs[0].scene
    targets = tuple(job.target for job in jobs)
    view = scene.labelled if session.config.axes else scene.views[0]
    # Where all targets are plain, the main view alone is enough to find them in.
    plain = session.config.sparing and not any(target.where or target.part for target in targets)
    context = () if plain else scene.views[1:]
    examples = scene.examples(targets, session.config.axes)
    question = ReadScene(targets, jobs[0].plan, view, context, examples, jobs[0].instruction)
    answer = await session.ask_whole(question, stage="ground")
    return answer.value, answer.provenance
