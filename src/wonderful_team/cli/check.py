"""`check`: a world, task, method, model or detector of one's own, tried before it is trusted."""

from __future__ import annotations

from pathlib import Path

import click

from wonderful_team.cli.options import PATH
from wonderful_team.cli.output import finish
from wonderful_team.core.text import counted


@click.command(
    short_help="Check a world, task, method, model or detector of your own.",
    epilog="\b\nwonderful-team check cups.py:cups\nwonderful-team check mine.py:Mine --seeds 5",
)
@click.argument("name", metavar="FILE.py:NAME")
@click.option(
    "--seeds", type=click.IntRange(1), help="How many. [default: 20; 1 for a model or a detector, which may be dear]"
)
@click.option("--sheet", type=PATH, metavar="FILE", help="The contact sheet. [default: FILE_NAME.png beside the file]")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")
def command(name: str, seeds: int | None, sheet: Path | None, as_json: bool) -> int:
    """Check FILE.py:NAME.

    A world or task: shapes and units, the same scene for the same seed, the oracle succeeds, doing nothing and random
    actions do not, a contact sheet. A method or model: it loads, runs without an error, and the gate does not refuse it every time.
    A detector: what it returns fits the picture and the words, twice the same, and it finds nothing in an empty picture.
    """
    from wonderful_team.api.check import check

    file, _, attribute = name.rpartition(":")
    beside = (
        Path(file).with_name(f"{Path(file).stem}_{attribute}.png") if file else Path(f"{name.replace('/', '_')}.png")
    )
    picture = sheet or beside
    findings = check(name, picture, seeds)
    lines = findings.lines()
    lines.append(
        "checked: nothing wrong" if not findings.bad else f"checked: {counted(len(findings.bad), 'thing')} wrong"
    )
    result = {"ok": not findings.bad, "good": findings.good, "bad": findings.bad, "notes": findings.notes}
    return finish("check", text="\n".join(lines), result=result, as_json=as_json, code=0 if not findings.bad else 1)
