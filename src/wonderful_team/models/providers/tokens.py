"""How many tokens a request takes: reckoned before it is sent, and as the service counted them."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from wonderful_team.core.values import Request, Usage, Words
from wonderful_team.models.conventions import Convention

if TYPE_CHECKING:
    from pydantic_ai.usage import RequestUsage

CHARACTERS_PER_TOKEN = 3.0
PIXELS_PER_TOKEN = 500.0
"""On the careful side for every vendor's way of counting pictures; corrected by what the service reports."""
MOST_CHARACTERS_PER_TOKEN = 8.0
"""More than any tokenizer packs into a token of English words and JSON."""


def reckoned(request: Request, convention: Convention) -> float:
    """Tokens of a request by its characters and pixels, on the careful side."""
    characters = len(request.system) + sum(len(part.text) for part in request.parts if isinstance(part, Words))
    characters += 1500 + len(request.feedback) + (len(as_said(request.previous)) if request.feedback else 0)
    pixels = 0.0
    for picture in request.pictures:
        width, height = convention.seen_size(picture.size_px)
        pixels += width * height + 150_000
    return characters / CHARACTERS_PER_TOKEN + pixels / PIXELS_PER_TOKEN


def as_said(previous: Any) -> str:
    """The model's last answer, in the words in which it is shown to it again."""
    return previous if isinstance(previous, str) else json.dumps(previous, default=str)


def usage_of(reported: RequestUsage, said: str, thought: str, reckoned_in: int) -> Usage:
    """Tokens as the service reports them; where it reports none, what was reckoned beforehand."""
    details = reported.details or {}
    thinking = next((details[name] for name in ("reasoning_tokens", "thoughts_tokens") if details.get(name)), 0)
    if thought and not thinking:
        # Many servers show the thinking but do not count it apart.
        thinking = min(reported.output_tokens, math.ceil(len(thought) / CHARACTERS_PER_TOKEN))
    if not (reported.input_tokens or reported.output_tokens):
        return Usage(tokens_in=reckoned_in, tokens_out=round(len(said) / CHARACTERS_PER_TOKEN))
    return Usage(
        tokens_in=reported.input_tokens,
        tokens_cached=reported.cache_read_tokens,
        tokens_thinking=thinking,
        tokens_out=max(0, reported.output_tokens - thinking),
    )
