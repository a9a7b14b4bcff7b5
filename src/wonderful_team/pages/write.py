"""From a run folder to its page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from wonderful_team.core.filesystem import write_redacted
from wonderful_team.core.text import counted, visible
from wonderful_team.errors import reading
from wonderful_team.pages import cost, planted, requests, sections
from wonderful_team.pages.pictures import Album, pictured
from wonderful_team.pages.words import clock_time, money, pretty, pretty_name, seconds
from wonderful_team.record.record_schema import read_record

PAGE_NAME = "page.html"
_HERE = Path(__file__).parent


def write_page(folder: Path) -> Path:
    """Write `page.html` from the folder's record and pictures.

    Returns:
        The page's path.

    Raises:
        ConfigError: The folder holds no record that can be read.
    """
    folder = Path(folder)
    record = read_record(folder)
    with reading(f"{folder}: the record"):
        html = _html(folder, record)
    path = folder / PAGE_NAME
    write_redacted(path, visible(html, layout=True), errors="xmlcharrefreplace")
    return path


def _html(folder: Path, record: dict[str, Any]) -> str:
    album = Album(folder, record["files"])
    environment = Environment(
        loader=FileSystemLoader(_HERE),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(pretty=pretty, seconds=seconds, money=money, title=pretty_name, clock=clock_time)
    environment.filters["counted"] = counted
    environment.filters["pictured"] = lambda text: pictured(text, record, album)
    content = _content(record, album)
    style = Markup((_HERE / "page.css").read_text(encoding="utf-8"))
    # The body comes first: it decides which pictures the page has to hold.
    body = environment.get_template("body.html.j2").render(**content)
    return environment.get_template("page.html.j2").render(
        title=content["title"],
        style=style,
        body=Markup(body),
        pictures=album.definitions(),
    )


def _content(record: dict[str, Any], album: Album) -> dict[str, Any]:
    asked = requests.in_order(record, album)
    cards = planted.planted(record, album, asked)
    return {
        "title": sections.title(record),
        "record": record,
        "album": album,
        "head": sections.head(record, asked, planted.sentence(cards)),
        "planted": cards,
        "instruction": sections.instruction(record, album),
        "ends": sections.before_after(record, album),
        "overviews": sections.overviews(record, album),
        "story": sections.story(record, asked),
        "plans": sections.plans(record),
        "detected": sections.detected(record, album),
        "targets": sections.targets(record, album, asked),
        "actions": sections.actions(record),
        "execution": sections.execution(record, album),
        "replans": sections.replans(record),
        "roles": cost.per_role(asked),
        "waterfall": cost.waterfall(asked, record.get("words") or {}),
        "rounds": cost.rounds(asked),
        "warnings": sections.warnings(record, asked),
        "crashes": record["planner"].get("crashes", []),
        "requests": asked,
        "reproduce": sections.reproduce(record),
    }
