"""Remember: keep targets, counts, refusals and limits in a line; drop what says nothing new."""

from __future__ import annotations

import re

from wonderful_team.contracts import MemoryEntry, Remember

_MATTERS = (
    ("not found", r"not (?:found|here|in the picture)|absent|nothing fits|was not found"),
    ("not reached", r"not[ _]done|undone|failed|fault|not executed"),
    ("constraint", r"\b(?:must|only|without|keep out|never|at most|no room|collision|blocked|before)\b"),
    ("count", r"\b\d+ (?:of|things|subgoals?|targets?|fruits?|blocks?|objects?)\b"),
    ("target", r"\bT\d+\b"),
    ("plan", r"\bG\d+\b"),
)
"""What is worth keeping, the most telling first."""
LONGEST = 300
"""Characters of a summary."""


def answer_remember(question: Remember) -> MemoryEntry:
    """Keep an answer that names targets, counts, failures or constraints and is not known yet."""
    text = re.sub(r"\s+", " ", question.answered).strip()
    for name, pattern in _MATTERS:
        found = re.search(pattern, text, re.IGNORECASE)
        if found is None:
            continue
        about = re.findall(r"\b[TG]\d+\b", f"{question.asked} {text}")
        key = f"{question.role} {name}{': ' + ' '.join(dict.fromkeys(about[:4])) if about else ''}"[:60]
        if key in question.known:
            break
        return MemoryEntry(keep=True, key=key, summary=_short(text))
    return MemoryEntry(keep=False, key="", summary="")


def _short(text: str) -> str:
    if len(text) <= LONGEST:
        return text
    cut = text[:LONGEST]
    end = max(cut.rfind(". "), cut.rfind("; "))
    return cut[: end + 1] if end > 80 else cut.rsplit(" ", 1)[0] + " ..."
