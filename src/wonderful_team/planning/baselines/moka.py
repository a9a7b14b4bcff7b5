"""`moka`: names by the model, boxes and masks by a detector, and motions chosen among marks that are drawn on the picture.

Sources: Liu, Fang et al. 2024, MOKA: Open-World Robotic Manipulation through Mark-Based Visual Prompting, arXiv:2403.03174, and their program; its
comparison in Wang, Shen & Stadie 2024, arXiv:2407.19094, Appendix G.4.
Followed: the model names subtasks, each with the thing that is held and the one that it is brought to; a detector and a segmenter find both; keypoints
are the middle of a mask and points of its boundary by farthest-point sampling (KEYPOINTS in all), drawn as P1, P2, ... and Q1, Q2, ..., with a grid of 5 x 5 tiles over
the picture; the model answers with marks: grasp, function and target keypoint, tiles before and after contact with their heights, an angle. A
waypoint is a point of its tile, chosen at random where nothing is seen. The motion follows by code: grasp, (tile before,) target, (tile after,) release; without a
function keypoint straight to the target. Marks that do not exist are counted as a crash of the code (stage "crash"), as the paper does, and never asked
again; so is an answer that is no answer after the attempts that every method has. A thing that the detector does not find ends it at stage
grounding; the paper counts this among the crashes too.
Left open or changed, and what is done here:
- Subtasks are asked for once (their program proposes and then merges), without the examples in context that they offer.
- All subtasks are planned from the first picture, as the comparison is open loop; what an earlier one moves, later marks go along with, and what
  was done before is told in a line, where theirs looks again.
- The angle is in degrees about the vertical. What they do with the point cloud (grasp sampling, depth of waypoints) is left to the code that all
  methods share, and a robot that only picks and places is sent from the grasp to where the gripper opens.
- Where a detector gives no mask, its box is the mask.
"""

from __future__ import annotations

import math
import re
import zlib
from collections.abc import Sequence

import cv2
import numpy as np

from wonderful_team.agents.common import ANSWER, DATA, EXAMPLES, INSTRUCTION, PICTURES, system_words
from wonderful_team.agents.rendering import ability_parts, listed, picture_parts, task_parts, words
from wonderful_team.agents.role import Ask, Role, role
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import ChooseMotion, ListSubtasks, MotionMarks, Question, SubtaskDraft, SubtaskList
from wonderful_team.contracts.choose_motion import GRASPED, UNATTACHED
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Candidates, Grid, Picture, Point
from wonderful_team.core.protocols import Detector
from wonderful_team.core.steps import Height
from wonderful_team.core.values import Answer, Detection, Part, Plan
from wonderful_team.detectors import identity_of
from wonderful_team.errors import CodeCrashError, ModelOutputError, NotFoundError, NotUnderstoodError
from wonderful_team.models.client import ModelClient
from wonderful_team.planning.baselines.open_loop import OpenLoop
from wonderful_team.planning.baselines.programs import Looks, ToolMotion, ToolPath, Waypoint, kinds_of

KEYPOINTS = 6
"""The middle of a thing and five points of its boundary."""
TILES = 5
"""Rows and columns of the grid."""
TRIES = 40
"""How often a waypoint is drawn anew that would lie on a thing; the last one is taken as it is."""
_HEIGHTS: dict[str, Height] = {"same": "at", "above": "clear"}


def _render_motion(question: ChooseMotion) -> list[Part]:
    lines = [
        f"Subtask: {question.instruction}",
        f"Held: {question.object_grasped or 'nothing'}",
        f"Acted on: {question.object_unattached or 'nothing'}",
        f"Direction: {question.motion_direction or 'not said'}",
    ]
    return [
        *words(*lines),
        *listed("Done before it, which the picture does not show yet", question.earlier),
        *ability_parts(question.step_kinds),
        *picture_parts(question.view, "the main view with marks"),
    ]


DECOMPOSER = role(
    "decomposer",
    system_words(
        "You divide a robot's task into motions and name the things that they need. A detector finds them by your words alone.",
        PICTURES + "\n" + EXAMPLES,
        DATA + "\n" + INSTRUCTION,
        ANSWER,
    ),
    Ask(
        ListSubtasks,
        """
Write the subtasks in order. In each at most one thing is held, from taking hold of it to letting it go. Name a thing by its kind, colour and pattern
as it looks in the main view, so that a detector that knows nothing else finds it and no other. To turn a thing where it stands: held, and nothing acted on.
""",
        lambda question: [
            *task_parts(question.task),
            *ability_parts(question.step_kinds),
            *listed("What went wrong before, to be avoided now", question.advice),
        ],
    ),
)
MARKER = role(
    "marker",
    system_words(
        "You choose a robot's motion among marks that are drawn on the picture of its table.",
        PICTURES,
        DATA,
        ANSWER,
    ),
    Ask(
        ChooseMotion,
        """
Choose the marks that make the motion do what the subtask asks. P1, P2, ... lie on the thing that is held: its middle first, then its boundary. Q1,
Q2, ... lie on the thing that is acted on, likewise. Tiles are named by a letter (column) and a number (row from the bottom).
- Held: the grasp keypoint on its solid material; then the target keypoint that it is brought to, or a tile after contact where there is no target.
- Nothing held: the tool goes along the surface, from the tile before contact over the target keypoint to the tile after contact.
""",
        _render_motion,
    ),
    grounds=True,
)


class Moka(OpenLoop):
    """Names, a detector, marks.

    Args:
        client: Where the model is asked.
        detector: Who finds the named things.
    """

    def __init__(self, client: ModelClient, detector: Detector) -> None:
        super().__init__(client, "moka", DECOMPOSER, MARKER)
        self._detector = detector

    @property
    def setting(self) -> dict[str, str]:
        """How it is set up, for the record."""
        return {**super().setting, **{f"detector {key}": said for key, said in identity_of(self._detector).items()}}

    async def make_plan(self, scene: SceneShown, start: Plan, advice: tuple[str, ...]) -> Plan:
        """Subtasks, their things, and a motion for each."""
        kinds = kinds_of(scene)
        planned: SubtaskList = (
            await self._readable(ListSubtasks(scene.task, kinds, advice), DECOMPOSER, "plan", "main")
        ).value
        looks = Looks(self._detector, self.client, scene.view, self.attempt)
        found = {name: await self._find(looks, name) for name in _names(planned.subtasks)}
        size = scene.view.size_px
        busy = np.any([np.zeros(size[::-1], bool), *(one.mask_in(size) for one in found.values())], axis=0)
        path: ToolPath | None = None
        moved: dict[str, Point] = {}
        earlier: list[str] = []
        for number, subtask in enumerate(planned.subtasks, start=1):
            held, other = (found.get(name.strip()) for name in (subtask.object_grasped, subtask.object_unattached))
            view = _marked(scene.views[0], size, held, other)
            question = ChooseMotion(
                subtask.instruction,
                subtask.object_grasped,
                subtask.object_unattached,
                subtask.motion_direction,
                view,
                kinds,
                tuple(earlier),
            )
            answer = await self._readable(question, MARKER, "ground", f"G{number}")
            seed = f"{scene.observation.hash}|{self.attempt}|{number}"
            motion = Motion(question, answer.value, busy, seed)
            shifts = (moved.get(subtask.object_grasped.strip()), moved.get(subtask.object_unattached.strip()))
            path = path or ToolPath(
                scene.views[0], kinds, looks.around, "a mark that the model chose", answer.provenance
            )
            motions, carried = motion.path(*shifts)
            path.write(motions, subtask.instruction)
            earlier.append(_done(subtask, answer.value))
            if carried is not None:
                before = shifts[0] or (0.0, 0.0)
                moved[subtask.object_grasped.strip()] = (before[0] + carried[0], before[1] + carried[1])
        if path is None:
            return self.with_actions(scene, start, (), {}, ())
        return self.with_actions(scene, start, path.subgoals, path.grounded, tuple(path.steps))

    async def _readable(self, question: Question, asker: Role, stage: str, branch: str) -> Answer:
        """An answer in the form that is asked for; one that never comes is a crash, as in their program."""
        try:
            return await self.ask(question, asker, stage, branch)
        except ModelOutputError as error:
            if type(error) is not ModelOutputError:
                raise
            raise CodeCrashError(f"the answer to {question.contract} cannot be read: {error}") from error

    async def _find(self, looks: Looks, name: str) -> Detection:
        try:
            found = await looks.at(name)
        except NotUnderstoodError as error:
            raise NotFoundError(str(error)) from error
        if not found:
            raise NotFoundError(f"the detector finds no {name}")
        return found[0]


def _done(subtask: SubtaskDraft, marks: MotionMarks) -> str:
    """An earlier subtask in words, with the mark or tile that it ends at."""
    end = marks.post_contact_tile.strip() or marks.target_keypoint.strip()
    other = subtask.object_unattached.strip()
    of = f" of {other}" if other and not marks.post_contact_tile.strip() else ""
    return subtask.instruction + (f" (ends at {end}{of})" if end else "")


def _names(subtasks: Sequence[SubtaskDraft]) -> list[str]:
    every = (name.strip() for one in subtasks for name in (one.object_grasped, one.object_unattached))
    return [name for name in dict.fromkeys(every) if name]


def keypoints(found: Detection, size_px: tuple[int, int]) -> tuple[Point, ...]:
    """The middle of a thing, then points of its boundary as far from each other as they can be, from top to bottom [view px]."""
    mask = found.mask_in(size_px)
    outlines, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    boundary = max(outlines, key=cv2.contourArea)[:, 0, :].astype(float) + 0.5
    # Of all that shows of it: the mean of the boundary alone lies towards a handle, where there is much boundary and little thing.
    chosen = [np.argwhere(mask)[:, ::-1].mean(axis=0) + 0.5]
    away = np.hypot(*(boundary - chosen[0]).T)
    while len(chosen) < min(KEYPOINTS, len(boundary) + 1):
        chosen.append(boundary[int(away.argmax())])
        away = np.minimum(away, np.hypot(*(boundary - chosen[-1]).T))
    ordered = [chosen[0], *sorted(chosen[1:], key=lambda point: float(point[1]))]
    return tuple((float(x), float(y)) for x, y in ordered)


def _marked(view: Picture, size_px: tuple[int, int], held: Detection | None, other: Detection | None) -> Picture:
    marks = [
        Candidates(tuple(view.frame.point_to_picture(point) for point in keypoints(one, size_px)), letter)
        for one, letter in ((held, GRASPED), (other, UNATTACHED))
        if one is not None
    ]
    return view.marked(Grid(TILES, TILES), *marks)


class Motion:
    """A subtask's marks as a path of the tool.

    Args:
        question: What there was to choose from.
        marks: What was chosen.
        busy: Where things are, shape (H, W) of the view.
        seed: Of the waypoints.
    """

    def __init__(self, question: ChooseMotion, marks: MotionMarks, busy: Array, seed: str) -> None:
        self._question, self._marks, self._busy, self._seed = question, marks, busy, seed

    def path(self, held_by: Point | None, other_by: Point | None) -> tuple[list[ToolMotion], Point | None]:
        """The motions, and by how much a thing is carried; None where none is held.

        Args:
            held_by: How far earlier subtasks have carried the held thing [view px].
            other_by: The same of the other.

        Raises:
            CodeCrashError: A mark, a tile or a height that there is not.
        """
        marks = self._marks
        grasp = _moved(self._keypoint(marks.grasp_keypoint, GRASPED), held_by)
        function = _moved(self._keypoint(marks.function_keypoint, GRASPED), held_by)
        target = _moved(self._keypoint(marks.target_keypoint, UNATTACHED), other_by)
        goals = [
            self._waypoint(marks.pre_contact_tile, marks.pre_contact_height, "before"),
            None if target is None else (target, "at"),
            self._waypoint(marks.post_contact_tile, marks.post_contact_height, "after"),
        ]
        if grasp is not None and function is None and target is not None:
            goals = [(target, "at")]
        way = [goal for goal in goals if goal is not None]
        if grasp is None:
            return self._swept(way), None
        return self._carried(grasp, function or grasp, way)

    def _carried(
        self, grasp: Point, function: Point, way: list[tuple[Point, Height]]
    ) -> tuple[list[ToolMotion], Point | None]:
        turn = self._marks.target_angle
        c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        dx, dy = grasp[0] - function[0], grasp[1] - function[1]
        lever = (c * dx - s * dy, s * dx + c * dy)
        ends = [((x + lever[0], y + lever[1]), height) for (x, y), height in way] or [(grasp, "at")]
        motions: list[ToolMotion] = [Waypoint(grasp, "clear"), Waypoint(grasp, "at"), "close", Waypoint(grasp, "clear")]
        motions.append(Waypoint(ends[0][0], "clear", turn))
        motions += [Waypoint(point, height, turn) for point, height in ends]
        last = ends[-1][0]
        motions += ["open", Waypoint(last, "clear", turn)]
        return motions, (last[0] - grasp[0], last[1] - grasp[1])

    @staticmethod
    def _swept(way: list[tuple[Point, Height]]) -> list[ToolMotion]:
        """Nothing is held: the closed tool goes along."""
        if not way:
            return []
        motions: list[ToolMotion] = ["close", Waypoint(way[0][0], "clear")]
        motions += [Waypoint(point, height) for point, height in way]
        return [*motions, Waypoint(way[-1][0], "clear")]

    def _keypoint(self, said: str, letter: str) -> Point | None:
        """The point of a mark [view px]. Its letter does not count, as in their program; its number does."""
        if not said.strip():
            return None
        points = self._question.keypoints(letter).points
        number = re.fullmatch(r"\s*[A-Za-z]\s*(\d{1,4})\s*", said)
        if number is None or not 1 <= int(number.group(1)) <= len(points):
            valid = f"{letter}1 to {letter}{len(points)}" if points else f"none, there is no {letter}"
            raise CodeCrashError(f"mark {said.strip()[:40]!r} does not exist; valid: {valid}")
        return self._question.view.frame.point_to_view(points[int(number.group(1)) - 1])

    def _waypoint(self, tile: str, height: str, which: str) -> tuple[Point, Height] | None:
        """A point of a tile where nothing is seen [view px], the same for the same scene."""
        if not tile.strip():
            return None
        if height.strip() not in _HEIGHTS:
            raise CodeCrashError(
                f"height {height.strip()[:40]!r} {which} contact does not exist; valid: {', '.join(_HEIGHTS)}"
            )
        view = self._question.view
        try:
            box = view.frame.box_to_view(self._question.grid.tile(tile.strip(), view.size_px))
        except ValueError as error:
            raise CodeCrashError(f"{which} contact: {str(error)[:200]}") from error
        rng = np.random.default_rng(zlib.crc32(f"{self._seed}|{which}".encode()))
        rows, columns = self._busy.shape
        for _ in range(TRIES):
            x, y = float(rng.uniform(box.x0, box.x1)), float(rng.uniform(box.y0, box.y1))
            if not self._busy[min(max(int(y), 0), rows - 1), min(max(int(x), 0), columns - 1)]:
                break
        return (x, y), _HEIGHTS[height.strip()]


def _moved(point: Point | None, by: Point | None) -> Point | None:
    return point if point is None or by is None else (point[0] + by[0], point[1] + by[1])
