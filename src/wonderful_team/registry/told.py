"""What methods marked PRIVILEGED are told of a simulator's truth: names and positions, as text, and nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from wonderful_team.contracts import ShownSlot
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.core.protocols import SceneTruth, World, offers, privileged
from wonderful_team.errors import ConfigError
from wonderful_team.planning.baselines.nlap import Teller, Told
from wonderful_team.registry.worlds import WORLDS

if TYPE_CHECKING:
    from wonderful_team.simulated.seeing import Eyes


def teller(world: World | None, method: str) -> Teller:
    """Tells true names and positions of a world; without one it says so when it is asked.

    Raises:
        ConfigError: The world has no such truth.
    """
    if world is None:
        return _Unbound(method)
    truth = privileged(world)
    if not offers(truth, SceneTruth):
        raise ConfigError(
            f"method {method!r} is told a simulator's truth, and this {type(world).__name__} has none that is right for its "
            f"instruction; it runs in {', '.join(WORLDS)}; without the truth: nlap, nlap:text"
        )
    from wonderful_team.simulated.seeing import Eyes

    eyes = Eyes(truth)

    def tell(view: Picture, slots: Sequence[ShownSlot]) -> Told:
        lines = {slot.name: _things(eyes, slot.pictures[0]) for slot in slots}
        said = {
            slot.name: tuple((words, at if slot.whole_scene else None) for words, at in lines[slot.name])
            for slot in slots
        }
        return Told(_things(eyes, view), said)

    return tell


class _Unbound:
    """What a method without a world is told."""

    def __init__(self, method: str) -> None:
        self.method = method

    def __call__(self, view: Picture, slots: Sequence[ShownSlot]) -> Told:
        """Raises ConfigError."""
        raise ConfigError(
            f"method {self.method!r} is told a simulator's truth: run it with wt.rollout(method, world), or pass world=world"
        )


def _things(eyes: Eyes, picture: Picture) -> tuple[tuple[str, Point], ...]:
    """Everything that shows in a picture: what it is called and where it is [px of the view]."""
    seen = eyes.see(picture)
    if seen is None:
        return ()
    found = []
    for name in seen.names:
        thing, point = seen.thing(name), seen.position(name)
        if point is not None:
            found.append((thing.words if thing is not None else name, seen.picture.frame.point_to_view(point)))
    return tuple(found)
