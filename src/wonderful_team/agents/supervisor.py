"""Supervisor: drafts and revises the plan, lists targets, writes steps and helper functions.

Source of the role: Wang, Shen & Stadie 2024, arXiv:2407.19094; the words are ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest

from wonderful_team.agents.common import ANSWER, DATA, EXAMPLES, INSTRUCTION, PICTURES, TARGETS, system_words
from wonderful_team.agents.manager import LOCATE_POINTS, render_locate_points
from wonderful_team.agents.rendering import (
    ability_parts,
    fenced,
    function_parts,
    listed,
    picture_parts,
    rule_parts,
    subgoal_parts,
    subgoal_words,
    target_parts,
    task_parts,
    words,
)
from wonderful_team.agents.role import Ask, role
from wonderful_team.contracts import (
    DraftPlan,
    EarlierFunction,
    ExtractTargets,
    LocatePoints,
    ReviewPath,
    RevisePlan,
    WriteFunction,
    WriteSteps,
)
from wonderful_team.core.values import Critique, Part

SYSTEM = system_words(
    """
You are the Supervisor of a team that plans for a robot. You decide what is to be done and in which order: you write
the plan, you answer doubts about it, you name what has to be found, and you write the robot's steps.

You see the instruction, the views of the scene, what is known of the robot, and the notes of the team. Other agents find
positions and check your work; code turns your steps into motion. So plan in words: no coordinates in plans or steps. Ask
for nothing that the robot is not said to be able to do, and do not invent things that neither the pictures nor the
instruction show.
""",
    PICTURES + "\n" + EXAMPLES,
    DATA + "\n" + INSTRUCTION,
    ANSWER,
)

PLAN_RULES = """
How to write the plan
- A subgoal states one result that a later picture can show, such as "the red block lies in the bowl". Ids G1, G2, and
  so on, in the order in which they are carried out. No coordinates.
- As few subgoals as the instruction needs: as a rule one for each thing that moves. "All" or "every" means one subgoal
  for each thing that you count in the main view; "any" means one of your choice: name that one.
- Look at the scene before you write: what covers, blocks or closes something has to be dealt with first, in a subgoal
  of its own, and a place must be free by the time something goes there. Several things that go into one container may
  lie on each other. Things that the instruction does not concern stay where they are, also when a picture of what is
  wanted leaves them out.
- If the instruction asks for a sequence, an order or going back to how things were, each stage is a subgoal. Going back to
  how things were takes back what was moved out of the way, too.
{% if examples %}
- An object's picture in the instruction shows what to look for. A picture of a scene, a frame or a before and after
  pair shows an arrangement or a motion to reproduce: work out from it which thing goes where. How things are turned there
  counts too, unless what is known of the robot says otherwise; state a turn in degrees and its direction.
{% endif %}
- after: only the subgoals without which this one cannot be reached.
{% if can_follow %}
- function: null, unless a subgoal needs a path of its own shape, such as a circle, a zigzag or up and down; then say what is
  to be computed, and whether the tool touches the surface on it.
{% else %}
- function: null.
{% endif %}
{% if listing %}
- move: for a subgoal that one pick and one place carry out, what is picked, where it goes and how far it is turned: "at" a
  target is the point chosen on it (on what an earlier subgoal moved, where it then lies), "beside" a target needs a side as
  the main view shows it, "origin" is where the target stood at the start. rotate_deg is only what the instruction or its
  pictures state. null for anything else (a push, a path, several moves, a cap that is screwed off) or when you are not
  sure; the steps are then written later.
{% endif %}
- unsure: what about the plan you are not sure of after looking closely, such as an angle that you had to estimate or two
  things that look the same; it is then looked at more closely. Empty when nothing is in doubt, as in most plain scenes.
- mode: one_step for a short plan without obstacles; full when many subgoals depend on each other.
- Empty subgoals only when the main view shows that the instruction is already fulfilled.
- clarification: null, unless two or more readings remain after looking closely, they lead to different results, and
  nothing you see decides between them. Then ask one question and list the choices. Never ask what a picture answers.
""".strip()

DRAFT = f"""
Write the plan that fulfils the instruction in the scene that is shown.

{PLAN_RULES}

{{% if listing %}}
{TARGETS}
{{% endif %}}
"""

REVISE = f"""
Verification raised the doubt above about your plan. Look at the scene again with this in mind.
- decision revise: the doubt is right. Give the whole new plan, not only the changed part, and say in `answer` what
  changed. Keep what was not in doubt as it was.
- decision keep: the plan is right as it stands. Give null for the plan, and say in `answer` what in the pictures or
  the instruction settles the doubt.

{PLAN_RULES}

{{% if listing %}}
{TARGETS}
{{% endif %}}
"""

EXTRACT = f"""
The plan above is approved. List every target that has to be found in the main view to carry it out, and in `needs`,
for each subgoal, the ids of its targets: at least one for each subgoal.

{TARGETS}
"""

STEPS = """
Write the steps that carry out the plan, in order. Code computes every position from the targets, so name targets by
id and give no coordinates.
- Each step names the subgoal it serves, and every subgoal is served. Use only what the robot can do, and no step that
  the plan does not need.
- A place is "at" a target (the point chosen on it), "beside" a target (then give the side, as the main view shows it),
  or the "origin" of a target (where it stood at the start; for putting things back). The middle of the thing that is
  moved lands there, wherever it is picked. A target that an earlier step moved means the place where it then lies.
- rotate_deg: only what the instruction or its pictures state; clockwise seen from above is positive, anticlockwise
  negative; 0 when nothing is said.
- If Verification asked about the last version, repair what it found and keep the rest.
"""

FUNCTION = """
Write a Python function path(boxes) for the subgoal above: it returns the points of the tool's path, in order, as a
list of (x, y) in pixels of the picture, whose width and height are stated with it.
- boxes maps a target's id to its box (x0, y0, x1, y1) in the same pixels. Compute the points from these boxes, so that
  the path fits the things; do not type positions that you read off the picture.
- Plain Python with functions, loops and the math module. Nothing else can be imported; there are no files, no input,
  no yield and no classes that inherit.
- These functions are there for you to call. centre is (x, y), angles are degrees, clockwise from straight up; tips, inner,
  points, turns, start_radius, lanes, margin, times and turn_deg may be left out.
  Closed, the first point again at the end: polygon(centre, radius, sides, turn_deg), circle(centre, radius, points, turn_deg),
  star(centre, radius, tips, inner, turn_deg), the outline with its inner corners at `inner` (0 to 1) times the radius. Open: arc(centre, radius, start_deg, end_deg, points),
  spiral(centre, radius, turns, points, start_radius), and raster(box, lanes, margin), which goes to and fro over a box
  (x0, y0, x1, y1) with two points a lane. In the air: shake(centre, up, times), up and down, two points a time and one more.
- A path in the air may rise, as for shaking: then every point is (x, y, up), where up is how far over the height at which
  things are carried, in m, from 0 to what is stated.
- At least two points and at most as many as stated; all inside the picture. The first is where the path begins.
- If an error or a criticism of the last version is shown, repair its cause and return the whole function again.
"""

REVIEW_PATH = """
The path that your helper function computed is drawn on the picture. Does it do what the subgoal asks: right place,
right shape, right order, away from things it must not touch?
- accepted true: it will do; problem is empty.
- accepted false: name the one thing that is most wrong and how it should be, in one sentence.
"""


BEFORE = "What went wrong before, to be avoided now"


def _render_draft(question: DraftPlan) -> list[Part]:
    return [
        *task_parts(question.task),
        *ability_parts(question.step_kinds),
        *rule_parts(question.step_kinds, "planned"),
        *listed(BEFORE, question.advice),
        *function_parts(question.functions),
        *_targets_wanted(question.with_targets),
    ]


def _render_revise(question: RevisePlan) -> list[Part]:
    return [
        *task_parts(question.task),
        *ability_parts(question.step_kinds),
        *rule_parts(question.step_kinds, "planned"),
        *subgoal_parts(question.subgoals, "Your plan"),
        *target_parts(question.targets),
        *_doubt_parts(question.doubt),
        *function_parts(question.functions),
        *_targets_wanted(question.with_targets),
    ]


def _doubt_parts(doubt: Critique) -> list[Part]:
    lines = [f"Verification's doubt about {doubt.about} ({doubt.kind}): {doubt.question}"]
    if doubt.answer:
        lines.append(f"What was answered before: {doubt.answer}" + (" (the plan was changed)" if doubt.changed else ""))
    elif doubt.changed:
        lines.append("The plan was changed for it before.")
    return words(*lines)


def _targets_wanted(with_targets: bool) -> list[Part]:
    if with_targets:
        return words("Targets: list them with the plan; each subgoal names at least one.")
    return words("Targets are listed later.")


def _render_extract(question: ExtractTargets) -> list[Part]:
    return [*task_parts(question.task), *subgoal_parts(question.subgoals, "The approved plan")]


def _render_steps(question: WriteSteps) -> list[Part]:
    return [
        *task_parts(question.task),
        *ability_parts(question.step_kinds),
        *rule_parts(question.step_kinds, "written"),
        *subgoal_parts(question.subgoals),
        *target_parts(question.targets),
        *listed("Subgoals with a helper function to follow", question.functions),
        *(words(f"Verification asked about the last version: {question.doubt}") if question.doubt else []),
    ]


def _render_function(question: WriteFunction) -> list[Part]:
    boxes = [
        f"{name}: ({box.x0:.1f}, {box.y0:.1f}, {box.x1:.1f}, {box.y1:.1f})" for name, box in question.boxes.items()
    ]
    return [
        *words(f"Subgoal {subgoal_words(question.subgoal)}"),
        *picture_parts(question.view, "the main view"),
        *listed("boxes, as (x0, y0, x1, y1) in pixels of this picture", boxes, "none"),
        *listed("What is known of the robot and its place", question.facts),
        *words(f"At most {question.max_points} points."),
        *(words(f"In the air, up is from 0 to {question.most_up_m:.2f} m.") if question.most_up_m else []),
        *_earlier_parts(question),
        *(words("Your last version:", fenced("code", question.last_code)) if question.last_code else []),
        *(words("What was wrong with it:", fenced("error", question.error)) if question.error else []),
    ]


def _earlier_parts(question: WriteFunction) -> list[Part]:
    if not question.earlier:
        return []
    first = question.earlier[0]
    mine = [f'boxes["{name}"]' for name in question.boxes][: len(first.takes)]
    given = ", ".join(f'"{name}": {box}' for name, box in zip_longest(first.takes, mine, fillvalue="(x0, y0, x1, y1)"))
    better = "; where its path is what went wrong before, compute a better one" if question.advice else ""
    return [
        *words(
            "Helper functions that were accepted earlier in this task. Your code may call them by name, each with boxes under the ids "
            f"that it was written for, as in {first.name}({{{given}}}). Where one of them computes what this subgoal asks for, "
            f"path(boxes) may just return what it gives{better}."
        ),
        *(part for one in question.earlier for part in _one_earlier(one)),
        *listed(BEFORE, question.advice),
    ]


def _one_earlier(one: EarlierFunction) -> list[Part]:
    were = "; ".join(f"{name} was {said}" for name, said in one.takes.items())
    return [
        *words(f"{one.name}: {one.purpose}" + (f" ({were})" if were else ""), fenced("code", one.code)),
        *picture_parts(one.drawn, "what it drew then, on white"),
        *_rise_parts(one.up_m),
    ]


def _rise_parts(up_m: Sequence[float]) -> list[Part]:
    rises = [f"{number}: {up:.2f}" for number, up in enumerate(up_m, start=1)]
    return listed("How far up each point lies over the height at which things are carried [m]", rises)


def _render_review_path(question: ReviewPath) -> list[Part]:
    return [
        *words(f"Subgoal {subgoal_words(question.subgoal)}"),
        *picture_parts(question.view, "the main view"),
        *(part for side in question.sides for part in picture_parts(side, "the same path from another side")),
        *_rise_parts(question.up_m),
    ]


SUPERVISOR = role(
    "supervisor",
    SYSTEM,
    Ask(DraftPlan, DRAFT, _render_draft),
    Ask(RevisePlan, REVISE, _render_revise),
    Ask(ExtractTargets, EXTRACT, _render_extract),
    Ask(WriteSteps, STEPS, _render_steps),
    Ask(WriteFunction, FUNCTION, _render_function),
    Ask(ReviewPath, REVIEW_PATH, _render_review_path),
    Ask(LocatePoints, LOCATE_POINTS, render_locate_points),
)
