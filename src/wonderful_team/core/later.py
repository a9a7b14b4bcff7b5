"""Fields that values of earlier releases do not have."""

from __future__ import annotations

from dataclasses import Field, field
from typing import Any

LATER = "later"
"""Key in a field's metadata: see `later`."""


def later(default: Any, **metadata: Any) -> Any:
    """A dataclass field that values of earlier releases do not have.

    Files without it open, and as long as it keeps its default it counts in no hash: what was written before keeps its id.
    """
    return field(default=default, metadata={LATER: True, **metadata})


def is_later(item: Field[Any]) -> bool:
    """Whether files of earlier releases lack a field."""
    return bool(item.metadata.get(LATER))
