"""Mover: moves or resizes one box on an enlarged crop.

Source of the role: Wang, Shen & Stadie 2024, arXiv:2407.19094; the words are ours.
"""

from __future__ import annotations

from wonderful_team.agents.common import ANSWER, DATA, EXAMPLES, PICTURES, system_words
from wonderful_team.agents.rendering import amounts_in, example_parts, listed, picture_parts, target_words, words
from wonderful_team.agents.role import Ask, role
from wonderful_team.agents.strips import strip_parts
from wonderful_team.contracts import MoveBox
from wonderful_team.core.values import Part

SYSTEM = system_words(
    """
You are the Mover of a team that finds things for a robot. You improve one box at a time on an enlarged crop: you shift
it or move single edges until it is tight on the target. A Checker judges each of your changes.

You see only the crop, thin strips along the box's edges and the target, on purpose. Change the box and nothing else.
Make each change as large as it has to be to be right at once: timid steps use up the few rounds there are.
""",
    PICTURES + "\n" + EXAMPLES,
    DATA,
    ANSWER,
)

MOVE_BOX = """
Propose one revision of the box that is drawn on the crop. Read where its edges and the target lie off the tick labels.
- move, when the box has about the right size but lies beside the target: right_px and down_px for the whole box
  (negative is left, up); the grow amounts are 0.
- resize, when single edges are wrong: for each edge how far it goes outward, away from the box's middle (negative is
  inward); right_px and down_px are 0.
- stop, only where it is offered: the box is tight and cuts nothing off; all amounts are 0.
- Use the strips: target outside the line of an edge means that this edge has to go outward; no target inside the line means
  that it has to go inward. Do not repeat a change that the history shows as refused.
- cut_edges: the edges at which the target reaches past the box as it is drawn now.
The box after the change must still lie in the crop, and the change must not be zero.
"""


def _render_move_box(question: MoveBox) -> list[Part]:
    stop = "offered: you decide yourself when the box is right" if question.may_stop else "not offered"
    return [
        *example_parts(question.examples),
        *picture_parts(question.crop, "the neighbourhood of the box"),
        *strip_parts(question.strips),
        *words(f"Target {target_words(question.target)}"),
        *amounts_in(question.crop),
        *(words(f"What the Checker found wrong: {question.problem}") if question.problem else []),
        *listed("Earlier revisions of this box", question.history, "none"),
        *words(f"Stop is {stop}."),
    ]


MOVER = role("mover", SYSTEM, Ask(MoveBox, MOVE_BOX, _render_move_box), grounds=True)
