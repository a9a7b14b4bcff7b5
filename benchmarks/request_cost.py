"""Print the program's own CPU time per request, by part, and the bytes sent.

    python -m benchmarks.request_cost --size 640x480

Counted is the thread that asks (drawing, encoding, words and schema, the client library, HTTP); the local server runs in
a thread of its own and is not. Every request holds a fresh picture, so nothing is answered from memory.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.models.providers.asking import TARGETS
from tests.planning.stub_model import stub_script
from tests.servers.brains import AgentSession, Tapped, typed_brain
from tests.servers.server import Rules, WireServer
from tests.servers.wiring import WIRES
from wonderful_team.agents import build_request
from wonderful_team.contracts import GiveBox, JudgeBox, Question, ReadScene
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, BoxMark, PointMark
from wonderful_team.core.values import Request, View
from wonderful_team.images import crop, whole
from wonderful_team.models.wire import compose
from wonderful_team.models.wire.coding import encoded
from wonderful_team.models.wire.showing import show

PLAN = ("G1: put T1 into T2",)


def photo(size: tuple[int, int], seed: int) -> View:
    """A picture with the grain of a photo: smooth shapes, sensor noise."""
    rng = np.random.default_rng(seed)
    width, height = size
    y, x = np.mgrid[0:height, 0:width]
    base = np.stack([120 + 60 * np.sin(x / 90 + seed), 130 + 50 * np.cos(y / 70), 110 + 40 * np.sin((x + y) / 120)], -1)
    for _ in range(8):
        x0, y0 = rng.integers(0, width - 60), rng.integers(0, height - 60)
        base[y0 : y0 + 50, x0 : x0 + 50] = rng.integers(0, 255, 3)
    return View("top", "camera", 0.0, np.clip(base + rng.normal(0, 2.5, base.shape), 0, 255).astype(np.uint8))


def read_scene(view: View) -> Question:
    return ReadScene(TARGETS, PLAN, whole(view, "top view"))


def give_box(view: View) -> Question:
    shown = whole(view, "top view", marks=(Axes(),))
    return GiveBox(TARGETS[0], PLAN, shown.marked(PointMark((shown.size_px[0] / 2, shown.size_px[1] / 2))))


def judge_box(view: View) -> Question:
    width, height = view.size_px
    near = crop(view, Box(width * 0.4, height * 0.4, width * 0.5, height * 0.55), "crop", marks=(Axes(),))
    across, down = near.size_px
    return JudgeBox(TARGETS[0], near.marked(BoxMark(Box(across * 0.3, down * 0.3, across * 0.7, down * 0.7))))


QUESTIONS: dict[str, Callable[[View], Question]] = {"ReadScene": read_scene, "GiveBox": give_box, "JudgeBox": judge_box}


@dataclass(frozen=True)
class Cost:
    """Of one request: CPU milliseconds of its parts, and bytes of its body."""

    draw_ms: float
    encode_ms: float
    words_ms: float
    sending_ms: float
    bytes_sent: int

    @property
    def total_ms(self) -> float:
        return self.draw_ms + self.encode_ms + self.words_ms + self.sending_ms


def cpu_ms(work: Callable[[], Any]) -> tuple[float, Any]:
    """CPU time of this thread [ms], and what came out."""
    start = time.thread_time()
    made = work()
    return (time.thread_time() - start) * 1000, made


async def measure(wire: str, question: str, size: tuple[int, int], times: int) -> Cost:
    """Medians over fresh pictures."""
    script, session = stub_script(), AgentSession()
    brain = typed_brain(session, lambda request: script[request.contract](request), WIRES[wire].speech)
    parts: list[tuple[float, float, float, float]] = []
    with WireServer(brain, Rules(local=not WIRES[wire].vendor)) as server:
        provider = WIRES[wire].provider(server, deadline_s=60.0)
        model = Tapped(provider, session)

        def fresh(seed: int) -> Request:
            return build_request(QUESTIONS[question](photo(size, seed)), id=f"0/{seed}", stage="ground")

        await model.answer(fresh(0))
        for turn in range(times):
            request, again = fresh(2 * turn + 1), fresh(2 * turn + 2)
            pictures = request.pictures
            draw_ms, drawn = cpu_ms(lambda p=pictures: [show(picture, provider.convention).rgb for picture in p])
            encode_ms, _ = cpu_ms(
                lambda d=drawn, p=pictures: [encoded(rgb, (one,)) for rgb, one in zip(d, p, strict=True)]
            )
            compose_ms, _ = cpu_ms(lambda r=request: compose(r, provider.convention))
            start = time.thread_time()
            await model.answer(again)
            whole_ms = (time.thread_time() - start) * 1000
            words_ms = max(0.0, compose_ms - draw_ms - encode_ms)
            parts.append((draw_ms, encode_ms, words_ms, max(0.0, whole_ms - draw_ms - encode_ms - words_ms)))
        sent = server.heard[-1].bytes_in
        await provider.aclose()
    return Cost(*(statistics.median(column) for column in zip(*parts, strict=True)), sent)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--times", type=int, default=15)
    asked = parser.parse_args()
    width, height = map(int, asked.size.split("x"))
    print(
        f"picture {width} x {height}, median of {asked.times}, load {os.getloadavg()[0]:.1f}; CPU ms of the asking thread"
    )
    print(
        f"{'format':18s}{'question':12s}{'draw':>7s}{'encode':>8s}{'words':>7s}{'sending':>9s}{'total':>8s}{'bytes sent':>12s}"
    )
    for wire in WIRES:
        for question in QUESTIONS:
            cost = asyncio.run(measure(wire, question, (width, height), asked.times))
            print(
                f"{wire:18s}{question:12s}{cost.draw_ms:7.1f}{cost.encode_ms:8.1f}{cost.words_ms:7.1f}"
                f"{cost.sending_ms:9.1f}{cost.total_ms:8.1f}{cost.bytes_sent:12d}",
                flush=True,
            )


if __name__ == "__main__":
    main()
