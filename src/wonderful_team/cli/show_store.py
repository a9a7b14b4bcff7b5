"""`show STORE`: every trial of a store of `bench`, with its record, or with how to get one that was not kept."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from wonderful_team.cli.output import finish
from wonderful_team.core.text import counted, user_path, visible

if TYPE_CHECKING:
    from wonderful_team.evals.trials import Row

_MAGIC = b"SQLite format 3\x00"


def is_store(name: str) -> bool:
    """Whether a name is a file of SQLite, as a store is."""
    try:
        with user_path(name).open("rb") as file:
            return file.read(len(_MAGIC)) == _MAGIC
    except (OSError, ValueError):
        return False


def show_store(name: str, as_json: bool) -> int:
    """A line for each trial."""
    from wonderful_team.evals.again import NOT_KEPT
    from wonderful_team.evals.store import Store

    with Store(user_path(name), must_exist=True) as store:
        trials = [_told(row) for row in store.rows()]
    kept = sum(one["page"] is not None for one in trials)
    lines = []
    for one in trials:
        lines.append(visible(f"{one['scene']}  {one['condition']}  {one['ended']}"))
        if one["again"] is not None:
            lines.append(
                visible(f"    {NOT_KEPT if one['page'] is None else 'its run folder is gone'}; again: {one['again']}")
            )
        elif one["page"] is not None:
            lines.append(visible(f"    {one['page']}"))
    lines.append(f"{counted(len(trials), 'trial')}, {kept} with a record; all figures: wonderful-team report {name}")
    return finish("show", text="\n".join(lines), result={"trials": trials}, as_json=as_json, code=0)


def _told(row: Row) -> dict[str, Any]:
    """A trial: its page and, where there is none any more, the command that makes one. Controls keep no record."""
    from wonderful_team.evals.again import command_again
    from wonderful_team.evals.controls import CONTROLS

    told: dict[str, Any] = {"scene": row.spec.scene, "condition": row.spec.condition.label, "page": None, "again": None}
    if row.result is None:
        return {**told, "ended": "not ended"}
    stage = f" at {row.result.stage}" if row.result.stage else ""
    page = row.result.page or None
    gone = page is None or not Path(page).exists()
    again = command_again(row.spec) if gone and row.spec.condition.method not in CONTROLS else None
    return {**told, "ended": f"{row.result.outcome.upper()}{stage}", "page": page, "again": again}
