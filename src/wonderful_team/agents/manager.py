"""Grounding Manager: finds targets in the main view: points, boxes, action points, or "not here".

Source of the role: Wang, Shen & Stadie 2024, arXiv:2407.19094; the words are ours.
"""

from __future__ import annotations

from typing import Literal

from wonderful_team.agents.common import ANSWER, DATA, EXAMPLES, INSTRUCTION, PICTURES, system_words
from wonderful_team.agents.rendering import (
    answer_in,
    example_parts,
    fenced,
    listed,
    picture_parts,
    target_parts,
    target_words,
    view_parts,
    words,
)
from wonderful_team.agents.role import Ask, role
from wonderful_team.agents.strips import strip_parts
from wonderful_team.contracts import ChooseMark, ChoosePoint, GiveBox, LocatePoints, Presence, ReadScene, ReadTurn
from wonderful_team.core.values import Part, Target

SYSTEM = system_words(
    """
You are the Grounding Manager of a team that plans for a robot. You find the plan's targets in the main view and choose
the points at which the robot acts. Be exact: what you say may stand as it is.

Do not change the plan, and do not swap a target for a thing that merely resembles it. If a target is not in the picture,
say so: "not here" is a useful answer, a guess is not.
""",
    PICTURES + "\n" + EXAMPLES,
    DATA + "\n" + INSTRUCTION,
    ANSWER,
)

LOCATE_POINTS = """
Point at the target in the picture that is named for the answer.
{% if centre %}
- Give the middle of the visible target{% if parts %} (of the part that is named){% endif %}.
{% if picked %}
- The point must lie on its solid material: of a ring, a frame or an L-shaped thing take the middle of that arm or side
  which is nearest to its centre, never a hole or a gap.
{% endif %}
{% if pushed %}
- For push_start give a point just beside it, on the side away from where it should go.
{% endif %}
{% if several %}
- Several points only for several places where this one target could be, the most likely first.
{% endif %}
{% else %}
- Give points at which the middle of something can come to lie, in the middle of the container, surface or
  free space that is meant. See it as it will be once the earlier subgoals are done: what leaves before does not count,
  so do not move into a corner to avoid it. Stay clear of what remains, of the edges, and of regions that nothing may
  enter.
{% if examples %}
- A place that the picture of a scene defines has the same position there, if both pictures are taken from the same point
  of view; else find it by what stands round it.
{% endif %}
{% endif %}
{% if rejected %}
- Points that are labelled on the picture as rejected were wrong: choose elsewhere, and not on the thing that was
  rejected there. What was said of them tells why.
{% endif %}
- found is false, without points, when you cannot see the target or no such space exists. Do not guess.
"""

CHOOSE_MARK = """
Several independent guesses are numbered on the picture. Choose the number whose point fits the target best.
{% if centre %}
- The point must lie on the target itself{% if picked %}, on solid material, never in a hole{% endif %}; of several that do,
  the one nearest to its middle.
{% else %}
- The point nearest to the middle of the container, surface or free space that is meant, as it will be once the earlier
  subgoals are done.
{% endif %}
- number is null when no numbered point is on the target. Look at the scene, not at the numbers' order; of points that
  lie on one spot take any.
"""

GIVE_BOX = """
Draw a box round the target whose centre is marked by a point.
- Tight: each edge touches the outermost visible pixel of the target. The whole target, but not its shadow, and nothing
  that merely touches it.
{% if parts %}
- Box only the part that is named.
{% endif %}
{% if areas %}
- For an area, box the free or described region.
{% endif %}
- If the marked point is off but the target is near, box the target where it really is.
- box is null when the target is not in the picture.
"""

READ_SCENE = """
Find every target in the picture that is named for the answer: for each one a box and one point for each use it lists.
- Box: tight round the visible target, without its shadow{% if parts %} (only the part, where one is named){% endif %}.
{% if areas %}
  For an area: round the free or described region.
{% endif %}
{% if picked %}
- Point for pick or grasp: on the solid surface of the target itself, near its middle. For ring-shaped or L-shaped
  things, the middle of the box may be a hole: stay on the material.
{% endif %}
{% if placed %}
- Point for place: where the middle of what goes there should lie: the middle of the container's inside, of the surface, or
  of the free space, as it will be once the earlier subgoals are done. What leaves before does not count: do not move
  into a corner to avoid it. Never in a region that nothing may enter.
{% endif %}
{% if pushed %}
- push_start: where the front of the tool comes down, beside the thing, on the side away from where it should go.
  push_end: where the front of the tool stops; the thing then lies before it.
{% endif %}
{% if examples %}
- A place that the picture of a scene defines: find it by what stands round it in both pictures; where both are taken from
  the same point of view, its position is the same.
{% endif %}
- Two targets are the same spot only if the plan means the same thing.
- found is false, with a null box and no points, when a target is not in the picture. Do not guess.
- unsure: what makes you doubt that this is the right thing or the right outline, such as another one that fits the words
  as well, or a thing that is half hidden; it is then looked at more closely. Empty when nothing does.
Answer every target once, by its id.
"""

PRESENCE = """
For each edge of the target's box you see a strip of the scene along it, on both sides of the line where the edge lies. Say
for each edge whether any of the target shows on the inner side of the line, and whether any shows on the outer side.
- Only the target itself counts{% if parts %} (only the part that is named){% endif %}: not its shadow, not another thing, not the background.
- What only touches the line does not show beyond it. A side that is missing lies outside the view: answer false for it.
Answer all four edges, each once.
"""

CHOOSE_POINT = """
Choose the numbered point at which the robot should act on the target. The final box is drawn on the crop.
{% if picked %}
- pick or grasp: on the solid surface of the target, near its middle, where nothing else covers it. Never a hole, never
  the background inside the box.
{% endif %}
{% if placed %}
- place: where the middle of what goes there should lie: the middle of the container's inside, of the surface, or of the
  free space, as it will be once the earlier subgoals are done, never a corner.
{% endif %}
{% if pushed %}
- push_start: where the front of the tool comes down, just beside the thing, on the side away from where it should go: an
  arrow from the box points there, and the whole view shows it. push_end: where the front of the tool stops; the thing then
  lies before it.
{% endif %}
{% if rejected %}
- A point that is labelled as rejected was wrong; what was said of it tells why. Choose one that is free of this fault.
{% endif %}
{% if fine %}
- The points lie close together; choose the one that is most precisely right.
{% endif %}
"""

READ_TURN = """
The picture shows on its left, marked goal, how the target is to lie in the end. Beside it the same thing is cut out as it
lies at first and turned by growing angles, each with its number. Choose the number whose cut-out lies most nearly as the
goal does.
- Compare by what has a direction: a tip, a notch, an opening, the arms of a letter, the way its stripes run. Look where
  it points in the goal, and which cut-out points there too.
- Compare how things are turned, not where they lie in their pictures, nor what lies beside them.
{% if fine %}
- The turns differ little; compare the slant of long edges.
{% endif %}
- number is null when none lies as the goal does, as for another thing.
"""

_WANTED: dict[Literal["centre", "place"], str] = {
    "centre": "the centre of the target",
    "place": "a place at which something can be put down",
}


def _target_parts(target: Target) -> list[Part]:
    return words(f"Target {target_words(target)}")


def _plan_parts(plan: tuple[str, ...], instruction: str) -> list[Part]:
    """What the plan is for, and the plan."""
    wanted = words("The user's instruction:", fenced("instruction", instruction)) if instruction else []
    return [*wanted, *listed("The plan", plan, "not stated")]


def _rejected_parts(lines: tuple[str, ...]) -> list[Part]:
    return listed("What was said of the points marked as rejected", lines)


def render_locate_points(question: LocatePoints) -> list[Part]:
    count = "exactly one point" if question.count == 1 else f"at most {question.count} points"
    return [
        *picture_parts(question.view, "the main view"),
        *view_parts("Other views", question.context, "another view, for understanding only"),
        *_plan_parts(question.plan, question.instruction),
        *example_parts(question.examples),
        *_target_parts(question.target),
        *_rejected_parts(question.rejected),
        *words(f"Wanted: {_WANTED[question.purpose]}; {count} if it is there."),
        *answer_in(question.view),
    ]


def _render_choose_mark(question: ChooseMark) -> list[Part]:
    return [
        *picture_parts(question.view, "the main view"),
        *_plan_parts(question.plan, question.instruction),
        *example_parts(question.examples),
        *_target_parts(question.target),
        *words(f"Wanted: {_WANTED[question.purpose]}."),
    ]


def _render_give_box(question: GiveBox) -> list[Part]:
    return [
        *picture_parts(question.view, "the main view"),
        *_plan_parts(question.plan, question.instruction),
        *example_parts(question.examples),
        *_target_parts(question.target),
        *_rejected_parts(question.rejected),
        *answer_in(question.view),
    ]


def _render_read_scene(question: ReadScene) -> list[Part]:
    return [
        *picture_parts(question.view, "the main view"),
        *view_parts("Other views", question.context, "another view, for understanding only"),
        *_plan_parts(question.plan, question.instruction),
        *example_parts(question.examples),
        *target_parts(question.targets),
        *answer_in(question.view),
    ]


def _render_presence(question: Presence) -> list[Part]:
    return [*example_parts(question.examples), *_target_parts(question.target), *strip_parts(question.strips)]


def _render_choose_point(question: ChoosePoint) -> list[Part]:
    turn = "second round, fine" if question.fine else "first round, coarse"
    whole = [] if question.whole is None else picture_parts(question.whole, "the whole main view, to see where it goes")
    return [
        *whole,
        *picture_parts(question.crop, "the neighbourhood of the target"),
        *_plan_parts(question.plan, question.instruction),
        *example_parts(question.examples),
        *_target_parts(question.target),
        *_rejected_parts(question.rejected),
        *words(f"Wanted: the point for {question.role} ({turn})."),
    ]


def _render_read_turn(question: ReadTurn) -> list[Part]:
    turn = "second round, fine" if question.fine else "first round, coarse"
    turns = "; ".join(f"{number} is {turn:g}" for number, turn in enumerate(question.turns, start=1))
    return [
        *picture_parts(question.strip, f"the goal and the turned cut-outs, from {question.shows}"),
        *_target_parts(question.target),
        *words(f"Degrees by which each cut-out is turned, clockwise ({turn}): {turns}."),
    ]


MANAGER = role(
    "manager",
    SYSTEM,
    Ask(LocatePoints, LOCATE_POINTS, render_locate_points),
    Ask(ChooseMark, CHOOSE_MARK, _render_choose_mark),
    Ask(GiveBox, GIVE_BOX, _render_give_box),
    Ask(ReadScene, READ_SCENE, _render_read_scene),
    Ask(Presence, PRESENCE, _render_presence),
    Ask(ChoosePoint, CHOOSE_POINT, _render_choose_point),
    Ask(ReadTurn, READ_TURN, _render_read_turn),
    grounds=True,
)
