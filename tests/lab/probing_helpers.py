"""Probing a server over a real socket."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from typing import Any

from tests.servers.server import Rules, WireServer
from wonderful_team.lab.asking import Bench
from wonderful_team.lab.probe import Options, Probed, Subject, probe
from wonderful_team.models.budget import Budget
from wonderful_team.models.families import guess_family
from wonderful_team.models.providers import make_provider

LOCAL = Rules(key=None, local=True)


def subject_of(server: WireServer, model: str = "my-planner") -> Subject:
    """The model behind a server, quickly given up on."""
    spec = f"{server.url}/v1#{model}"

    def make(profile, thinking):  # type: ignore[no-untyped-def]
        return make_provider(spec, profile=profile, thinking=thinking, tries=2, first_wait_s=0.05, local_only=True)

    return Subject(spec, make, True, guess=guess_family(model).convention)


def bench_of(server: WireServer) -> Bench:
    """Where the single questions are asked."""
    return Bench(subject_of(server).make, True, Budget())


async def closing(bench: Bench, work: Awaitable[Any]) -> Any:
    """The result of some work, connections closed afterwards."""
    try:
        return await work
    finally:
        await bench.aclose()


def probed(
    brain: Callable[..., object], rules: Rules = LOCAL, *, model: str = "my-planner", options: Options | None = None
) -> tuple[Probed, WireServer]:
    """Probe a model behind a server of its own; the server, with what it heard, comes back as well."""
    with WireServer(brain, replace(rules)) as server:  # type: ignore[arg-type]
        found = asyncio.run(probe(subject_of(server, model), options or Options(most_pictures=2)))
    return found, server
