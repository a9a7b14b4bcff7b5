"""`annotated` and `bare`: one question about a picture, with what the team draws or cuts out, and the same question without.

For the suite `annotations`: what do labelled axes, crops, strips of turned cut-outs and a picture of before buy, each by itself? Both ask in
the same words; only the pictures and the lines that announce them differ. They plan nothing.

Source of what is drawn: Wang, Shen & Stadie 2024, arXiv:2407.19094, Algorithm 2 and Appendix F; the strips are ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

from wonderful_team.agents.common import ANSWER, DATA, MARKED_OR_NOT, system_words
from wonderful_team.agents.rendering import answer_in, picture_parts, target_words, words
from wonderful_team.agents.role import Ask, Role, role
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import (
    BoxVerdict,
    JudgeBox,
    JudgeRevision,
    LocatePoints,
    Points,
    ReadTurn,
    RevisionVerdict,
    TurnChoice,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, BoxMark, Picture, Point, Tiles
from wonderful_team.core.values import Part, Plan, Target, View
from wonderful_team.errors import ConfigError
from wonderful_team.images import crop, whole
from wonderful_team.images.turned import Shown, reach_px, turn_strip
from wonderful_team.models.client import ModelClient
from wonderful_team.planning.baselines.open_loop import OpenLoop

Value = TypeVar("Value")
SYSTEM = system_words(
    "You look at pictures for a robot and answer one question about what they show.", MARKED_OR_NOT, DATA, ANSWER
)
POINT = "Give one point: the middle of the target. If it is not in the picture, say so; do not guess."
JUDGE = """
Judge the box that is drawn on the picture.
- accept: it holds the whole target without much space around it.
- revise: it holds at least a part of the target, but has to be placed better. Say in problem what should change.
- reject: it does not even touch the target. Say in problem what is in the box instead.
"""
TURN = """
The thing is to lie as the goal shows it. By how many degrees, clockwise, does it have to be turned from how it lies now? Give the number of the
answer in the list that is nearest.
"""
REVISION = """
The box of the target was changed. Compare the box after the change with the one before.
- keep_before: the change made it worse, or no better.
- take_after_go_on: it is better, and still not tight.
- take_after_stop: it holds the whole target without much space around it.
"""


def _render_point(question: LocatePoints) -> list[Part]:
    return [*picture_parts(question.view), *_target(question.target), *answer_in(question.view)]


def _render_box(question: JudgeBox) -> list[Part]:
    return [*picture_parts(question.crop), *_target(question.target)]


def _render_turn(question: ReadTurn) -> list[Part]:
    turned = any(isinstance(mark, Tiles) for mark in question.strip.marks)
    about = (
        "the goal, and the thing turned by each answer, numbered"
        if turned
        else "the goal, and the thing as it lies now"
    )
    answers = "; ".join(f"{number} is {turn:g} degrees" for number, turn in enumerate(question.turns, start=1))
    return [*picture_parts(question.strip, about), *_target(question.target), *words(f"Answers: {answers}.")]


def _render_revision(question: JudgeRevision) -> list[Part]:
    before = [] if question.before is None else picture_parts(question.before, "before the change")
    return [*before, *picture_parts(question.after, "after the change"), *_target(question.target)]


def _target(target: Target) -> list[Part]:
    return words(f"Target {target_words(target)}")


VIEWER: Role = role(
    "viewer", SYSTEM, Ask(LocatePoints, POINT, _render_point), Ask(JudgeBox, JUDGE, _render_box), Ask(ReadTurn, TURN, _render_turn),
    Ask(JudgeRevision, REVISION, _render_revision), grounds=True,
)  # fmt: skip


class ShownWith(OpenLoop):
    """Asks one question with or without an annotation; everything is given and answered in pixels of the view.

    Args:
        client: Where the model is asked.
        annotated: With what the team draws or cuts out.
    """

    def __init__(self, client: ModelClient, *, annotated: bool) -> None:
        super().__init__(client, "annotated" if annotated else "bare", VIEWER)
        self._annotated = annotated

    async def make_plan(self, scene: SceneShown, start: Plan, advice: tuple[str, ...]) -> Plan:
        """It has none.

        Raises:
            ConfigError: Always.
        """
        raise ConfigError(f"method {self.name!r} answers one question and plans nothing; valid: the suite annotations")

    async def point(self, view: View, said: str, window: Box | None = None) -> Point | None:
        """Where a thing is. The annotation: labelled axes; where a window is given, the crop of that window instead."""
        shown = whole(view, "main view")
        if self._annotated:
            shown = shown.marked(Axes()) if window is None else crop(view, window, "main view", margin=0.0)
        points = await self._ask(LocatePoints(_named(said), "centre", (), shown), Points)
        return shown.frame.point_to_view(points.points[0].as_tuple) if points.points else None

    async def verdict(self, view: View, said: str, box: Box) -> str:
        """What a box is worth: accept, revise or reject. The annotation: a crop round it."""
        shown = self._boxed(view, box, [box], "main view", self._annotated)
        return (await self._ask(JudgeBox(_named(said), shown), BoxVerdict)).decision

    async def turn(
        self, view: View, box: Box, goal: View, goal_at: Point, turns: Sequence[float], said: str
    ) -> float | None:
        """By which of these angles a thing has to be turned [degrees clockwise]. The annotation: cut-outs turned by each."""
        drawn = turns if self._annotated else (0.0,)
        strip = turn_strip(Shown(view, box.centre), Shown(goal, goal_at), reach_px(box), drawn, "goal and thing")
        if not self._annotated:
            strip = _without_tiles(strip)
        choice = await self._ask(ReadTurn(_named(said), strip, tuple(turns), "the goal's picture"), TurnChoice)
        return None if choice.number is None else float(turns[choice.number - 1])

    async def revision(self, view: View, said: str, before: Box, after: Box) -> str:
        """Whether a box became better: keep_before, take_after_go_on or take_after_stop. The annotation: the box before, too."""
        both = [before, after]
        was = self._boxed(view, before, both, "before", True) if self._annotated else None
        question = JudgeRevision(_named(said), was, self._boxed(view, after, both, "after", True))
        return (await self._ask(question, RevisionVerdict)).decision

    async def _ask(self, question: LocatePoints | JudgeBox | ReadTurn | JudgeRevision, kind: type[Value]) -> Value:
        value = (await self.ask(question, VIEWER, "ground")).value
        assert isinstance(value, kind)
        return value

    def _boxed(self, view: View, box: Box, window: Sequence[Box], name: str, cut: bool) -> Picture:
        shown = crop(view, window[0], name, also=window[1:]) if cut else whole(view, name)
        return shown.marked(BoxMark(shown.frame.box_to_picture(box)))


def _named(said: str) -> Target:
    return Target("T1", "object", said, use=("pick",))


def _without_tiles(strip: Picture) -> Picture:
    """The thing as it lies stands where the cut-outs would, in a box of its own."""
    tiles = [mark for mark in strip.marks if isinstance(mark, Tiles)]
    now = [BoxMark(box, "target", "now") for one in tiles for box in one.boxes]
    return replace(strip, marks=(*(mark for mark in strip.marks if not isinstance(mark, Tiles)), *now))
