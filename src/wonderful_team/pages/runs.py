"""A table of many runs in one file: thumbnails, outcome, method, model, cost, time; filtered and sorted in the browser.

Its one script stands in the file and is named by its hash in the content security policy: no other may run.
"""

from __future__ import annotations

import base64
import hashlib
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from wonderful_team.core.filesystem import write_redacted
from wonderful_team.core.text import counted, visible
from wonderful_team.errors import ConfigError
from wonderful_team.images.thumbnail import run_thumbnail
from wonderful_team.pages.sections import summary
from wonderful_team.pages.words import brief, money, seconds
from wonderful_team.pages.write import PAGE_NAME
from wonderful_team.record.record_schema import read_record

_HERE = Path(__file__).parent
MOST_PICTURES = 400
"""Newest runs that get a thumbnail: at about 10 kB each the file stays small."""


def write_runs_table(folders: Sequence[Path], path: Path) -> Path:
    """Write the table of these run folders; a run whose record cannot be read is listed as such."""
    rows = [_row(folder, path, number < MOST_PICTURES) for number, folder in enumerate(folders)]
    choices = [(name, sorted({row[name] for row in rows if row[name]})) for name in ("outcome", "method", "model")]
    script = (_HERE / "runs.js").read_text(encoding="utf-8")
    environment = Environment(
        loader=FileSystemLoader(_HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["counted"] = counted
    html = environment.get_template("runs.html.j2").render(
        runs=rows,
        choices=choices,
        style=Markup((_HERE / "runs.css").read_text(encoding="utf-8")),
        script=Markup(script),  # noqa: S704  our own file
        script_hash=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
    )
    write_redacted(path, visible(html, layout=True), errors="xmlcharrefreplace")
    return path


def _row(folder: Path, page: Path, pictured: bool) -> dict[str, Any]:
    blank = dict.fromkeys(("text", "started", "scene", "outcome", "reason", "method", "model"), "")
    row: dict[str, Any] = {**blank, "name": folder.name, "tone": "bad", "usd": None, "seconds": None, "calls": ""}
    try:
        found = summary(read_record(folder))
    except (ConfigError, KeyError, TypeError, ValueError):
        return {**row, "text": folder.name, "outcome": "unreadable", "cost": "", "time": "", "link": "", "picture": ""}
    link = folder / PAGE_NAME
    return {
        **row,
        **found,
        "reason": brief(found["reason"], 160),
        "cost": money(found["usd"]),
        "time": "" if found["seconds"] is None else seconds(found["seconds"]),
        "link": Path(os.path.relpath(link.resolve(), page.resolve().parent)).as_posix() if link.is_file() else "",
        "picture": run_thumbnail(folder) if pictured else "",
    }
