"""A plan, a grounding or a trial in a few lines of text, and the exit code that says how it ended."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from wonderful_team.api.results import FoundTarget, PlanResult, TrialResult
from wonderful_team.core.actions import Action, OriginOf, Place, Step, places_of
from wonderful_team.core.text import counted, ending_words, picture_names, spoken, visible
from wonderful_team.core.values import Instruction, Plan, PlannedAction

EXIT_OF_STATUS: dict[str, int] = {
    "planned": 0,
    "draft": 0,
    "checked": 0,
    "grounded": 0,
    "not_found": 1,
    "refused": 1,
    "failed": 1,
    "budget": 5,
    "not_understood": 7,
    "needs_clarification": 7,
}
EXIT_OF_STAGE: dict[str, int] = {"gate": 4, "budget": 5}


def plan_exit_code(made: PlanResult) -> int:
    """The exit code of `plan` and `ground`."""
    if made.gate is not None and not made.gate.admitted:
        return 4
    return EXIT_OF_STATUS[made.status]


def trial_exit_code(trial: TrialResult) -> int:
    """The exit code of `run`: an unscored trial that reached its end counts as done, if anybody judged that."""
    if trial.outcome == "success" or (trial.outcome == "unscored" and trial.stage is None and trial.judged):
        return 0
    if trial.outcome == "error":
        return 6 if trial.stage == "world" else 3
    if any(report.fault for report in trial.reports) and trial.stage == "execution":
        return 6
    status = trial.plans[-1].status if trial.plans else ""
    return EXIT_OF_STAGE.get(trial.stage or "", EXIT_OF_STATUS.get(status, 1) or 1)


def plan_lines(made: PlanResult) -> list[str]:
    """What `plan` prints: how it ended, then what would run."""
    words = words_of(made.plan)
    lines = []
    if made.gate is not None and not made.gate.admitted:
        lines.append("REFUSED by the safety gate")
        lines += [f"  {reason}" for reason in made.gate.reasons]
    elif made.status not in ("planned", "grounded", "checked", "draft"):
        lines += no_plan_lines(made.plan, made.status, made.message)
    elif made.message:
        lines.append(said_of(made.plan.instruction, made.message))
    if made.actions:
        lines += [f"PLAN  {action_line(planned, words)}" for planned in made.actions]
        sources = [source for planned in made.actions for source in planned.sources]
        if any(source.tool_px is not None for source in sources):
            lines.append(
                "note: a place is where the middle of the thing lands; the tool holds it elsewhere and ends at 'tool'"
            )
        if any("a guess" in source.how for source in sources):
            lines.append("note: a push that starts where an earlier one should end is a guess; look again in between")
    else:
        lines += [f"GOAL  {subgoal.id} {said_of(made.plan.instruction, subgoal.text)}" for subgoal in made.subgoals]
        lines += [target_line(target, words) for target in made.targets]
    if made.status == "planned" and not made.subgoals:
        lines.append("note: that is the model's word for it; nothing measured it (--json: no actions)")
    if made.status == "planned" and not made.verified:
        lines.append("note: Verification did not approve this plan (--strict refuses such plans)")
    return lines


def no_plan_lines(plan: Plan, status: str, message: str) -> list[str]:
    """Why no plan came to be, and what may be meant; the same whether a photo or a world was planned for."""
    ending, said = ending_words(status, message.partition(" Choices: ")[0])
    choices = [f"  choice: {said_of(plan.instruction, choice)}" for choice in plan.choices]
    return [f"{ending.upper()}  {said_of(plan.instruction, said)}", *choices]


def said_of(instruction: Instruction, text: str) -> str:
    """A model's or a person's words for a line of a terminal: pictures by number, hidden characters as escapes."""
    return visible(spoken(text, picture_names(instruction.text, instruction.slots)))


def words_of(plan: Plan | None) -> dict[str, str]:
    """What each target of a plan is, by id, for `action_line`."""
    return {} if plan is None else {target.id: said_of(plan.instruction, target.words) for target in plan.targets}


def target_line(target: FoundTarget, words: Mapping[str, str]) -> str:
    """One target: id, words (`words` by id), box and points."""
    box = "" if target.box_px is None else "  box ({:.0f}, {:.0f}, {:.0f}, {:.0f}) px".format(*target.box_px)
    points = "".join(f"  {role} ({x:.0f}, {y:.0f}) px" for role, (x, y) in target.points_px.items())
    status = {"gave_up": "gave up", "absent": "not here", "not_grounded": "not looked for"}.get(
        target.status, target.status
    )
    return f"{target.id}  {words.get(target.id, visible(target.words))}  {status}{box}{points}"


def action_line(planned: PlannedAction, words: Mapping[str, str]) -> str:
    """One action: kind, its targets (`words` by id) with their pixels, metres where there are any."""
    pixels = {(source.role, source.target): source.point_px for source in planned.sources}
    tools = {(source.role, source.target): source.tool_px for source in planned.sources}
    alone = planned.sources[0].point_px if len(planned.sources) == 1 else None
    ends = []
    for role, place in places_of(planned.step):
        point = pixels.get((role, place.target), alone)
        at = "" if point is None else f" @ ({point[0]:.0f}, {point[1]:.0f}) px"
        tool = tools.get((role, place.target))
        at += "" if tool is None else f", tool at ({tool[0]:.0f}, {tool[1]:.0f}) px"
        ends.append(_place_words(place, words) + at)
    what = [_kind_words(planned.step), "  ->  ".join(ends), _turn(planned.step), _metres(planned.action)]
    return "  ".join(part for part in what if part)


def _kind_words(step: Step) -> str:
    said = {item.name: visible(str(getattr(step, item.name))) for item in fields(step)}
    said["tight"] = ", tight" if getattr(step, "tight", False) else ""
    said["contact"] = f" ({contact})" if (contact := getattr(step, "contact", None)) else ""
    return step.words.line.format(kind=step.kind, **said)


def _place_words(place: Place, words: Mapping[str, str]) -> str:
    target = f"{place.target} {words.get(place.target, '')}".rstrip()
    side = getattr(place, "side", None)
    if side is not None:
        return f"{side} of {target}" if side in ("left", "right") else f"{side} {target}"
    return f"where {target} stood" if isinstance(place, OriginOf) else target


def _turn(step: Step) -> str:
    degrees = getattr(step, "rotate_deg", 0.0)
    return f"turned {degrees:+g} deg clockwise" if degrees else ""


def _metres(action: Action | None) -> str:
    points = [] if action is None else [point for _, point in action.points()]
    if not points:
        return ""
    shown = points if len(points) <= 2 else [points[0], points[-1]]
    through = f" ({counted(len(points), 'point')})" if len(points) > 2 else ""
    return " -> ".join(f"({', '.join(f'{value:.3f}' for value in point)})" for point in shown) + f" m{through}"


def trial_word(trial: TrialResult) -> str:
    """How a trial ended, in capitals; in a world without a scorer the method's own judgement is all that there is."""
    # Each plan names its own subgoals: what an earlier one said of a G3 that this one has not is not its judgement.
    subgoals = [subgoal.id for subgoal in trial.plans[-1].subgoals] if trial.plans else []
    last = {verdict.subgoal: verdict.status for verdict in trial.verdicts}
    done = bool(subgoals) and all(last.get(name) == "done" for name in subgoals)
    if trial.outcome == "unscored" and trial.stage is None and done:
        return "DONE, as the team judges (no scorer)"
    return trial.outcome.upper()


def numbers_line(planned: PlannedAction) -> str:
    """What an action does, from its numbers alone: no word of a model stands in it."""
    action = planned.action
    if action is None:
        points = (
            f"{source.role} ({source.point_px[0]:.1f}, {source.point_px[1]:.1f}) px"
            + ("" if source.tool_px is None else f", tool at ({source.tool_px[0]:.1f}, {source.tool_px[1]:.1f}) px")
            for source in planned.sources
        )
        return f"{planned.step.kind}  {'  '.join(points)}"
    numbers = [_shown(item.name, getattr(action, item.name)) for item in fields(action)]
    return f"{action.kind}  {'  '.join(numbers)}".rstrip()


def _shown(name: str, value: Any) -> str:
    """A name and a number or several with their unit, which is the end of the name; waypoints count and end."""
    if isinstance(value, tuple | list) and value and is_dataclass(value[0]):
        return f"{name} ({len(value)}: first and last {'; '.join(_parts(one) for one in (value[0], value[-1]))})"
    if is_dataclass(value) and not isinstance(value, type):
        return f"{name} {_parts(value)}"
    if isinstance(value, str | bool) or value is None:
        return f"{name} {value}"
    numbers = np.round(np.asarray(value, dtype=np.float64), 3) + 0.0
    unit = next((unit for unit in ("m", "rad", "s", "px") if name.endswith(f"_{unit}")), "")
    text = np.array2string(numbers, separator=", ", threshold=64, formatter={"float_kind": lambda one: f"{one:.3f}"})
    return f"{name.removesuffix(f'_{unit}')} {text} {unit}".rstrip()


def _parts(value: Any) -> str:
    return ", ".join(_shown(item.name, getattr(value, item.name)) for item in fields(value))


def trial_lines(trial: TrialResult) -> list[str]:
    """What `run` prints: outcome, stage, reason, and how every subgoal went."""
    stage = f" at {trial.stage}" if trial.stage else ""
    said = trial.plans[-1].instruction if trial.plans else None
    names = {} if said is None else picture_names(said.text, said.slots)
    if trial.ending != trial.outcome:
        lines = no_plan_lines(trial.plans[-1], trial.ending, trial.reason)
    else:
        lines = [f"{trial_word(trial)}{stage}  {visible(spoken(trial.reason, names))}"]
    lines += [
        f"  {verdict.subgoal} {verdict.status.replace('_', ' ')}"
        + (f": {visible(spoken(verdict.cause, names))}" if verdict.cause else "")
        for verdict in trial.verdicts
    ]
    executed = sum(report.executed for report in trial.reports)
    if trial.ending != trial.outcome and not trial.runs:
        return lines
    lines.append(f"  {counted(len(trial.plans), 'plan')}, {counted(executed, 'action')} executed")
    return lines
