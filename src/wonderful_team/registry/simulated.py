"""Simulated models by name: the one place where a simulator's truth is handed to a model."""

from __future__ import annotations

from collections.abc import Mapping

from wonderful_team.core.protocols import Model, SceneTruth, World, offers
from wonderful_team.errors import ConfigError
from wonderful_team.registry.worlds import WORLDS

SIMULATED = "simulated:"


def simulated_model(name: str, world: World | None) -> Model:
    """A model that answers from a world's truth; without a world, one that says what it waits for."""
    from wonderful_team.simulated import SimulatedModel, Unbound, profile_named

    profile = profile_named(name.removeprefix(SIMULATED))
    if world is None:
        return Unbound(name)
    return SimulatedModel(scene_truth(world, name), world.instruction, profile)


def waiting(models: Mapping[str, Model]) -> str | None:
    """The name of a simulated model that has no world yet; None when there is none."""
    return next((str(model.name) for model in models.values() if getattr(model, "needs_world", False)), None)  # type: ignore[attr-defined]


def scene_truth(world: World, model: str) -> SceneTruth:
    """The truth behind a simulator, for a simulated model.

    Raises:
        ConfigError: The world has none, or its instruction was replaced: its truth knows what is right for its own only.
    """
    from wonderful_team.core.protocols import privileged

    truth = privileged(world)
    if offers(truth, SceneTruth):
        return truth
    inner = getattr(world, "inner", None)
    if truth is None and getattr(inner, "privileged", None) is not None:
        raise ConfigError(
            f"model {model!r} cannot answer here: the instruction was replaced by {world.instruction.text!r}, and the "
            "world's truth knows what is right for its own instruction only; leave the instruction out, or take another model"
        )
    raise ConfigError(
        f"model {model!r} answers from a simulator's truth, and this {type(world).__name__} has none; it runs in "
        f"{', '.join(WORLDS)}; take another model for photos, robots and worlds of your own"
    )
