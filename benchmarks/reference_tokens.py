"""Input tokens of a whole plan, against the published reference implementation of the paper, on one server and one photo.

    git clone https://github.com/wonderful-team-robotics/wonderful_team_robotics REFERENCE
    python -m benchmarks.reference_tokens --reference REFERENCE

The reference runs unchanged (its `main.py`, with a camera that gives the photo), and so do `team:paper` and `team`. One local
server hears all of them and answers each question rightly, in the form that was asked for, at once: what is compared is
what a plan costs when nobody errs. Ours are answered by `offline`, the reference with the boxes that `offline` found.

Counted is what arrives at the server: words at four characters a token (system words, history, the schema of the answer where
one is sent), pictures by OpenAI's rule for GPT-4o (platform.openai.com/docs/guides/images-vision: within 2,048 x 2,048,
then the shorter side 768 pixels at most; 170 tokens for each tile of 512 x 512, and 85). Without --reference, the
reference's figures are those in benchmarks/reference_tokens.json, which --write makes anew.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import wonderful_team as wt
from benchmarks.reference_answers import Scene, Thing, answers
from tests.servers.brains import AgentSession, Tapped, typed_brain
from tests.servers.heard import Heard
from tests.servers.server import KEY, Rules, WireServer
from tests.servers.speech import SPEECHES
from wonderful_team import registry
from wonderful_team.models.providers import make_provider
from wonderful_team.offline import OfflineModel

KEPT = Path(__file__).with_suffix(".json")
REPOSITORY = "https://github.com/wonderful-team-robotics/wonderful_team_robotics"
METHODS = ("team:paper", "team")
TASKS = ("arms/block_in_bowl", "arms/star", "arms/fruit_placement/all_match")
SEED = 5
CHARACTERS_PER_TOKEN = 4
LONGEST_S = 300.0

_DRIVER = """
import builtins, runpy, sys
import numpy as np, matplotlib
matplotlib.use("Agg")
class Camera:
    def get_rgb_image(self): return np.load("photo.npy")
    def get_depth_image(self): return np.load("photo.npy")
    def get_height(self, x, y): return 0.02
builtins.camera = Camera()
sys.argv = ["main.py", *sys.argv[1:]]
sys.path.insert(0, ".")
runpy.run_path("main.py", run_name="__main__")
"""


@dataclass(frozen=True)
class Sent:
    """What arrived at the server for one plan."""

    requests: int
    pictures: int
    text_tokens: int
    picture_tokens: int

    @property
    def tokens(self) -> int:
        return self.text_tokens + self.picture_tokens

    def __add__(self, other: Sent) -> Sent:
        return Sent(*(mine + its for mine, its in zip(asdict(self).values(), asdict(other).values(), strict=True)))


def picture_tokens(width: int, height: int) -> int:
    """Of one picture for GPT-4o at high detail."""
    scale = min(1.0, 2048 / max(width, height))
    scale *= min(1.0, 768 / (min(width, height) * scale))
    tiles = math.ceil(round(width * scale, 6) / 512) * math.ceil(round(height * scale, 6) / 512)
    return 85 + 170 * tiles


def weigh(heard: Iterable[Heard]) -> Sent:
    """What the server heard, in tokens."""
    requests = pictures = characters = tokens = 0
    for one in heard:
        requests += 1
        pictures += len(one.pictures)
        characters += len(one.system) + sum(
            len(piece) for turn in one.turns for piece in turn.pieces if isinstance(piece, str)
        )
        if one.schema is not None and one.schema_native:
            characters += len(json.dumps(one.schema, separators=(",", ":")))
        tokens += sum(picture_tokens(picture.shape[1], picture.shape[0]) for picture in one.pictures)
    return Sent(requests, pictures, round(characters / CHARACTERS_PER_TOKEN), tokens)


def ours(method: str, task: str) -> tuple[Sent, Scene, np.ndarray]:
    """A plan by our own team for a scene of the arm, from its photo alone; what it found there, and the photo.

    Raises:
        RuntimeError: No plan came of it.
    """
    session, world = AgentSession(), registry.make_world(task, SEED)
    # Samples of one question are alike on the wire: all get the first one's answer, as from a model that does not err.
    brain = typed_brain(session, lambda request: OfflineModel().answer(replace(request, sample=0)), SPEECHES["pixels"])
    try:
        photo, told = np.array(world.observe().main.rgb), {"vocabulary": world.vocabulary, "facts": world.facts}
        with WireServer(brain, Rules()) as server, tempfile.TemporaryDirectory() as out:
            model: Any = Tapped(make_provider(f"openai-chat:gpt-4o@{server.url}/v1", api_key=KEY), session)
            team = wt.Team(model=model, method=method, out=out, cache="off", allow_unpriced=True)
            plan = team.plan(photo, world.instruction, **told).plan
            if plan.status != "planned":
                raise RuntimeError(f"{method} has no plan for {task}: {plan.status}, {plan.message}")
            sent = weigh(server.heard)
    finally:
        world.close()
    goals, draws = tuple(subgoal.text for subgoal in plan.subgoals), any(subgoal.function for subgoal in plan.subgoals)
    found = [one for one in plan.grounded.values() if one.box is not None]
    things = tuple(Thing(one.target.words, one.box, one.target.kind == "area" and not draws) for one in found)
    return sent, Scene(str(world.instruction.text), (photo.shape[1], photo.shape[0]), things, goals, draws), photo


def reference(folder: Path, scene: Scene, photo: np.ndarray) -> Sent:
    """A plan by the reference implementation.

    Raises:
        RuntimeError: It stopped with an error.
    """
    with WireServer(answers(scene), Rules()) as server, tempfile.TemporaryDirectory() as name:
        run = Path(name) / "run"
        shutil.copytree(folder, run, ignore=shutil.ignore_patterns(".git"))
        np.save(run / "photo.npy", photo)
        asked = ["--task", "t", "--env_type", "e", "--vlm", "gpt-4o", "--prompt", scene.instruction]
        done = subprocess.run(
            [sys.executable, "-c", _DRIVER, *asked],
            cwd=run,
            env={**os.environ, "OPENAI_API_KEY": KEY, "OPENAI_BASE_URL": f"{server.url}/v1"},
            input="no\ntrue\n",
            capture_output=True,
            text=True,
            timeout=LONGEST_S,
        )
        log = run / "log" / "response_log.txt"
        told = log.read_text(encoding="utf-8") if log.is_file() else ""
        if done.returncode or "ERROR:" in told or "Update Height Values" not in told:
            raise RuntimeError(f"the reference stopped:\n{done.stdout[-2000:]}{done.stderr[-2000:]}{told[-2000:]}")
        return weigh(server.heard)


def kept() -> dict[str, Sent]:
    """What the reference sent when it was run last, by task."""
    return {task: Sent(**sent) for task, sent in json.loads(KEPT.read_text(encoding="utf-8"))["sent"].items()}


def compare(folder: Path | None = None) -> tuple[dict[str, Sent], dict[str, dict[str, Sent]]]:
    """What the reference (run from `folder`, or as it was kept) and each of our methods send, by task."""
    base, own = ({} if folder is not None else kept()), {method: dict[str, Sent]() for method in METHODS}
    for task in TASKS:
        for method in METHODS:
            own[method][task], scene, photo = ours(method, task)
        if folder is not None:
            base[task] = reference(folder, scene, photo)
    return base, own


def shares(base: Mapping[str, Sent], own: Mapping[str, Mapping[str, Sent]]) -> list[float]:
    """Tokens of all tasks against the reference's, by method."""
    every = sum(sent.tokens for sent in base.values())
    return [sum(sent.tokens for sent in own[method].values()) / every for method in METHODS]


def main() -> None:
    """Count, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--reference", type=Path, help="a clone of the reference; default: its figures as they were kept"
    )
    parser.add_argument("--write", action="store_true", help="keep the reference's figures")
    options = parser.parse_args()
    if options.reference is not None and not (options.reference / "main.py").is_file():
        parser.error(f"--reference {options.reference}: no main.py there; it is a clone of {REPOSITORY}")
    if options.write and options.reference is None:
        parser.error("--write needs --reference: there is nothing new to keep")
    base, own = compare(options.reference)
    print(f"{'task':<32}{'':<12}{'requests':>9}{'pictures':>9}{'words':>9}{'pictures':>9}{'tokens':>9}{'share':>7}")
    for task in TASKS:
        for name, sent in (("reference", base[task]), *((method, own[method][task]) for method in METHODS)):
            print(
                f"{task:<32}{name:<12}{sent.requests:>9}{sent.pictures:>9}{sent.text_tokens:>9}{sent.picture_tokens:>9}"
                f"{sent.tokens:>9}{sent.tokens / base[task].tokens:>7.3f}"
            )
    for method, share in zip(METHODS, shares(base, own), strict=True):
        print(f"{'all':<32}{method:<12}{sum(sent.tokens for sent in own[method].values()):>45}{share:>7.3f}")
    if options.write:
        found = {"repository": REPOSITORY, "seed": SEED, "sent": {task: asdict(sent) for task, sent in base.items()}}
        KEPT.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
