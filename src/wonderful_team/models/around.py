"""A model around another one."""

from __future__ import annotations

from typing import Any

from wonderful_team.core.protocols import Model


class AroundModel:
    """Says of itself what the model inside says (name, ticks, identity, …); its own kinds say how it answers."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.name = str(getattr(model, "name", type(model).__name__))

    def __getattr__(self, name: str) -> Any:
        # A copy is asked before it has a model.
        if name.startswith("__") or name == "model":
            raise AttributeError(name)
        return getattr(self.model, name)
