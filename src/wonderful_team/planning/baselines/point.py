"""`point`: one model, asked where one thing is, or whether a box is good, on the whole picture. It plans nothing.

Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Appendix F: direct coordinates (F.1) and the classification of boxes (F.2), with one
question a picture. Followed: the whole picture at once, "the overlaid pixel coordinates" (`point:axes`), the three verdicts and what they
mean. Left open by the paper: the words; here they are ours.
"""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team.agents.common import ANSWER, DATA, PICTURES, system_words
from wonderful_team.agents.rendering import answer_in, picture_parts, target_words, words
from wonderful_team.agents.role import Ask, Role, role
from wonderful_team.agents.scene import SceneShown, show_views
from wonderful_team.contracts import BoxVerdict, JudgeBox, LocatePoints, Points
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, BoxMark, Picture, Point
from wonderful_team.core.together import together
from wonderful_team.core.values import Observation, Part, Plan, Target
from wonderful_team.errors import ConfigError
from wonderful_team.models.client import ModelClient
from wonderful_team.planning.baselines.open_loop import OpenLoop

SYSTEM = system_words(
    "You look at a picture and say where things are, for a robot that acts at the very point that you give.",
    PICTURES,
    DATA,
    ANSWER,
)
POINT = "Give one point: the middle of the target. If it is not in the picture, say so; do not guess."
JUDGE = """
Judge the box that is drawn on the picture.
- accept: it holds the whole target without much space around it.
- revise: it holds at least a part of the target, but has to be placed better. Say in problem what should change.
- reject: it does not even touch the target. Say in problem what is in the box instead.
"""


def _render_point(question: LocatePoints) -> list[Part]:
    return [
        *picture_parts(question.view, "the picture"),
        *words(f"Target {target_words(question.target)}"),
        *answer_in(question.view),
    ]


def _render_judge(question: JudgeBox) -> list[Part]:
    return [*picture_parts(question.crop, "the picture"), *words(f"Target {target_words(question.target)}")]


POINTER: Role = role(
    "pointer", SYSTEM, Ask(LocatePoints, POINT, _render_point), Ask(JudgeBox, JUDGE, _render_judge), grounds=True
)


class PointAlone(OpenLoop):
    """Asks one question a thing.

    Args:
        client: Where the model is asked.
        axes: Label the axes of the picture.
    """

    def __init__(self, client: ModelClient, *, axes: bool = False) -> None:
        super().__init__(client, "point:axes" if axes else "point", POINTER)
        self._axes = axes

    async def make_plan(self, scene: SceneShown, start: Plan, advice: tuple[str, ...]) -> Plan:
        """It has none.

        Raises:
            ConfigError: Always.
        """
        raise ConfigError(
            f"method {self.name!r} says where things are and plans nothing; valid: the suites pointing and boxcheck, and photos"
        )

    async def locate(self, observation: Observation, asked: Sequence[str]) -> list[Point | None]:
        """Where things are: a point in pixels of the main view for each, or None."""
        view = self._shown(observation)
        return await together(self._point(view, number, said) for number, said in enumerate(asked, start=1))

    async def _point(self, view: Picture, number: int, said: str) -> Point | None:
        target = Target(f"T{number}", "object", said, use=("pick",))
        answer = await self.ask(LocatePoints(target, "centre", (), view), POINTER, "ground", branch=target.id)
        points: Points = answer.value
        return view.frame.point_to_view(points.points[0].as_tuple) if points.points else None

    async def judge(self, observation: Observation, said: str, box: Box) -> str:
        """accept, revise or reject, for a box in pixels of the main view."""
        view = self._shown(observation)
        marked = view.marked(BoxMark(view.frame.box_to_picture(box)))
        question = JudgeBox(Target("T1", "object", said, use=("pick",)), marked)
        verdict: BoxVerdict = (await self.ask(question, POINTER, "ground")).value
        return verdict.decision

    def _shown(self, observation: Observation) -> Picture:
        view = show_views(observation)[0]
        return view.marked(Axes()) if self._axes else view
