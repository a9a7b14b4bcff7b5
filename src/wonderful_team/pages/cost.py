"""What a run cost: per role, and call by call as a waterfall."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from wonderful_team.pages.pictures import text_in_svg
from wonderful_team.pages.requests import Asked
from wonderful_team.pages.words import seconds

COLOURS = 8
"""Colours of bars; roles beyond share the last one."""
_WIDTH, _LEFT, _ROW, _TOP = 960, 8, 24, 26


@dataclass(frozen=True)
class RoleCost:
    """Sum over one role; `usd` None when any price is unknown."""

    role: str
    calls: int
    pictures: int
    tokens_in: int
    tokens_out: int
    usd: float | None
    seconds: float


def per_role(asked: Sequence[Asked]) -> tuple[RoleCost, ...]:
    """Sums per role, in order of first appearance, with the total last; empty without calls."""
    roles = list(dict.fromkeys(one.entry["role"] for one in asked))
    rows = [_sum(role, [one for one in asked if one.entry["role"] == role]) for role in roles]
    return (*rows, _sum("all", asked)) if rows else ()


def _sum(role: str, asked: Sequence[Asked]) -> RoleCost:
    asked = [one for one in asked if one.sent]
    usages = [one.answer["usage"] for one in asked if one.answer is not None]
    prices = [usage["usd"] for usage in usages]
    return RoleCost(
        role,
        len(asked),
        sum(len(one.pictures) for one in asked),
        sum(usage["tokens_in"] for usage in usages),
        sum(usage["tokens_out"] + usage["tokens_thinking"] for usage in usages),
        None if any(price is None for price in prices) else sum(prices),
        sum(one.seconds or 0.0 for one in asked),
    )


def rounds(asked: Sequence[Asked]) -> int:
    """Waiting rounds of the main line: how many calls followed one another, those side by side counted once.

    Memory works beside the main line and makes nobody wait.
    """
    count, free_s = 0, float("-inf")
    for one in (one for one in asked if one.sent and one.entry["role"] != "memory"):
        if one.sent_s >= free_s:
            count += 1
            free_s = _end(one)
    return count


def waterfall(asked: Sequence[Asked], words: Iterable[str] = ()) -> Markup | None:
    """Calls as bars over time; calls at the same time stand below one another. None without calls.

    `words` are the names of the files with the roles' words: their order is that of the colours.
    """
    if not asked:
        return None
    start = min(one.sent_s for one in asked)
    span = max(max(_end(one) for one in asked) - start, 1e-3)
    height = _TOP + _ROW * len(asked) + 10
    scale = (_WIDTH - 2 * _LEFT) / span
    named = [name.removesuffix(".md") for name in words if name.count(".") == 1]
    roles = list(dict.fromkeys([*named, *(one.entry["role"] for one in asked)]))
    lines = [_grid(span, scale, height)]
    for row, one in enumerate(asked):
        lines.append(
            _bar(one, _LEFT + (one.sent_s - start) * scale, _TOP + row * _ROW, scale, roles.index(one.entry["role"]))
        )
    return Markup(
        '<svg class="waterfall" viewBox="0 0 {} {}" role="img" aria-label="Calls over time, {} in all">{}</svg>'
    ).format(_WIDTH, height, len(asked), Markup("").join(lines))


def _end(one: Asked) -> float:
    return one.sent_s if one.answered_s is None else one.answered_s


def _bar(one: Asked, x: float, y: float, scale: float, place: int) -> Markup:
    width = max((_end(one) - one.sent_s) * scale, 3.0)
    role = one.entry["role"]
    shade = min(place, COLOURS - 1)
    failed = " failed" if one.entry["invalid"] is not None or one.answered_s is None else ""
    label = f"{one.label}  {seconds(one.seconds)}"
    size = 7.0 * len(label)
    # The label stands right of the bar, left of it where the drawing ends, or inside a long bar.
    if x + width + 8 + size <= _WIDTH:
        at, css = x + width + 6, "bar-label"
    elif size + 12 < width:
        at, css = x + 6, "bar-label inside"
    else:
        at, css = max(2.0, x - 6 - size), "bar-label"
    return Markup(
        '<a href="#{}"><title>{}</title><rect x="{}" y="{}" width="{}" height="{}" rx="3" class="bar role-{}{}"/>{}</a>'
    ).format(
        one.anchor,
        f"{one.number}. {role}: {label}",
        f"{x:.1f}",
        f"{y + 3:.1f}",
        f"{width:.1f}",
        _ROW - 6,
        shade,
        failed,
        text_in_svg(at, y + _ROW - 8, label, css, 12),
    )


def _grid(span: float, scale: float, height: int) -> Markup:
    step = _nice_step(span)
    marks = []
    for count in range(int(span / step) + 1):
        x = _LEFT + count * step * scale
        side = " start" if count == 0 else " end" if x > _WIDTH - 40 else ""
        label = seconds(count * step) if count else "0"
        line = Markup('<line x1="{0}" x2="{0}" y1="18" y2="{1}" class="grid"/>').format(f"{x:.1f}", height)
        marks.append(line + text_in_svg(x, 12, label, f"tick{side}", 11))
    return Markup("").join(marks)


def _nice_step(span: float) -> float:
    step = 0.001
    while True:
        for factor in (1, 2, 5):
            if span / (step * factor) <= 8:
                return step * factor
        step *= 10
