"""Memory: asked only where something was decided that the plan does not show; and a task that nobody solves without it."""

from __future__ import annotations

import asyncio
import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from tests.planning.helpers import APPROVED, asked, doubt, draft, plan_with, scripted, subgoal
from tests.planning.rounds import photo
from tests.planning.stub_model import stub_script
from tests.runtime.runtime_fakes import COLOURS, HALF_PX, SIZE_PX, SquaresTruth, SquaresWorld
from wonderful_team.core.actions import ARM, PICK_PLACE
from wonderful_team.core.values import Instruction, Observation, Request, StepReport, View
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.runtime import rollout

MODES = pytest.mark.parametrize("mode", ["lean", "paper"])


def remembered(model: ScriptedModel) -> list[str]:
    """What Memory was asked about, in words."""
    return [f"{r.question.asked} | {r.question.answered}" for r in asked(model, "Remember")]


@MODES
def test_a_plain_plan_asks_memory_nothing(mode):
    model = scripted()
    assert plan_with(model, TeamConfig(mode=mode)).status == "planned"
    assert remembered(model) == []


@MODES
def test_a_settled_doubt_is_told_to_memory_with_question_answer_and_reasoning(mode):
    answer = {"reasoning": "its lid lies beside it", "decision": "keep", "answer": "The box is open.", "plan": None}
    model = scripted(ReviewPlan=[doubt(question="is the box open?"), APPROVED], RevisePlan=answer)
    plan_with(model, TeamConfig(mode=mode, thorough=True))
    (told,) = remembered(model)
    for part in ("G1", "is the box open?", "The box is open.", "its lid lies beside it"):
        assert part in told


@MODES
def test_a_rejected_box_is_told_to_memory_with_what_was_wrong(mode):
    turns = iter([{"reasoning": "", "decision": "reject", "problem": "that is the striped one"}])
    accept = {"reasoning": "", "decision": "accept", "problem": ""}
    model = scripted(JudgeBox=lambda r: next(turns, accept) if r.question.target.id == "T1" else accept)
    plan_with(model, TeamConfig(mode=mode, thorough=True))
    (told,) = remembered(model)
    assert "T1" in told
    assert "that is the striped one" in told
    assert told.endswith("In the end: found.")


def test_a_look_alike_that_was_chosen_is_told_to_memory():
    def unsure(request: Request) -> dict[str, Any]:
        reading = stub_script()["ReadScene"](request)
        reading["targets"][0]["unsure"] = "the one behind it looks the same"
        return reading

    model = scripted(ReadScene=unsure)
    plan_with(model, TeamConfig(mode="lean"))
    (told,) = remembered(model)
    assert "the one behind it looks the same" in told


@MODES
@pytest.mark.parametrize(
    ("said", "count"), [("turn it by 40 degrees into the second thing", 0), ("turn it upright", 1)]
)
def test_an_angle_is_told_to_memory_only_where_no_words_state_it(mode, said, count):
    turned = {"pick": "T1", "place": {"target": "T2", "how": "at", "side": None}, "rotate_deg": 40}
    plan = draft(subgoal("G1", move=turned))
    model = scripted(DraftPlan={**plan, "reasoning": "its arm points down"}, WriteSteps=_turning_steps)
    team = TeamPolicy(model, TeamConfig(mode=mode))
    made = asyncio.run(team.make_plan(photo(), Instruction(said), PICK_PLACE))
    assert made.status == "planned", made.message
    told = remembered(model)
    assert len(told) == count
    assert all("40 degrees clockwise" in line and "its arm points down" in line for line in told)


def _turning_steps(request: Request) -> dict[str, Any]:
    steps = stub_script()["WriteSteps"](request)
    steps["steps"][0]["rotate_deg"] = 40
    return steps


def test_a_criticised_function_is_told_to_memory():
    plan = draft(subgoal("G1", targets=["T1"], function="a path round T1"))
    model = scripted(
        DraftPlan=plan,
        WriteFunction={"reasoning": "wider now", "code": "def path(boxes):\n    return [(10, 20), (30, 40)]"},
        ReviewPath=[
            {"reasoning": "", "accepted": False, "problem": "it cuts the corner"},
            {"reasoning": "", "accepted": True, "problem": ""},
        ],
        WriteSteps={"reasoning": "", "steps": [{"kind": "follow", "subgoal": "G1", "function": "G1"}]},
    )
    assert plan_with(model, TeamConfig(mode="lean"), vocabulary=ARM).status == "planned"
    (told,) = remembered(model)
    assert "it cuts the corner" in told
    assert "wider now" in told


def test_memory_reaches_other_roles_and_setting_8_has_none():
    def sources(ablation: str) -> set[str]:
        model = scripted(ReviewPlan=[doubt(), APPROVED])
        plan_with(model, TeamConfig(mode="paper", ablation=ablation))
        return {note.source for request in model.requests for note in request.notes}

    assert "memory" in sources("full")
    assert "memory" not in sources("s8")


# -- a task that needs it: which block was marked before the mark fell off --------------------------------------------


MARK_PX = 3
GOAL = (200.0, 40.0)


@dataclass
class MarkedWorld(SquaresWorld):
    """Two blue blocks, one with a red mark on it. The first grip slips, and the mark falls off."""

    marked: str = "left"
    squares: dict[str, tuple[float, float]] = field(
        default_factory=lambda: {"left": (60.0, 70.0), "right": (140.0, 70.0)}
    )
    instruction: Instruction = Instruction("put the marked blue block at the upper right")

    def observe(self) -> Observation:
        rgb = np.full((128, 256, 3), 150, dtype=np.uint8)
        for name, (x, y) in self.squares.items():
            _paint(rgb, x, y, HALF_PX, COLOURS["blue"])
            if name == self.marked and not self.ran:
                _paint(rgb, x, y, MARK_PX, COLOURS["red"])
        seen = super().observe().main
        return Observation({"top": View("top", "top", 0.1 * self.ran, rgb, camera=seen.camera)})

    def execute(self, action: Any) -> StepReport:
        if not self.ran:
            self.ran += 1
            return StepReport(action, True, {"held": False})
        return super().execute(action)


def _paint(rgb: np.ndarray, x: float, y: float, half: int, colour: tuple[int, int, int]) -> None:
    rgb[round(y) - half : round(y) + half, round(x) - half : round(x) + half] = colour


COLOURS.update({"left": COLOURS["blue"], "right": COLOURS["blue"]})


def _pixels(rgb: np.ndarray, colour: str) -> list[tuple[float, float]]:
    rows, columns = np.nonzero(np.abs(rgb.astype(int) - COLOURS[colour]).max(axis=2) < 30)
    return list(zip(columns.astype(float), rows.astype(float), strict=True))


def _blocks(rgb: np.ndarray) -> dict[str, tuple[float, float]]:
    """The middles of both blocks, by side: what anybody sees in the picture."""
    found = _pixels(rgb, "blue") + _pixels(rgb, "red")
    middle = sum(x for x, _ in found) / len(found)
    sides = {"left": [p for p in found if p[0] < middle], "right": [p for p in found if p[0] >= middle]}
    return {side: tuple(np.mean(points, axis=0)) for side, points in sides.items()}  # type: ignore[misc]


def _marked_side(rgb: np.ndarray) -> str | None:
    red = _pixels(rgb, "red")
    return None if not red else min(_blocks(rgb), key=lambda side: abs(_blocks(rgb)[side][0] - red[0][0]))


def _drafts(request: Request) -> dict[str, Any]:
    """Plan for the block that bears the mark; where none does any more, for the one that the notes tell of."""
    told = re.findall(r"the (left|right) one", " ".join(note.text for note in request.notes))
    words = "the blue block with the red mark"
    if _marked_side(request.question.task.main.rgb) is None:
        if not told:
            asking = {"question": "Which blue block was marked?", "choices": ["left", "right"]}
            return {**draft(), "clarification": asking}
        words = f"the {told[-1]} blue block"
    plan = draft(subgoal("G1"), words=words)
    plan["targets"][1].update(kind="area", words="the upper right")
    return {**plan, "unsure": "two blue blocks look the same but for the mark"}


def _reviews(request: Request) -> dict[str, Any]:
    question = request.question
    vague = question.targets[0].words == "the blue block with the red mark" and not question.checked
    return doubt("G1", "Two blocks look the same: which one?") if vague else APPROVED


def _answers(request: Request) -> dict[str, Any]:
    side = _marked_side(request.question.task.main.rgb)
    return {
        "reasoning": "the red mark lies on it",
        "decision": "keep",
        "answer": f"It is the {side} one.",
        "plan": None,
    }


def _reads(request: Request) -> dict[str, Any]:
    rgb, targets = request.question.view.rgb, []
    # Small views are shown enlarged.
    scale = rgb.shape[1] / SIZE_PX[0]
    for target in request.question.targets:
        side = _marked_side(rgb) if "mark" in target.words else target.words.split()[1]
        x, y = (scale * GOAL[0], scale * GOAL[1]) if target.kind == "area" else _blocks(rgb)[str(side)]
        half = scale * HALF_PX
        box = {"x0": x - half, "y0": y - half, "x1": x + half, "y1": y + half}
        points = [{"role": role, "point": {"x": x, "y": y}} for role in target.roles]
        targets.append({"id": target.id, "found": True, "box": box, "points": points})
    return {"reasoning": "", "targets": targets}


def _outcome(request: Request) -> dict[str, Any]:
    rows = {round(y) for _, y in _blocks(request.question.after[0].rgb).values()}
    verdict = {"subgoal": "G1", "status": "done", "cause": None, "evidence": "one block lies higher"}
    if len(rows) == 1:
        verdict.update(status="not_done", cause="the grip slipped", evidence="no block has moved")
    return {"reasoning": "", "verdicts": [verdict]}


@pytest.mark.parametrize("side", ["left", "right"])
def test_what_was_seen_only_at_the_first_look_is_known_to_the_full_team_and_lost_without_memory(side):
    def outcome(ablation: str) -> Any:
        world = MarkedWorld(marked=side)
        advice = {"reasoning": "", "decision": "replan", "cause": "the grip slipped", "advice": "Try once more."}
        model = scripted(
            DraftPlan=_drafts, ReviewPlan=_reviews, RevisePlan=_answers, ReadScene=_reads, JudgeOutcome=_outcome,
            Replan=advice,
        )  # fmt: skip
        team = TeamPolicy(model, TeamConfig(ablation=ablation))
        return rollout(team, world, replans=1, scorer=SquaresTruth(world, {side: GOAL}), max_age_s=None)

    full = outcome("full")
    assert full.outcome == "success", full.reason
    without = outcome("s8")
    assert without.outcome != "success"
    assert "Which blue block was marked?" in without.reason
