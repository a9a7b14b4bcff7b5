"""What the process that keeps the store and the process that talks to Ray say to each other."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from wonderful_team.evals.ray_actors import Hello
from wonderful_team.evals.shipment import Parcel
from wonderful_team.evals.trials import RunSettings, TrialRow, TrialRunner, TrialSpec


@dataclass(frozen=True)
class Order:
    """What the process that talks to Ray is started with.

    Attributes:
        workers: How many; None for as many as the cluster has cores.
        most: More workers than this would have nothing to do.
        at_once: Trials in flight in each.
        calls_at_once: Most model calls in flight over all workers; None for each trial's own limit.
        folder: What is shipped.
        said: File that takes what Ray prints.
    """

    address: str
    workers: int | None
    most: int
    at_once: int
    calls_at_once: int | None
    runner: TrialRunner
    parcel: Parcel
    folder: Path
    said: Path


@dataclass(frozen=True)
class Run:
    """Run this trial; its number comes back with the result."""

    number: int
    spec: TrialSpec
    settings: RunSettings


@dataclass(frozen=True)
class Stop:
    """End all workers and the connection."""


@dataclass(frozen=True)
class Connected:
    """The cluster answers."""

    nodes: int
    cpus: int
    workers: int


@dataclass(frozen=True)
class Ready:
    """A worker waits for trials; in all there are so many slots now."""

    hello: Hello
    slots: int


@dataclass(frozen=True)
class Unfit:
    """A worker cannot run this study."""

    why: str


@dataclass(frozen=True)
class Result:
    """What came of a trial, and its run folder."""

    number: int
    row: TrialRow
    folder: bytes = b""


@dataclass(frozen=True)
class Lost:
    """A worker is gone with these trials; in all there are so many slots now."""

    numbers: tuple[int, ...]
    node: str
    slots: int


@dataclass(frozen=True)
class Cause:
    """Why workers of a node were lost, once that is known."""

    node: str
    node_died: bool
    why: str


@dataclass(frozen=True)
class Ended:
    """All workers are told to end; most model calls that were ever in flight at once."""

    most_calls: int


@dataclass(frozen=True)
class Failed:
    """Nothing more can be run.

    Attributes:
        wrong_use: Whether it is the caller's to put right.
    """

    text: str
    wrong_use: bool = False
