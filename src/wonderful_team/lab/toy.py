"""The toy table of the paper's Appendix F: coloured shapes on a grey mat, one of them the target circle, and boxes round it.

Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Appendix F. Followed: the circle's radius of 50 px, four kinds of boxes. The
paper does not say how large its pictures are: 1,000 x 1,000 px are assumed here, so errors are given in radii of the circle.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from wonderful_team.agents import build_request
from wonderful_team.contracts import JudgeBox
from wonderful_team.core.actions import PICK_PLACE, Action, Vocabulary
from wonderful_team.core.geometry import AffineCamera, Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Axes, BoxMark, Point
from wonderful_team.core.protocols import Score
from wonderful_team.core.values import (
    NO_WORKSPACE,
    GroundTruthView,
    Instruction,
    Limits,
    Observation,
    Request,
    StepReport,
    Target,
    TrueThing,
    View,
)
from wonderful_team.images import crop, whole
from wonderful_team.lab.marks import COLOURS, SHAPES, shape_mask

SIDE_PX = 1000
RADIUS_PX = 50.0
OTHERS = 6
"""Shapes beside the target."""
APART = 2.6
"""Least distance of two shapes' middles, in radii: boxes round neighbours do not overlap."""
MAT = (150, 150, 150)
PX_PER_M = 1000.0

BoxKind: TypeAlias = Literal["perfect", "slightly_off", "around", "wrong_object"]
BOX_KINDS: tuple[BoxKind, ...] = get_args(BoxKind)
RIGHT: Mapping[BoxKind, str] = {
    "perfect": "accept", "slightly_off": "revise", "around": "reject", "wrong_object": "reject",
}  # fmt: skip
"""The verdict that the paper counts as right."""


@dataclass(frozen=True)
class ToyThing:
    """A shape on the mat: words, middle [px], shape."""

    words: str
    centre: Point
    shape: str

    @property
    def box(self) -> Box:
        """Tight round the shape [px]."""
        mask = self.mask
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        return Box(float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))

    @property
    def mask(self) -> Array:
        """The pixels that show it, shape (H, W), bool."""
        return shape_mask((SIDE_PX, SIDE_PX), self.centre, RADIUS_PX, SHAPES[self.shape])


class ToyTable:
    """A toy table: a world to look at, in which nothing is moved.

    Attributes:
        target: The circle that is asked for.
        things: Everything on the mat, the target first.
    """

    vocabulary: Vocabulary = PICK_PLACE
    limits: Limits = NO_WORKSPACE
    facts = ""

    def __init__(self, seed: int = 0) -> None:
        rng = np.random.default_rng([seed, SIDE_PX])
        colours = [str(colour) for colour in rng.permutation(list(COLOURS))]
        others = [shape for shape in SHAPES if shape != "circle"]
        shapes = ["circle", *(others[int(i)] for i in rng.integers(len(others), size=OTHERS))]
        places = _places(rng, len(shapes))
        self.seed = seed
        self.things = tuple(
            ToyThing(f"{colour} {shape}", place, shape)
            for colour, shape, place in zip(colours, shapes, places, strict=False)
        )
        self.target = self.things[0]
        rgb = np.full((SIDE_PX, SIDE_PX, 3), MAT, np.uint8)
        for thing in self.things:
            rgb[thing.mask] = COLOURS[thing.words.partition(" ")[0]]
        camera = AffineCamera(np.array([[PX_PER_M, 0, 0, 0], [0, PX_PER_M, 0, 0], [0, 0, -1, 1.0]]))
        self.view = View("toy", "toy", 0.0, rgb, None, camera)
        self.instruction = Instruction(f"Find: {self.target.words}")
        self.privileged = ToyTruth(self)

    def observe(self) -> Observation:
        """The mat from above."""
        return Observation({"toy": self.view})

    def execute(self, action: Action) -> StepReport:
        """Nothing can be moved here."""
        return StepReport(action, executed=False, fault="the toy table is only looked at")

    def stop(self) -> None:
        """Nothing moves."""

    def close(self) -> None:
        """Nothing is held."""

    def box(self, kind: BoxKind) -> Box:
        """A box of one of the four kinds, the same for the same seed [px]."""
        rng = np.random.default_rng([self.seed, BOX_KINDS.index(kind), 1])
        right, radius = self.target.box, RADIUS_PX
        match kind:
            case "perfect":
                return right
            case "slightly_off":
                angle, far = rng.uniform(0, 2 * np.pi), rng.uniform(0.5, 0.9) * radius
                grow = rng.uniform(-0.2, 0.3) * radius
                moved = right.shifted(far * np.cos(angle), far * np.sin(angle)).grown(grow, grow, grow, grow)
                return _inside(moved)
            case "around":
                # Within 4 radii of the middle and clear of the target, nor on another shape.
                for _ in range(1000):
                    angle, far = rng.uniform(0, 2 * np.pi), rng.uniform(2.4, 4.0) * radius
                    box = right.shifted(far * np.cos(angle), far * np.sin(angle))
                    if box == _inside(box) and all(box.intersection(thing.box) is None for thing in self.things):
                        return box
                raise AssertionError(f"no free place around the target of toy table {self.seed}")
            case "wrong_object":
                return self.things[1 + int(rng.integers(len(self.things) - 1))].box


class ToyTruth:
    """What simulated models and scorers know of a toy table."""

    def __init__(self, table: ToyTable) -> None:
        self._table = table

    def score(self) -> Score:
        """There is nothing to be done here."""
        return Score(None, None, "the toy table is only looked at")

    def truth(self) -> Mapping[str, Any]:
        """Middles of all shapes [px]."""
        return {thing.words: list(thing.centre) for thing in self._table.things}

    def oracle(self) -> Sequence[Action]:
        return ()

    @cached_property
    def _things(self) -> dict[str, TrueThing]:
        return {thing.words: _true_thing(thing) for thing in self._table.things}

    def things(self) -> Mapping[str, TrueThing]:
        return self._things

    def start(self) -> Mapping[str, TrueThing]:
        return self._things

    @cached_property
    def _sight(self) -> GroundTruthView:
        return GroundTruthView(
            self._table.view, {thing.words: thing.mask for thing in self._table.things}, self._things
        )

    def observation_log(self, view_id: str) -> Sequence[GroundTruthView]:
        return (self._sight,) if view_id == self._table.view.id else ()


def _true_thing(thing: ToyThing) -> TrueThing:
    """A shape as flat as paper, a millimetre for a pixel."""
    middle = np.array([*thing.centre, 0.0]) / PX_PER_M
    colour = thing.words.partition(" ")[0]
    box = thing.box
    outline = np.array([(box.x0, box.y0), (box.x1, box.y0), (box.x1, box.y1), (box.x0, box.y1)]) / PX_PER_M
    return TrueThing(thing.words, thing.words, "object", thing.shape, colour, middle, 0.0, 0.0, outline, middle)


def _places(rng: np.random.Generator, count: int) -> list[Point]:
    """Middles that keep apart; the first one has room around it for boxes that miss it."""
    margin = 1.3 * RADIUS_PX
    places: list[Point] = []
    while len(places) < count:
        edge = 4.5 * RADIUS_PX if not places else margin
        x, y = (float(value) for value in rng.uniform(edge, SIDE_PX - edge, size=2))
        least = APART * RADIUS_PX * (1.8 if len(places) < 3 else 1.0)
        if all(np.hypot(x - a, y - b) >= least for a, b in places):
            places.append((x, y))
    return places


def _inside(box: Box) -> Box:
    return box.intersection(Box(0, 0, SIDE_PX, SIDE_PX)) or box


def checker_request(table: ToyTable, box: Box) -> Request:
    """A box on a toy table, judged as the team has it judged: by the Checker, on a crop."""
    return judged_request(table.view, table.target.words, box)


def judged_request(view: View, words: str, box: Box) -> Request:
    """A box in any view, judged by the Checker on a crop."""
    shown = crop(view, box, "crop")
    marked = shown.marked(Axes(whole(view, "main view").frame), BoxMark(shown.frame.box_to_picture(box)))
    question = JudgeBox(Target("T1", "object", words, use=("pick",)), marked)
    return build_request(question, id="0/ground/T1/JudgeBox/1", stage="ground")
