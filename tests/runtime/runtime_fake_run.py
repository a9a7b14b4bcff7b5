"""A complete run with requests, questions, a replan and warnings, for looking at the page and testing it."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

from tests.runtime.runtime_fakes import HALF_PX, SquaresWorld, make_plan
from wonderful_team.contracts import BoxVerdict, DraftPlan, JudgeBox, LocatePoints, PlanDraft, ReadScene, ShownTask
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, BoxMark, Candidates
from wonderful_team.core.protocols import Act, Decision, Done, Event, Situation, Subscriber
from wonderful_team.core.values import (
    Answer,
    Critique,
    Instruction,
    KeepOut,
    Limits,
    Request,
    Slot,
    Subgoal,
    Target,
    Usage,
    Verdict,
    View,
    Words,
)
from wonderful_team.images import crop, whole


def world_with_pictures(
    text: str = "put the {red_thing} at the upper right, then the blue square in its place",
) -> SquaresWorld:
    """A world whose instruction has a picture and whose table has a keep-out region."""
    world = SquaresWorld()
    rgb = world.observe().main.rgb[44:76, 44:76]
    slot = Slot("red_thing", "object", {"top": View("slot:red_thing:top", "top", 0.0, rgb)})
    world.instruction = Instruction(text, {"red_thing": slot} if "{red_thing}" in text else {})
    world.limits = Limits((0.25, -0.5, 0.0), (0.75, 0.5, 0.3), (KeepOut("cable", Box(100, 100, 130, 124)),))
    return world


@dataclass
class TalkingPolicy:
    """Plans twice: the second square first goes to a wrong place. Every question and answer is told."""

    subscribers: Sequence[Subscriber]
    name: str = "team"
    model_name: str = "offline"
    words: str = "Plan the task."
    secret: str = ""
    pause_s: float = 0.0
    asked: int = 0

    def decide(self, situation: Situation) -> Decision:
        if situation.attempt == 2:
            return Done("both squares stand where they should", self._verdicts("done"))
        moves = [((60.0, 60.0), (200.0, 30.0)), ((160.0, 90.0), (80.0, 90.0))]
        if situation.attempt == 1:
            moves = [((80.0, 90.0), (60.0, 60.0))]
        self._talk(situation)
        plan = make_plan(situation.observation, moves, instruction=situation.instruction)
        if situation.attempt == 0:
            doubt = Critique(
                "G2", "missing_prerequisite", "Is the place free before G1?", "No, so G2 comes after G1.", True
            )
            goals = (plan.subgoals[0], replace(plan.subgoals[1], after=("G1",)))
            draft = (Subgoal("G1", "grab square 1"), plan.subgoals[1], Subgoal("G3", "look again"))
            plan = replace(
                plan, questions=(doubt,), subgoals=goals, first_draft=draft, warnings=("bound of 5 reached",)
            )
        self._tell("plan", plan.id, plan)
        self._tell("stage", "actions", {"text": f"{len(plan.actions)} actions", "attempt": situation.attempt})
        return Act(plan.actions, plan, self._verdicts("not_done") if situation.attempt else ())

    def _verdicts(self, second: str) -> tuple[Verdict, ...]:
        cause = None if second == "done" else "it was put 20 px too far right"
        return Verdict("G1", "done", None, "at its place"), Verdict("G2", second, cause, "seen in the after picture")  # type: ignore[arg-type]

    def _talk(self, situation: Situation) -> None:
        view = situation.observation.main
        attempt = situation.attempt
        scene = whole(view, "top view", marks=(Axes(),))
        task = ShownTask(situation.instruction.text, (scene,))
        draft = PlanDraft(reasoning="two squares", subgoals=[], targets=[], mode="one_step", clarification=None)
        parts = (Words(self.words + self.secret), Words(situation.instruction.text), scene)
        question = DraftPlan(task, ("pick_place",), with_targets=True)
        request = Request(f"{attempt}/plan/main/DraftPlan/1", "plan", "supervisor", question, parts, PlanDraft)
        self._exchange(request, Answer(draft, Usage(1, 900, 0, 0, 120, 1), "offline", '{"a": 1}', provenance="offline"))
        self._tell("stage", "draft", {"text": "2 subgoals, 4 targets", "attempt": attempt})
        targets = tuple(Target(f"T{n}", "object", "square") for n in (1, 3))
        self._together(view, attempt, targets)
        self._tell("stage", "grounded", {"text": "T1 square (found)   T3 square (found)", "attempt": attempt})
        self._tell("warning", "planning", "weak depth near T3")

    def _together(self, view: View, attempt: int, targets: Sequence[Target]) -> None:
        sent = []
        for target, centre in zip(targets, ((60.0, 60.0), (160.0, 90.0)), strict=True):
            box = Box.around(centre, 2 * HALF_PX, 2 * HALF_PX)
            picture = crop(view, box, f"crop {target.id}")
            marked = picture.marked(
                Axes(), BoxMark(picture.frame.box_to_picture(box)), Candidates(((100, 100), (200, 150)))
            )
            parts = (Words(f"Target: {target.words}"), marked)
            request = Request(
                f"{attempt}/ground/{target.id}/JudgeBox/1",
                "ground",
                "checker",
                JudgeBox(target, marked),
                parts,
                BoxVerdict,
            )
            self._tell("request", request.id, request)
            sent.append(request)
            self._wait()
        self._wait()
        first = sent[0]
        self._tell("invalid", first.id, (first, '{"decision": "good"}', "decision: should be accept, revise or reject"))
        again = replace(first, attempt=1, feedback="decision: should be accept, revise or reject")
        self._tell("request", again.id, again)
        self._wait()
        verdict = BoxVerdict(reasoning="tight", decision="accept", problem="", wrong_points=[])
        for request in (sent[1], again):
            answer = Answer(
                verdict, Usage(1, 400, 0, 0, 30, 1, usd=None), "offline", provenance="offline", repairs=("box clamped",)
            )
            self._tell("answer", request.id, (request, answer))
            self._wait()

    def _exchange(self, request: Request, answer: Answer) -> None:
        self._tell("request", request.id, request)
        self._wait()
        self._tell("answer", request.id, (request, answer))

    def _wait(self) -> None:
        time.sleep(self.pause_s)

    def _tell(self, kind: str, name: str, content: object) -> None:
        for subscriber in self.subscribers:
            subscriber.on_event(Event(kind, name, content))


__all__ = ["LocatePoints", "ReadScene", "TalkingPolicy", "world_with_pictures"]
