"""The offline model: classical vision and a grammar. No key, no weights, no network."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wonderful_team.offline.model import OfflineModel

__all__ = ["OfflineModel"]


def __getattr__(name: str) -> Any:
    """Import the model only when it is asked for: `description` alone stays light."""
    if name == "OfflineModel":
        from wonderful_team.offline.model import OfflineModel

        return OfflineModel
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
