"""Clauses brought into the order in which they are to be done, and turns of phrase opened, before words are read."""

from __future__ import annotations

import re

_HAVING = r"(?:(?:you(?: have| ve|'ve)?|having|we have|it is|the robot has)\s+)?"
_AFTER = r"(?:after|once|when|as soon as)"
_VERBISH = r"(?:put|plac|mov|rotat|turn|stack|push|sort|swap|drop|spin|set|bring|brought|rearrang|arrang|follow|sweep|swept|transfer|slid|pick|lift|done|finish)[a-z]*"
_OPENED = (
    (r"\bthe same\s+(?=\{)", "the "),
    (
        r"\bwhat(?:ever)?\s+(?:is(?: shown)?|you (?:can )?see|can be seen|shows)\s+in\s+(?:the (?:picture|image) )?(?=\{)",
        "the object shown in ",
    ),
    (r"\ba (?:little|bit)\b(?= (?:to|further|more|left|right|up|down|towards|closer|away|bit))", "slightly"),
    (r"(^|[.;,]\s*)(?:and )?(?:second|third|fourth|fifth|sixth)(?:ly)?\s*,", r"\1 then "),
    (r"(^|[.;]\s*)(?:step )?\(?\d\s*[.):]\s+(?=[a-z])", r"\1 "),
    (r"(?<![\w.])[-\u2212](?=\d)", "minus "),
)
_THEN_A = (
    rf"^\s*(?:please,?\s+)?before\s+{_HAVING}(?P<second>[^,;.]+),\s*(?P<first>[^;.]+)\.?\s*$",
    rf"^\s*(?P<second>[^;.]+?),?\s+(?:but )?(?:only )?{_AFTER}\s+{_HAVING}(?P<first>{_VERBISH}\b[^;.]+?)\.?\s*$",
    rf"^\s*(?:please,?\s+)?{_AFTER}\s+{_HAVING}(?P<first>{_VERBISH}\b[^,;.]+),\s*(?P<second>[^;]+)$",
    rf"^\s*(?P<first>[^;.]+?),?\s+before\s+{_HAVING}(?P<second>{_VERBISH}\b[^;.]+?)\.?\s*$",
)


def in_order(text: str) -> str:
    """The same instruction with what comes first said first, and "then" between."""
    for pattern, plain in _OPENED:
        text = re.sub(pattern, plain, text, flags=re.IGNORECASE)
    for pattern in _THEN_A:
        found = re.match(pattern, text, re.IGNORECASE)
        if found is not None:
            return f"{found.group('first').strip(' .,')}, then {found.group('second').strip()}"
    return text
