"""What a world or a policy may offer beyond its protocol; asked for with `offers`, never assumed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from wonderful_team.core.values import Provenance, Usage


class Horizon(Protocol):
    """A world that ends after so many actions; None for no end."""

    horizon: int | None


class ChunkPolicy(Protocol):
    """A policy that is asked again after every few actions, which is not a replan (learned policies)."""

    chunks: bool


class Accounting(Protocol):
    """A policy that knows what its calls cost, per role."""

    @property
    def usage_by_role(self) -> Mapping[str, Usage]: ...


class NamedModel(Protocol):
    """A policy that says which model serves it."""

    @property
    def model_name(self) -> str: ...


class Configured(Protocol):
    """A policy that says how it is set up, in plain values."""

    @property
    def setting(self) -> Mapping[str, Any]: ...


class Sourced(Protocol):
    """A policy that says where its answers came from: model, offline, simulated, …"""

    @property
    def provenance(self) -> Sequence[Provenance]: ...
