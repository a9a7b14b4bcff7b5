"""A plan as JSON and back: what `plan.json` holds and `run --plan` takes. The plan that comes back has the same id.

A plan file is data of unknown origin. Reading it checks types and numbers, and that its content is what its id says; whether
it may run is for the gate, which checks every number against the world as it is.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from wonderful_team.core.values import Plan, size_problem
from wonderful_team.errors import ConfigError
from wonderful_team.record.values_file import decode, encode

PLAN_SCHEMA_VERSION = 2
_SHORT_IDS = 1
"""Schema version of plans with ids of 12 hex digits. They open; the plan then goes by its new id."""
PLAN_FORMAT = "wonderful-team plan"


def plan_to_json(plan: Plan) -> dict[str, Any]:
    """Everything in the plan, in JSON values; pictures of the instruction as PNG text. Numbers keep every digit."""
    return {"format": PLAN_FORMAT, "schema_version": PLAN_SCHEMA_VERSION, "id": plan.id, "plan": encode(plan)}


def plan_from_json(data: Any, where: str = "plan", *, whole: bool = True) -> Plan:
    """The plan that `plan_to_json` wrote.

    Args:
        data: The parsed JSON.
        where: What to call it in messages, such as the file's name.
        whole: It holds everything that its id is over; a record keeps the instruction's pictures elsewhere.

    Raises:
        ConfigError: Not a plan of ours, another schema version, a broken or changed content.
    """
    if not isinstance(data, Mapping) or data.get("format") != PLAN_FORMAT:
        found = f"format {data.get('format')!r}" if isinstance(data, Mapping) else f"a {type(data).__name__}"
        raise ConfigError(f"{where}: not a plan file (found {found}, expected format {PLAN_FORMAT!r})")
    version = data.get("schema_version")
    if version not in (PLAN_SCHEMA_VERSION, _SHORT_IDS) or isinstance(version, bool):
        raise ConfigError(
            f"{where}: plan schema version {version!r} cannot be read; this release reads {_SHORT_IDS} and "
            f"{PLAN_SCHEMA_VERSION}. Make the plan again, or use the release that wrote it"
        )
    try:
        plan = decode(data.get("plan"), Plan)
        assert isinstance(plan, Plan)
        found = plan.id if version == PLAN_SCHEMA_VERSION else plan.short_id()
    except (ValueError, TypeError, ConfigError, RecursionError, OverflowError) as error:
        raise ConfigError(f"{where}: broken plan: {error}") from error
    problem = size_problem(
        subgoals=len(plan.subgoals),
        targets=len(plan.targets),
        actions=len(plan.actions),
        functions=len(plan.functions),
    )
    if problem:
        raise ConfigError(f"{where}: the plan has {problem}")
    if whole and found != data.get("id"):
        raise ConfigError(
            f"{where}: the content has id {found}, the file says {str(data.get('id'))[:80]!r}: it was changed after it "
            "was written. A changed plan must be made and approved again"
        )
    return plan


def has_short_id(data: Mapping[str, Any]) -> bool:
    """Whether a plan was written by an earlier release, whose ids have 12 hex digits."""
    return data.get("schema_version") == _SHORT_IDS


def read_plan(path: Path) -> Plan:
    """Read a plan from its file, or from the folder of the run that made it.

    Raises:
        ConfigError: There is no such file, or it is not a plan of ours.
    """
    file = path / "plan.json" if path.is_dir() else path
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(
            f"{file}: no plan to read ({error.strerror}); give a run's folder or its plan.json"
        ) from error
    except (ValueError, RecursionError) as error:
        raise ConfigError(f"{file}: not JSON: {error}") from error
    return plan_from_json(data, str(file))
