"""How a model is asked: thinking, limits, deadlines, tries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

Thinking: TypeAlias = Literal["off", "low", "medium", "high"]
MAX_TOKENS: dict[Thinking | None, int] = {None: 8192, "off": 8192, "low": 16384, "medium": 32768, "high": 32768}
"""Most tokens of one answer, thinking included, by thinking level; servers named by address: SERVER_MAX_TOKENS."""
SERVER_MAX_TOKENS = 4096
LONGEST_WAIT_S = 30.0
"""Longest pause between two tries; a provider that asks for a longer one counts as unavailable."""
FIRST_WAIT_S = 0.5


@dataclass(frozen=True)
class Settings:
    """How a model is asked.

    Attributes:
        thinking: Its thinking level; None leaves the service's own default.
        max_tokens: Most tokens of one answer, thinking included.
        deadline_s: Longest time for one request with all its tries.
        tries: Most tries at one request when the provider fails.
        first_wait_s: Pause before the second try; it doubles from try to try.
        schemas: Send the schema for the service to enforce; otherwise it is told in words only.
        max_pictures: Most pictures in one request; more are pasted on one sheet. None: no limit is known.
    """

    thinking: Thinking | None
    max_tokens: int
    deadline_s: float = 300.0
    tries: int = 5
    first_wait_s: float = FIRST_WAIT_S
    schemas: bool = True
    max_pictures: int | None = None
