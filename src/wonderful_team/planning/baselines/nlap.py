"""`nlap`: objects and positions become a list in words, from which a plan with coordinates is reasoned out in natural language.

Sources: Mikami et al. 2024, Natural Language as Policies, arXiv:2403.13801; its replication in Wang, Shen & Stadie 2024, arXiv:2407.19094,
Appendix G.1, whose columns name the models for planning + extraction.
Followed: a list of objects with coordinates, one worked example, a chain of thought or none, coordinates in the answer. The rows:
`nlap` (GPT-4o + GPT-4o): the model writes the list from the picture, and sees the pictures, the example's too, when it plans;
`nlap:text`: the same list, planned from without pictures, as the method was published;
`nlap:privileged` (… + ground truth): true names and positions from the simulator, no picture at all. It is told what no planner may see,
so its name says so wherever it stands. Each with `:no-cot` for no chain of thought.
Left open by both: words, format and example. They wrote an example for each task, at times one that is nearly the task itself; ours is one
for all tasks, of things that no task has. What a picture of the instruction shows is told in words (in the privileged row from truth:
name, and positions for whole scenes; no angles). The position of a thing is its centre; of one that is carried and has a hole
there, a point at which it can be held. No boxes: what code computes from a thing's outline, such as places beside it, it cannot have.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from wonderful_team.agents.common import ANSWER, DATA, EXAMPLES, INSTRUCTION, PICTURES, PLAIN_GREY, system_words
from wonderful_team.agents.passages import fill
from wonderful_team.agents.rendering import (
    ability_parts,
    answer_in,
    fenced,
    listed,
    picture_parts,
    slot_parts,
    view_parts,
    words,
)
from wonderful_team.agents.role import Ask, role
from wonderful_team.agents.scene import SceneShown, show_views
from wonderful_team.contracts import (
    ListedObject,
    ListedPlan,
    ListObjects,
    ObjectList,
    PlanFromList,
    ShownSlot,
    SlotWords,
)
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.core.values import Observation, Part, Plan, View
from wonderful_team.images import whole
from wonderful_team.models.client import ModelClient
from wonderful_team.planning.baselines.open_loop import OpenLoop, pointed

_WORD, _ARTICLES = re.compile(r"\w+"), frozenset({"the", "a", "an"})


@dataclass(frozen=True)
class Told:
    """True names and positions [px of the main view], and the instruction's pictures in words: text and nothing else.

    Attributes:
        objects: Name and position.
        slots: By name of the picture: lines of words, each with a position where it shows a whole scene.
    """

    objects: tuple[tuple[str, Point], ...]
    slots: dict[str, tuple[tuple[str, Point | None], ...]]


Teller = Callable[[Picture, Sequence[ShownSlot]], Told]
"""From the main view and the instruction's pictures, by which the simulator knows what is looked at."""

EXTRACTOR = role(
    "extractor",
    system_words(
        """
You put a scene into words for a planner who does not see it: what there is and where it is.
""",
        PICTURES + "\n" + EXAMPLES,
        DATA,
        ANSWER,
    ),
    Ask(
        ListObjects,
        """
List everything that lies on the table, containers and marked areas too: for each a name (colour, pattern, shape), so that no two
things share one, and its position. Then say in words what each picture of the instruction shows: of one thing alone its colour,
pattern and shape; of a whole scene what stands where, with positions.
""",
        lambda question: [
            *picture_parts(question.view, "the main view"),
            *(words("Pictures of the instruction:") if question.slots else []),
            *slot_parts(question.slots),
            *answer_in(question.view),
        ],
    ),
    grounds=True,
)

THINK = """
First think step by step, in words: what is asked for; which line of the list each thing is that it speaks of; where each has to go
and what coordinates that place has; in which order; how far anything is turned. Then write the plan.
""".strip()
NO_THOUGHT = "Write the plan at once, without an explanation."

PLAN = """
Write a plan that does what the instruction asks: subgoals (G1, G2, and so on, in order, each one result), targets with their coordinates,
and the robot's steps.
- A target (T1, T2, and so on) is a thing of the list (kind object) or a spot on the table (kind area). Give its coordinates for each use: pick, where it is
  taken hold of; place, where the middle of what is put there comes to lie; push_start and push_end, where the front of a tool comes
  down and stops; grasp, where a gripper closes. Take the list's coordinates, or compute them from those.
- Steps name targets by id. A place is "at" a target, or the "origin" of a target (where it stood at the start).
- rotate_deg: only what the instruction states; clockwise seen from above is positive; 0 when nothing is said.
- Every subgoal is served by a step; none when the instruction is already fulfilled.
"""


def _lines(objects: Sequence[ListedObject]) -> list[str]:
    return [f"{number}. {item.name}: x {item.x}, y {item.y}" for number, item in enumerate(objects, start=1)]


def _render_plan(question: PlanFromList) -> list[Part]:
    width, height = question.size_px
    shown = [] if question.example_view is None else picture_parts(question.example_view, "the example's scene")
    return [
        *words("An example, of another table:"),
        *words(question.example),
        *shown,
        *words("Now the table at hand."),
        *listed("Objects", _lines(question.objects), "none"),
        *words(
            f'Positions are pixels of "{question.picture}", {width} wide and {height} high, from its top-left corner: x grows to the '
            "right, y grows downwards."
        ),
        *words("The user's instruction:", fenced("instruction", question.instruction)),
        *listed("What its names in braces stand for", [f"{{{one.slot}}}: {one.words}" for one in question.slot_words]),
        *(words(PLAIN_GREY) if question.slot_words else []),
        *(words(*fill((PICTURES + "\n" + EXAMPLES,), question, shown)) if question.views else []),
        *view_parts("The scene now", question.views),
        *(words("Pictures of the instruction:") if question.slots else []),
        *slot_parts(question.slots),
        *listed("What is known of the robot and its place", question.facts),
        *ability_parts(question.step_kinds),
        *listed("What went wrong before, to be avoided now", question.advice),
        *words(THINK if question.thoughts else NO_THOUGHT),
    ]


REASONER = role(
    "reasoner",
    system_words(
        """
You plan for a robot in natural language, from a list of the objects on its table with their coordinates. You work alone: the
coordinates that you write are where the robot goes.
""",
        DATA + "\n" + INSTRUCTION,
        """
How to answer
- Fill in exactly the fields that are asked for.
""",
    ),
    Ask(PlanFromList, PLAN, _render_plan),
)

EXAMPLE = (
    ListedObject("orange cone", 220, 150),
    ListedObject("white tray", 700, 330),
    ListedObject("black coin", 480, 90),
)
EXAMPLE_WORDS = "Put the orange cone onto the white tray."
EXAMPLE_THOUGHTS = """Thoughts: The instruction speaks of an orange cone, which is line 1 at x 220, y 150, and of a white tray, which is line 2
at x 700, y 330. The cone is carried, the tray stays. The black coin is not spoken of and is left alone. The middle of the cone has to come to lie
on the middle of the tray. Nothing is said about a turn, so it is 0 degrees. One step does it."""
_STEPS = {
    "pick_place": ("pick", "place", "pick_place, pick T1, place at T2, turned 0 degrees"),
    "push": ("push_start", "push_end", "push, start at T1, end at T2"),
    "move": (
        "grasp",
        "place",
        "open; move just above T1; move down to T1; close; move clear over T1; move just above T2; move down to T2; open; move clear over T2",
    ),
}


def example_text(step_kinds: Sequence[str], thoughts: bool) -> str:
    """The one worked example, for what this robot can do."""
    start, end, step = next(
        (said for kind, said in _STEPS.items() if kind in step_kinds),
        ("grasp", "place", "the steps that carry T1 to T2"),
    )
    said = [
        "Objects:",
        *(f"- {line}" for line in _lines(EXAMPLE)),
        "Instruction:",
        EXAMPLE_WORDS,
        "Answer:",
        *([EXAMPLE_THOUGHTS] if thoughts else []),
        "Subgoal G1: the orange cone lies on the white tray; needs T1 and T2.",
        f"Target T1, object: orange cone; {start} at x 220, y 150.",
        f"Target T2, object: white tray; {end} at x 700, y 330.",
        f"Steps of G1: {step}.",
    ]
    return "\n".join(said)


def example_picture() -> Picture:
    """The example's scene, drawn: things of no task, on a table of another colour."""
    rgb = np.full((480, 960, 3), (196, 178, 150), np.uint8)
    rgb[250:410, 580:820] = (245, 245, 245)
    rows, columns = np.mgrid[0:480, 0:960]
    rgb[(rows > 110) & (rows < 190) & (np.abs(columns - 220) < (rows - 110) / 2)] = (235, 130, 30)
    rgb[np.hypot(rows - 90, columns - 480) < 16] = (25, 25, 25)
    return whole(View("example", "example", 0.0, rgb), "example view")


class Nlap(OpenLoop):
    """A list of objects, then one plan from it.

    Args:
        client: Where the model is asked.
        name: As the table of methods has it.
        pictures: Show the pictures when the plan is written.
        thoughts: Ask for a chain of thought.
        tell: Gives true names and positions in place of the model's list; PRIVILEGED.
    """

    def __init__(
        self,
        client: ModelClient,
        name: str,
        *,
        pictures: bool = True,
        thoughts: bool = True,
        tell: Teller | None = None,
    ) -> None:
        super().__init__(client, name, *([REASONER] if tell else [EXTRACTOR, REASONER]))
        self._pictures, self._thoughts, self._tell = pictures, thoughts, tell

    @property
    def setting(self) -> dict[str, str]:
        """How it is set up, for the record."""
        told = {"PRIVILEGED": "true object names and positions, as text"} if self._tell is not None else {}
        return {**super().setting, **told}

    async def make_plan(self, scene: SceneShown, start: Plan, advice: tuple[str, ...]) -> Plan:
        """The list, then the plan."""
        view = scene.views[0]
        objects, slot_words = (
            await self._list(scene, view) if self._tell is None else self._truth(self._tell, scene, view)
        )
        kinds = scene.vocabulary.step_kinds
        shown: tuple[tuple[Picture, ...], tuple[ShownSlot, ...]] = (
            (scene.views, scene.slots) if self._pictures else ((), ())
        )
        question = PlanFromList(
            scene.instruction.text, objects, slot_words, view.name, view.size_px, kinds, self._thoughts,
            example_text(kinds, self._thoughts), scene.task.facts, advice, *shown,
            example_picture() if self._pictures else None,
        )  # fmt: skip
        answer = await self.ask(question, REASONER, "plan")
        drafted: ListedPlan = answer.value
        how = "reasoned out from the list of objects" + ("" if self._tell is None else ", which is true (PRIVILEGED)")
        grounded = {
            draft.id: pointed(
                draft.to_target(),
                {point.use: (point.x, point.y) for point in draft.points},
                view,
                how,
                answer.provenance,
            )
            for draft in drafted.targets
        }
        subgoals = [goal.to_subgoal() for goal in drafted.subgoals]
        return self.with_actions(scene, start, subgoals, grounded, drafted.to_steps())

    async def locate(self, observation: Observation, asked: Sequence[str]) -> list[Point | None]:
        """Where things are, without a plan: the position of the listed object whose name says most of the words asked for, in
        pixels of the main view; None where none says any, or two say as many.
        """
        view = show_views(observation)[0]
        if self._tell is not None:
            named = [(name, view.frame.point_to_picture(point)) for name, point in self._tell(view, ()).objects]
        else:
            found: ObjectList = (await self.ask(ListObjects(view, ()), EXTRACTOR, "ground")).value
            named = [(item.name, item.point.as_tuple) for item in found.objects]
        places = (_named(said, named) for said in asked)
        return [None if place is None else view.frame.point_to_view(place) for place in places]

    async def _list(self, scene: SceneShown, view: Picture) -> tuple[tuple[ListedObject, ...], tuple[SlotWords, ...]]:
        """What the model sees, in words."""
        found: ObjectList = (await self.ask(ListObjects(view, scene.slots), EXTRACTOR, "ground")).value
        objects = tuple(_listed(item.name, item.point.as_tuple) for item in found.objects)
        return objects, tuple(SlotWords(item.picture, item.words) for item in found.pictures)

    def _truth(
        self, tell: Teller, scene: SceneShown, view: Picture
    ) -> tuple[tuple[ListedObject, ...], tuple[SlotWords, ...]]:
        """What is true, in words."""
        told, at = tell(view, scene.slots), view.frame.point_to_picture
        objects = tuple(_listed(name, at(point)) for name, point in told.objects)
        slots = []
        for slot, lines in told.slots.items():
            said = [name if point is None else _line(_listed(name, at(point))) for name, point in lines]
            slots.append(SlotWords(slot, "; ".join(said) or "nothing"))
        return objects, tuple(slots)


def _named(said: str, listed: Sequence[tuple[str, Point]]) -> Point | None:
    """Where the object is that these words name."""
    asked = set(_WORD.findall(said.lower())) - _ARTICLES
    shares = [(len(asked & set(_WORD.findall(name.lower()))), point) for name, point in listed]
    most = max((count for count, _ in shares), default=0)
    fitting = [point for count, point in shares if count == most]
    return fitting[0] if most and len(fitting) == 1 else None


def _listed(name: str, point: Point) -> ListedObject:
    return ListedObject(name, round(point[0]), round(point[1]))


def _line(item: ListedObject) -> str:
    return f"{item.name} at x {item.x}, y {item.y}"
