"""Values in words, as the page shows them."""

from __future__ import annotations

import difflib
import json
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from markupsafe import Markup, escape

from wonderful_team.core.actions import STEPS
from wonderful_team.core.later import is_later


def pretty(value: Any) -> str:
    """A JSON value, indented."""
    return json.dumps(value, indent=2, ensure_ascii=False)


def pretty_name(name: str) -> str:
    """`not_found` becomes "not found"."""
    return str(name).replace("_", " ")


def seconds(value: float | None) -> str:
    """A duration: 12 ms, 3.4 s, 2 min 5 s."""
    if value is None:
        return "no answer"
    if value < 0.9995:
        return f"{value * 1000:.0f} ms"
    if value < 60:
        return f"{value:.1f} s"
    return f"{int(value) // 60} min {int(value) % 60} s"


def clock_time(value: float) -> str:
    """Time since the start of the run."""
    return f"{value:.2f} s"


def money(usd: float | None) -> str:
    """Money, or that no price is known."""
    if usd is None:
        return "unknown"
    return "0" if usd == 0 else f"${usd:.4f}" if usd < 1 else f"${usd:.2f}"


def brief(text: str, most: int = 220) -> str:
    """The first sentences of a text, at most `most` characters of it; what is cut is marked with "…"."""
    if len(text) <= most:
        return text
    stop = max(text.rfind(mark, 0, most) for mark in (". ", "; ", "? "))
    return text[: stop + 1] + " …" if stop > most // 3 else text[:most].rsplit(" ", 1)[0] + " …"


def word_diff(before: str, after: str) -> Markup:
    """One line with what went struck through and what came underlined; everything escaped."""
    old, new = before.split(), after.split()
    parts: list[Markup] = []
    for kind, a0, a1, b0, b1 in difflib.SequenceMatcher(a=old, b=new, autojunk=False).get_opcodes():
        gone, come = " ".join(old[a0:a1]), " ".join(new[b0:b1])
        if kind == "equal":
            parts.append(escape(gone))
            continue
        if gone:
            parts.append(Markup("<del>{}</del>").format(gone))
        if come:
            parts.append(Markup("<ins>{}</ins>").format(come))
    return Markup(" ").join(parts)


def place_words(place: dict[str, Any], names: Mapping[str, str] | None = None) -> str:
    """A step's place in words; `names` says what targets are, by id."""
    target = _named(str(place.get("target", "")), names)
    match place.get("type"):
        case "Beside":
            return f"{place['side']} of {target}" if place["side"] in ("left", "right") else f"{place['side']} {target}"
        case "OriginOf":
            return f"where {target} stood"
    return target


def _named(target: str, names: Mapping[str, str] | None) -> str:
    return f"{target} {(names or {}).get(target, '')}".strip()


def step_words(step: dict[str, Any], names: Mapping[str, str] | None = None) -> str:
    """A step in words, from its JSON; `names` says what targets are, by id."""
    kind = next((kind for kind in STEPS.values() if kind.__name__ == step["type"]), None)
    if kind is None:
        return pretty_name(step["type"])
    turn = step.get("rotate_deg") or 0
    # Steps of earlier releases lack the fields that came later.
    later = {item.name: item.default for item in fields(kind) if is_later(item)}
    said = {name: _field_words(name, value, names) for name, value in {**later, **step}.items()}
    named = isinstance(step.get("place"), dict) and step["place"].get("type") in ("Beside", "OriginOf")
    return (kind.words.shown or kind.words.told).format(
        **said, at="" if named else "at ", turned=f", turned {_turn_words(turn)}" if turn else ""
    )


def _turn_words(rotate_deg: float) -> str:
    return f"{abs(rotate_deg):g}° {'clockwise' if rotate_deg >= 0 else 'anticlockwise'}"


def _field_words(name: str, value: Any, names: Mapping[str, str] | None) -> str:
    match name:
        case "rotate_deg":
            return _turn_words(value)
        case "contact":
            return {"surface": ", touching the surface", "air": ", in the air"}.get(value, "")
        case "tight":
            return ", tight" if value else ""
        case "pick":
            return _named(value, names)
    return place_words(value, names) if isinstance(value, dict) else str(value)
