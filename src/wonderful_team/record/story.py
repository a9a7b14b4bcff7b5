"""A recorded trial as its method lived it: the situations it was asked in, without a world."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice, zip_longest
from pathlib import Path
from typing import Any

from wonderful_team.core.actions import Action, Home, Vocabulary
from wonderful_team.core.protocols import Situation
from wonderful_team.core.values import GOING_HOME, GateCheck, GateReport, Observation, Plan, StepReport, SubgoalRun
from wonderful_team.errors import ConfigError
from wonderful_team.record.setup import Setup, same_limits
from wonderful_team.record.stored import stored_instruction, stored_observation, stored_plan

Record = Mapping[str, Any]
_NOTHING = {"gates": 0, "executions": 0, "subgoals": 0}


@dataclass(frozen=True, eq=False)
class Asked:
    """One time that a method was asked.

    Attributes:
        check: It was asked whether the rest of its plan still makes sense, not what to do.
    """

    situation: Situation
    check: bool


def situations(folder: Path, record: Record, setup: Setup) -> Iterator[Asked]:
    """What the method was told each time that it was asked what to do or whether to go on, in order.

    Raises:
        ConfigError: The record does not hold what is needed; names what.
    """
    instruction = stored_instruction(folder, record)
    vocabulary, limits = Vocabulary(setup.vocabulary), same_limits(setup)
    before = _NOTHING
    for number, asked in enumerate(_asked(record, setup)):
        now = asked["so_far"]
        # The last thing that happened before a method was asked is a look.
        observation = stored_observation(folder, record, now["observations"] - 1)
        check = bool(asked.get("check"))
        situation = Situation(
            observation,
            instruction,
            vocabulary,
            limits,
            attempt=asked["attempt"],
            replans_left=asked["replans_left"],
            executed=tuple(_runs(folder, record, before, now)),
            refused=_refusal(record["planner"]["gates"][before["gates"] : now["gates"]]),
            plan=recorded_plan(folder, record, setup.plan) if number == 0 and setup.plan is not None else None,
            reobserve_left=asked["looks_left"],
            advice=asked.get("advice", ""),
            facts=setup.facts,
            doubts=tuple(asked.get("doubts", ())),
        )
        yield Asked(situation, check)
        # What ran is told at every check and once more when the method is asked what to do.
        before = before if check else now


def _asked(record: Record, setup: Setup) -> list[dict[str, Any]]:
    """What the method was told of attempts and looks each time it was asked; the last time only if that came to an end.

    Records of earlier releases say it only through the names of their pictures.
    """
    planner = record["planner"]
    if "asked" in planner:
        ended = record["state"] == "finished" and (record["outcome"] or {}).get("stage") not in ("interrupted", "crash")
        return list(planner["asked"] if ended else planner["asked"][: len(planner["decisions"])])
    found: list[dict[str, Any]] = []
    attempt, reobserve = 0, setup.reobserve
    for decision in planner["decisions"]:
        where = planner["observations"][decision["so_far"]["observations"] - 1]["where"]
        if found and where == "look":
            reobserve -= 1
        elif found:
            attempt += 1
        counts = {"attempt": attempt, "replans_left": setup.replans - attempt, "looks_left": reobserve}
        found.append({**counts, "so_far": decision["so_far"]})
    return found


def recorded_plan(folder: Path, record: Record, plan_id: str) -> Plan:
    """A plan of the record by its id.

    Raises:
        ConfigError: The record does not hold it.
    """
    for number, kept in enumerate(record["planner"]["plans"]):
        if kept["id"] == plan_id:
            return stored_plan(folder, record, number)
    known = ", ".join(str(kept["id"]) for kept in record["planner"]["plans"]) or "none"
    raise ConfigError(f"{folder}: the record does not hold the plan {plan_id}; it holds: {known}")


def _runs(folder: Path, record: Record, before: Mapping[str, int], now: Mapping[str, int]) -> Iterator[SubgoalRun]:
    planner = record["planner"]
    reports = iter(planner["executions"][before["executions"] : now["executions"]])
    done: dict[int, int] = {}
    for entry in planner["subgoals"][before["subgoals"] : now["subgoals"]]:
        number = entry["plan"]
        if number is None:
            raise ConfigError(f"{folder}: subgoal {entry['subgoal']} belongs to no plan in the record")
        plan = stored_plan(folder, record, number)
        first = done.get(number, 0)
        done[number] = last = first + entry["actions"]
        planned = [one.action for one in plan.actions[first:last]]
        ran = list(islice(reports, entry["actions"]))
        told = [_report(action, report) for action, report in zip_longest(planned, ran) if report is not None]
        yield SubgoalRun(
            entry["subgoal"],
            _seen(folder, record, entry["before"]),
            _seen(folder, record, entry["after"]),
            tuple(told),
        )


def _report(action: Action | None, told: Mapping[str, Any]) -> StepReport:
    """One report. Beside a plan's actions only the way home runs by itself, after the last of them that ran."""
    if action is None or action.kind != told["action"].get("kind", action.kind):
        action = Home()
    return StepReport(action, told["executed"], told["measured"], told["fault"])


def _seen(folder: Path, record: Record, views: Mapping[str, str]) -> Observation:
    """The recorded observation that shows these views."""
    for number, entry in enumerate(record["planner"]["observations"]):
        if entry["views"] == dict(views):
            return stored_observation(folder, record, number)
    raise ConfigError(f"{folder}: the record holds no observation with the views {dict(views)}")


def _refusal(gates: list[Mapping[str, Any]]) -> GateReport | None:
    """The last passage through the gate, when it was refused; the way home after a failure is no part of a plan."""
    gates = [gate for gate in gates if gate["where"] != GOING_HOME]
    if not gates or gates[-1]["admitted"]:
        return None
    return GateReport(tuple(GateCheck(**check) for check in gates[-1]["checks"]))
