"""From a run folder to its page."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, pass_context
from jinja2.runtime import Context
from markupsafe import Markup

from wonderful_team.core.filesystem import write_private
from wonderful_team.core.text import counted, visible
from wonderful_team.errors import reading
from wonderful_team.pages import cost, planted, requests, sections
from wonderful_team.pages.pictures import Album, pictured
from wonderful_team.pages.words import clock_time, money, pretty, pretty_name, seconds
from wonderful_team.record.picture_store import AtHand
from wonderful_team.record.record_schema import read_record
from wonderful_team.redaction import redact

PAGE_NAME = "page.html"
_HERE = Path(__file__).parent
_PICTURES, _BODY = "<!-- pictures -->", "<!-- body -->"
"""Stand for them while the page is made; words on a page are escaped, so none of them reads so."""
_ENDS = ("<section>", '<details class="request"')
"""Where the body may be cut: no words go on beyond the begin of these."""
_PIECE = 500_000
"""About so many letters of the body are worked on at once: a run of hundreds of plans has a body of tens of millions."""


def write_page(folder: Path, at_hand: AtHand | None = None) -> Path:
    """Write `page.html` from the folder's record and pictures.

    Args:
        folder: The run folder.
        at_hand: What need not be read of its pictures.

    Returns:
        The page's path.

    Raises:
        ConfigError: The folder holds no record that can be read.
    """
    folder = Path(folder)
    record = read_record(folder)
    with reading(f"{folder}: the record"):
        html = b"".join(_html(folder, record, at_hand))
    path = folder / PAGE_NAME
    write_private(path, html)
    return path


def _coded(text: str) -> bytes:
    return text.encode("utf-8", errors="xmlcharrefreplace")


def _safe(text: str) -> bytes:
    return _coded(redact(visible(text, layout=True)))


def _html(folder: Path, record: dict[str, Any], at_hand: AtHand | None) -> Iterator[bytes]:
    """The page, part by part."""
    album = Album(folder, record["files"], at_hand)
    content = _content(record, album)
    style = Markup((_HERE / "page.css").read_text(encoding="utf-8"))
    # The body comes first: it decides which pictures the page has to hold.
    body = [_safe(piece) for piece in _pieces(_environment().get_template("body.html.j2").generate(**content))]
    held = {"title": content["title"], "style": style, "body": Markup(_BODY), "pictures": Markup(_PICTURES)}
    page = _environment().get_template("page.html.j2").render(**held)
    head, _, rest = page.partition(_PICTURES)
    middle, _, end = rest.partition(_BODY)
    yield _safe(head)
    # Pictures are not searched for keys: their letters may look like anything, and are most of the page.
    yield _coded(album.definitions())
    yield _safe(middle)
    yield from body
    yield _safe(end)


def _pieces(parts: Iterable[str]) -> Iterator[str]:
    """A text in pieces that end before a section or a request."""
    held, length = list[str](), 0
    for part in parts:
        held.append(part)
        length += len(part)
        if length < _PIECE:
            continue
        text = "".join(held)
        end = max(text.rfind(mark) for mark in _ENDS)
        if end > 0:
            yield text[:end]
            text = text[end:]
        held, length = [text], len(text) if end > 0 else 0
    yield "".join(held)


@cache
def _environment() -> Environment:
    """The templates, compiled once in a process."""
    environment = Environment(
        loader=FileSystemLoader(_HERE),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        auto_reload=False,
    )
    environment.filters.update(pretty=pretty, seconds=seconds, money=money, title=pretty_name, clock=clock_time)
    environment.filters.update(counted=counted, pictured=_pictured)
    return environment


@pass_context
def _pictured(context: Context, text: str | Markup) -> Markup:
    return pictured(text, context["record"], context["album"])


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
        "motions": sections.motions(record, album),
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
