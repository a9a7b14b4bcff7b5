"""How a model is asked: thinking, limits, deadlines, tries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from wonderful_team.models.wire.coding import Encoding
from wonderful_team.models.wire.weight import UNLIMITED, Weight

Thinking: TypeAlias = Literal["off", "low", "medium", "high"]
MAX_TOKENS: dict[Thinking | None, int] = {None: 8192, "off": 8192, "low": 16384, "medium": 32768, "high": 32768}
"""Most tokens of one answer, thinking included, by thinking level; servers named by address: SERVER_MAX_TOKENS."""
SERVER_MAX_TOKENS = 4096
LONGEST_WAIT_S = 30.0
"""Longest pause between two tries; a provider that asks for a longer one counts as unavailable."""
FIRST_WAIT_S = 0.5
TRY_S, THINKING_TRY_S = 150.0, 300.0
"""How long one try may take before the service has shown how slow it is: without thinking, and with it."""
LONGEST_TRY_S = 3600.0
TIMED_OUT_TRIES = 2
"""Most tries that may end without a whole reply in time: a slow service starts each of them from nothing."""


@dataclass(frozen=True)
class Settings:
    """How a model is asked.

    Attributes:
        thinking: Its thinking level; None leaves the service's own default.
        max_tokens: Most tokens of one answer, thinking included.
        deadline_s: Longest time for one request with all its tries; None: as long as the tries that may time out.
        tries: Most tries at one request when the provider fails.
        first_wait_s: Pause before the second try; it doubles from try to try.
        timeout_s: Longest time for one try; None: it follows how slow the service is.
        schemas: Send the schema for the service to enforce; otherwise it is told in words only.
        max_pictures: Most pictures in one request; more are pasted on one sheet. None: no limit is known.
        context: Most tokens of a request and its answer, as measured; what the service says now wins.
        detail: The detail in which pictures are to be looked at, where the service has such a switch.
        weight: How heavy pictures may be; heavier ones are sent as JPEG.
        tile_px: Side of the tiles that pictures are counted in; None where they are not.
        encoding: Of pictures' files: auto (photos without tick labels as JPEG, all else as PNG), png or jpeg.
    """

    thinking: Thinking | None
    max_tokens: int
    deadline_s: float | None = None
    tries: int = 5
    first_wait_s: float = FIRST_WAIT_S
    timeout_s: float | None = None
    schemas: bool = True
    max_pictures: int | None = None
    detail: str | None = None
    context: int | None = None
    weight: Weight = UNLIMITED
    tile_px: int | None = None
    encoding: Encoding = "auto"

    @property
    def first_try_s(self) -> float:
        """How long the first try may take."""
        if self.timeout_s is not None:
            return self.timeout_s
        if self.deadline_s is not None:
            # A hang must leave time for another try.
            return self.deadline_s / 2 if self.tries > 1 else self.deadline_s
        return TRY_S if self.thinking in (None, "off") else THINKING_TRY_S

    @property
    def adapts(self) -> bool:
        """Nobody has set how long a try may take."""
        return self.timeout_s is None and self.deadline_s is None
