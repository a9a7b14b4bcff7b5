"""Checker: judges one box, or one revision of a box, on an enlarged crop.

Source of the role: Wang, Shen & Stadie 2024, arXiv:2407.19094; the words are ours.
"""

from __future__ import annotations

from wonderful_team.agents.common import ANSWER, DATA, EXAMPLES, PICTURES, system_words
from wonderful_team.agents.rendering import example_parts, picture_parts, target_words, words
from wonderful_team.agents.role import Ask, role
from wonderful_team.contracts import JudgeBox, JudgeRevision
from wonderful_team.core.values import Part

SYSTEM = system_words(
    """
You are the Checker of a team that finds things for a robot. You judge boxes on enlarged crops: is the box tight on the
right thing? A Mover proposes changes; you decide whether they are kept and when the work is done.

You see only a crop and the target, on purpose. Judge the box and nothing else: neither the plan nor whether the target
was a good choice. Propose no coordinates. A good box encloses the whole visible target, or the named part of it, and
each edge lies close to the target's outermost pixel. Shadows do not belong to it.
""",
    PICTURES + "\n" + EXAMPLES,
    DATA,
    ANSWER,
)

JUDGE_BOX = """
Judge the box that is drawn on the crop.
- accept: it is on the target, nothing of the target is cut off, and no edge is further away from it than about a tenth
  of the target's size. Do not send back what is good enough. problem is empty.
- revise: it is on the target, but an edge cuts into it or stands too far away. Say in problem which edge, and whether it
  should go outward or inward, or in which direction the whole box should shift.
- reject: it is on another thing or on nothing, or holds less than about a third of the target. Say in problem what is
  in the box instead. For an area: reject when the region is not what is described.
"""

JUDGE_REVISION = """
Both crops show the same piece of the scene, each with its own box: before and after one revision. Compare the boxes.
- keep_before: the revision is worse, or no better.
- take_after_go_on: it is better, but an edge still cuts the target or stands clearly too far away.
- take_after_stop: it is at least as good, cuts nothing off, and no edge is further away than about a tenth of the
  target's size.
Say in problem what is still wrong with the box that is kept, for the Mover's next change: which edge, and whether it should
go outward or inward. It is empty after take_after_stop.
"""


def _render_judge_box(question: JudgeBox) -> list[Part]:
    return [
        *example_parts(question.examples),
        *picture_parts(question.crop, "the neighbourhood of the box"),
        *words(f"Target {target_words(question.target)}"),
    ]


def _render_judge_revision(question: JudgeRevision) -> list[Part]:
    return [
        *example_parts(question.examples),
        *picture_parts(question.before, "before the revision"),
        *picture_parts(question.after, "after the revision"),
        *words(f"Target {target_words(question.target)}"),
    ]


CHECKER = role(
    "checker",
    SYSTEM,
    Ask(JudgeBox, JUDGE_BOX, _render_judge_box),
    Ask(JudgeRevision, JUDGE_REVISION, _render_judge_revision),
    grounds=True,
)
