"""Checker: judges one box, or one revision of a box, on an enlarged crop.

Source of the role: Wang, Shen & Stadie 2024, arXiv:2407.19094; the words are ours.
"""

from __future__ import annotations

from dataclasses import replace

from wonderful_team.agents.common import ANSWER, DATA, EXAMPLES, PICTURES, system_words
from wonderful_team.agents.rendering import example_parts, picture_parts, target_words, words
from wonderful_team.agents.role import Ask, role
from wonderful_team.contracts import JudgeBox, JudgeBoxes, JudgeRevision, ShownSlot, Tolerance
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Part, Words
from wonderful_team.images import line_width_px

SYSTEM = system_words(
    """
You are the Checker of a team that finds things for a robot. You judge boxes on enlarged crops, and the points at which
the robot would act: is the box tight on the right thing, and would it work at these points? A Mover proposes changes of
boxes; you decide whether they are kept and when the work is done.

You see only a crop and the target, on purpose. Judge the box and its points and nothing else: neither the plan nor
whether the target was a good choice. Propose no coordinates. A good box encloses the whole visible target, or the named
part of it, and each edge lies close to the target's outermost pixel. Shadows do not belong to it.
""",
    PICTURES + "\n" + EXAMPLES,
    DATA,
    ANSWER,
)

JUDGE_BOX = """
Judge the box that is drawn on the crop. An edge of the box is the middle of the drawn line; how far it may lie off,
inwards and outwards, is stated with the target.
- accept: it is on the target, and every edge is within these limits. Do not send back what is good enough. problem is
  empty.
- revise: it is on the target, but an edge cuts into it or stands away from it by more. Say in problem which edge, and
  whether it should go outward or inward, or in which direction the whole box should shift.
- reject: it is on another thing or on nothing, or holds less than about a third of the target. Say in problem what is
  in the box instead.
{% if areas %}
  For an area: reject when the region is not what is described{% if examples %}, or, where the same part of the instruction's
  scene is shown, not where that scene has it{% endif %}.
{% endif %}
{% if whole %}
- Where the whole view is shown, look there whether this is the one of several that the target's "where" means.
{% endif %}

{% if picked or placed or pushed %}
Judge every point that is drawn, by the use that stands at it. List in wrong_points those that would not work:
{% endif %}
{% if picked %}
- pick, grasp: it has to lie on the solid surface of the target itself, not in a hole, not beside it, not on something
  that covers it. It need not be exactly in the middle.
{% endif %}
{% if placed %}
- place: it has to lie inside the container, on the surface or in the free space that is described{% if examples %}; where the
  same part of the instruction's scene is shown, in the middle of what lies there{% endif %}. A lid or a thing that covers a
  place now is no reason against it: the plan says whether it leaves first.
{% endif %}
{% if pushed %}
- push_start: beside the target, clear of it; of an area, inside it. push_end: where something can be pushed to.
{% endif %}
"""

JUDGE_BOXES = f"""
Several boxes are shown, each on a crop of its own with its own target. Judge each as if it were the only one: do not
compare them, and do not let one verdict sway another. Answer every target once, by its id. What holds for each box:

{JUDGE_BOX.strip()}
"""

JUDGE_REVISION = """
Both crops show the same piece of the scene, each with its own box: before and after one revision. Compare the boxes.
An edge of a box is the middle of the drawn line; how far it may lie off, inwards and outwards, is stated with the target.
- keep_before: the revision is worse, or no better.
- take_after_go_on: it is better, but an edge still lies off by more than the limits.
- take_after_stop: it is at least as good, and every edge is within the limits.
Say in problem what is still wrong with the box that is kept, for the Mover's next change: which edge, and whether it should
go outward or inward. It is empty after take_after_stop.
"""


def _exactness_parts(question: JudgeBox) -> list[Part]:
    if question.target.kind == "area" and question.goal is None:
        return words(
            "It is described in words alone and has no exact edges: any box that lies in what is described will do."
        )
    return _tolerance_parts(question.crop)


def _tolerance_parts(picture: Picture) -> list[Part]:
    return [Words(Tolerance.on(picture).words(line_width_px(picture)), "tolerance", picture)]


def _render_judge_box(question: JudgeBox) -> list[Part]:
    later = "they are chosen later" if question.target.roles else "only the outline is needed"
    uses = ", ".join(question.uses) or f"none; {later}"
    return [
        *example_parts(_examples(question)),
        *_optional(question.alike, "another thing of the same description, whose box was accepted"),
        *_optional(question.whole, "the whole main view, to see which one it is"),
        *_optional(question.goal, "the same part of the instruction's scene, with the same box and points"),
        *picture_parts(question.crop, "the neighbourhood of the box"),
        *words(f"Target {target_words(question.target)}"),
        *_exactness_parts(question),
        *words(f"Points drawn, by their use: {uses}."),
    ]


def _examples(question: JudgeBox) -> tuple[ShownSlot, ...]:
    """The example pictures, but for the part of a scene that is shown beside the crop."""
    return tuple(slot for slot in question.examples if question.goal is None or slot.pictures != (question.goal,))


def _optional(picture: Picture | None, about: str) -> list[Part]:
    return [] if picture is None else picture_parts(picture, about)


def _render_judge_boxes(question: JudgeBoxes) -> list[Part]:
    examples: dict[str, ShownSlot] = {slot.name: slot for item in question.boxes for slot in _examples(item)}
    parts = example_parts(tuple(examples.values()))
    for number, item in enumerate(question.boxes, start=1):
        parts += words(f"Box {number} of {len(question.boxes)}, for {item.target.id}:")
        parts += _render_judge_box(replace(item, examples=()))
    return parts


def _render_judge_revision(question: JudgeRevision) -> list[Part]:
    return [
        *example_parts(question.examples),
        *([] if question.before is None else picture_parts(question.before, "before the revision")),
        *picture_parts(question.after, "after the revision"),
        *words(f"Target {target_words(question.target)}"),
        *_tolerance_parts(question.after),
    ]


CHECKER = role(
    "checker",
    SYSTEM,
    Ask(JudgeBox, JUDGE_BOX, _render_judge_box),
    Ask(JudgeBoxes, JUDGE_BOXES, _render_judge_boxes),
    Ask(JudgeRevision, JUDGE_REVISION, _render_judge_revision),
    grounds=True,
)
