"""Write docs/prompts.md: one request of each kind, as it was sent in a real run: `make prompts`.

    python docs/make_prompts.py            # write docs/prompts.md and its pictures
    python docs/make_prompts.py --check    # exit 1 when what is written is not what is sent today

Positions can differ by a pixel between machines that draw with other libraries, so the check compares words without their
numbers, and how many pictures there are.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from PIL import Image

import wonderful_team as wt
from wonderful_team.agents.passages import PASSAGES
from wonderful_team.agents.prompts import ROLES
from wonderful_team.cli.app import run
from wonderful_team.contracts import QUESTIONS
from wonderful_team.core.actions import ARM
from wonderful_team.core.values import Answer, Request
from wonderful_team.models.scripted import ScriptedModel
from wonderful_team.models.wrappers import Injecting, Injection
from wonderful_team.registry.methods import METHODS
from wonderful_team.registry.models import make_model

HERE = Path(__file__).parent
PICTURES = "prompts"
TABLE = "tabletop/everyday/tidy_up"
HEAD = """# What the team is asked

And what its [rivals](methods.md) ask and it does not. One request of each kind, with its pictures, taken from the records of real runs; `make prompts` writes this page. The answers come from
`offline` (classical vision and a grammar), which reads the structure behind a request and not its words, or where it says so from a script.
They show the form of an answer and say nothing of a vision-language model.

A request is the role's standing words (the system message), then its parts in this order, then an answer that has to keep the schema.
`wonderful-team list prompts` shows the words alone, `--prompts DIR` replaces them, `show RUN --role ROLE` shows those of a run.

What a model is told fits what it is asked and shown: passages of the words that stand between `{% if NAME %}` and `{% endif %}` are sent where NAME
holds (Jinja, with `not`, `and`, `or` and `{% else %}`; also in your own files). Below stands what was sent. The names:

"""
HEAD += "\n".join(
    ["| name | holds where |", "|---|---|", *(f"| `{name}` | {when} |" for name, when in PASSAGES.items()), ""]
)

RIVALS = ("direct", "pivot", "nlap", "tg", "moka", "instruct2act")
"""Rivals that together ask everything that the team is not asked."""
ASKERS = {**ROLES, **{asker.name: asker for name in RIVALS for asker in METHODS[name].roles}}
QUESTIONS_BY_NAME = {kind.contract: kind for kind in QUESTIONS}

CIRCLE = """import math

def path(boxes):
    x0, y0, x1, y1 = boxes["T1"]
    x, y, r = (x0 + x1) / 2, (y0 + y1) / 2, max(x1 - x0, y1 - y0)
    return [(x + r * math.cos(k * math.pi / 8), y + r * math.sin(k * math.pi / 8)) for k in range(17)]
"""
AGAIN = """def path(boxes):
    return path_1({"T1": boxes["T2"]})
"""
LAST = frozenset({"WriteFunction"})
"""Of these the last request of a run is shown: it offers what was accepted before."""


@dataclass(frozen=True)
class Source:
    """A run, and how it is made again."""

    folder: Path
    words: str


class Partly:
    """A model that answers some kinds of question from a script and passes the others on."""

    name = "offline, in part a script"

    def __init__(self, **script: Any) -> None:
        self._scripted = ScriptedModel(script, name="script")
        self._kinds, self._model = frozenset(script), make_model("offline")

    async def answer(self, request: Request) -> Answer:
        if request.contract in self._kinds:
            return await self._scripted.answer(request)
        return await Injecting(self._model, ()).answer(request)


def runs(out: Path) -> Iterator[Source]:
    """Runs that together ask every kind of question."""
    pictured = "run tabletop/visual_manipulation --seed 3 --method team:paper"
    for name, command in (("pictured", pictured), ("demo", "demo")):
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            code = run([*command.split(), "--out", str(out / name), "--json"])
        if code != 0:
            raise SystemExit(f"`{command}` ended with exit code {code}; docs/prompts.md is left as it was")
        yield Source(out / name / "latest", f"`{command}`")
    yield from _rivals(out)
    yield _again(out)
    yield _wrong_bowl(out)
    yield _circle(out)
    yield _twisted(out)


def _rivals(out: Path) -> Iterator[Source]:
    """What rivals ask and the team does not."""
    for method in RIVALS:
        world = wt.make_world("tabletop/visual_manipulation", seed=3)
        try:
            # What is asked after the plan ran is asked where another attempt is allowed.
            again = int(method == "tg")
            trial = wt.rollout(
                wt.Method(method=method, out=out / method.replace(":", "-")), world, seed=3, replans=again
            )
        finally:
            world.close()
        assert trial.folder is not None
        replans = " --replans 1" if again else ""
        yield Source(trial.folder, f"`run tabletop/visual_manipulation --seed 3 --method {method}{replans}`")


def _again(out: Path) -> Source:
    """The lean way, whose first verdict is spoiled, so that it plans again."""
    wrong = Injection(("JudgeOutcome",), _not_reached, "the first verdict says that the goal was not reached")
    world = wt.make_world(TABLE, seed=3)
    try:
        trial = wt.rollout(
            wt.Team(model=Injecting(make_model("offline"), [wrong]), method="team", out=out / "again"),
            world,
            replans=1,
            seed=3,
            scene=f"{TABLE}#3",
        )
    finally:
        world.close()
    assert trial.folder is not None
    return Source(trial.folder, "`team` on the demo's scene; its first verdict is spoiled, so that it plans again")


class _Meddled:
    """A table at which somebody takes the block out of its bowl after the first action and puts it into the other one."""

    def __init__(self, inner: Any) -> None:
        self.inner, self._left = inner, True

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)

    def execute(self, action: Any) -> Any:
        report = self.inner.execute(action)
        if self._left:
            self._left = False
            bowl = self.inner.privileged.things()["green bowl"].position_m
            self.inner._table.put("red block", bowl + (0.0, 0.0, 0.02), 0.0)
        return report


def _wrong_bowl(out: Path) -> Source:
    """A plan that is stopped after its first subgoal."""
    world = wt.make_world(TABLE, seed=3)
    try:
        trial = wt.rollout(
            wt.Team(method="team", out=out / "wrong-bowl"), _Meddled(world), replans=1, seed=3, scene=f"{TABLE}#3"
        )
    finally:
        world.close()
    assert trial.folder is not None
    return Source(
        trial.folder, "`team` on the demo's scene; somebody puts the block into the other bowl after the first subgoal"
    )


def _not_reached(outcome: Any, request: Request) -> Any:
    first, *rest = outcome.verdicts
    missed = first.model_copy(update={"status": "not_done", "evidence": "the red block lies beside the bowl"})
    return outcome.model_copy(update={"verdicts": [missed, *rest]})


def _twisted(out: Path) -> Source:
    """An angle that pictures show and the plan states wrongly."""
    wrong = Injection(("DraftPlan",), _misread, "the angle of the first draft is misread by 50 degrees")
    world = wt.make_world("tabletop/twist", seed=3)
    try:
        model = Injecting(wt.make_model("simulated:perfect", world=world), [wrong])
        trial = wt.rollout(
            wt.Team(model=model, method="team", out=out / "twisted"), world, seed=3, scene="tabletop/twist#3"
        )
    finally:
        world.close()
    assert trial.folder is not None
    return Source(
        trial.folder, "`team` on `tabletop/twist`, with `simulated:perfect`; the angle of its first draft is spoiled"
    )


def _misread(draft: Any, request: Request) -> Any:
    goals = [
        goal.model_copy(update={"move": goal.move.model_copy(update={"rotate_deg": goal.move.rotate_deg - 50})})
        for goal in draft.subgoals
    ]
    return draft.model_copy(update={"subgoals": goals})


def _circle(out: Path) -> Source:
    """Paths of their own shape: the second one is computed by the function of the first."""
    blocks = {"T1": "red block", "T2": "purple block"}
    plain = {"kind": "object", "part": None, "where": "", "like": [], "use": ["place"]}
    draft = {
        "reasoning": "",
        "subgoals": [
            {
                "id": f"G{number}",
                "text": f"a circle is drawn round the {words}",
                "after": [],
                "targets": [name],
                "function": f"the points of a circle round {name}",
            }
            for number, (name, words) in enumerate(blocks.items(), start=1)
        ],
        "targets": [{"id": name, "words": words, **plain} for name, words in blocks.items()],
        "mode": "one_step",
        "clarification": None,
    }
    model = Partly(
        DraftPlan=draft,
        ReviewPlan={"reasoning": "", "approved": True, "doubt": None},
        WriteFunction=[{"reasoning": "", "code": text} for text in (CIRCLE, AGAIN)],
        ReviewPath={"reasoning": "", "accepted": True, "problem": ""},
        WriteSteps={
            "reasoning": "",
            "steps": [{"kind": "follow", "subgoal": name, "function": name} for name in ("G1", "G2")],
        },
        ReviewSteps={"reasoning": "", "approved": True, "doubt": None},
    )
    world = wt.make_world(TABLE, seed=3)
    try:
        team = wt.Team(model=model, method="team", out=out / "circle")
        result = team.plan(world.observe(), "draw a circle round the red block and the purple one", vocabulary=ARM)
    finally:
        world.close()
    assert result.folder is not None
    return Source(result.folder, "`team` with an arm's actions, plan and functions from a script")


def gathered(sources: Sequence[Source]) -> dict[str, tuple[Source, dict[str, Any], dict[str, Any]]]:
    """The first request of each kind that was answered, with its record.

    Raises:
        SystemExit: A kind of question was never asked.
    """
    found: dict[str, tuple[Source, dict[str, Any], dict[str, Any]]] = {}
    for source in sources:
        record = json.loads((source.folder / "record.json").read_text(encoding="utf-8"))
        # Those with more pictures to show for it come last in a record of branches: the first by name is always the same.
        for request in sorted(record["planner"]["requests"], key=lambda one: one["key"]):
            if request["answer"] is not None and request["invalid"] is None:
                known = found.get(request["contract"])
                if known is None or (request["contract"] in LAST and known[0] is source):
                    found[request["contract"]] = (source, record, request)
    missing = set(QUESTIONS_BY_NAME) - set(found)
    if missing:
        raise SystemExit(f"no run asks {', '.join(sorted(missing))}: add one to docs/make_prompts.py")
    return found


def page(sources: Sequence[Source], images: Path) -> str:
    """The page; its pictures are written to `images`."""
    found = gathered(sources)
    lines = [HEAD]
    asked = [
        (name, contract)
        for name, role in ASKERS.items()
        for contract in role.asks
        if contract in found and found[contract][2]["role"] == name
    ]
    lines += ["| role | is asked |", "|---|---|"]
    for role in ASKERS:
        names = [contract for other, contract in asked if other == role]
        if names:
            lines.append(f"| {role} | {', '.join(f'[{name}](#{name.lower()})' for name in names)} |")
    told: set[str] = set()
    for role, contract in asked:
        source, record, request = found[contract]
        if role not in told:
            told.add(role)
            lines += ["", f"## {role.capitalize()}", "", "Its standing words:", "", *_quoted(request["system"])]
        about = " ".join((sys.modules[QUESTIONS_BY_NAME[contract].__module__].__doc__ or "").split("\n")[0].split())
        lines += ["", f"### {contract}", "", f"{about} From {source.words}.", ""]
        lines += _parts(request, record, source, images)
        lines += ["", "Answered:", "", "```json", json.dumps(request["answer"]["parsed"], indent=1), "```"]
    return "\n".join(lines) + "\n"


def _parts(request: dict[str, Any], record: dict[str, Any], source: Source, images: Path) -> list[str]:
    lines: list[str] = []
    said: list[str] = []
    for part in request["parts"]:
        if "words" in part:
            said.append(part["words"])
            continue
        lines += [*_quoted("\n\n".join(said)), ""] if said else []
        said = []
        file = source.folder / record["files"][part["drawn"]]
        name = f"{request['contract']}_{sum(line.startswith('<img') for line in lines) + 1}.webp"
        with Image.open(file) as picture:
            picture.save(images / name, lossless=True, method=6)
            width = min(picture.width, 640)
        lines += [f'<img src="{PICTURES}/{name}" width="{width}" alt="{part["picture"]}">', ""]
    return lines + (_quoted("\n\n".join(said)) if said else [])


def _quoted(words: str) -> list[str]:
    return ["```text", *words.strip("\n").split("\n"), "```"]


def main() -> None:
    """Write the page, or check it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare, write nothing")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        images = Path(folder) / "images"
        images.mkdir()
        text = page(list(runs(Path(folder))), images)
        if asked.check:
            differences = stale(text, images)
            sys.stdout.write("\n".join(differences or ["docs/prompts.md shows what is sent"]) + "\n")
            sys.exit(1 if differences else 0)
        (HERE / "prompts.md").write_text(text, encoding="utf-8")
        shutil.rmtree(HERE / PICTURES, ignore_errors=True)
        shutil.copytree(images, HERE / PICTURES)


def stale(text: str, images: Path) -> list[str]:
    """What differs between the page as it is and as it would be written now, in words; [] when nothing does."""
    written = (HERE / "prompts.md").read_text(encoding="utf-8") if (HERE / "prompts.md").exists() else ""
    now, then = (re.sub(r"-?\d+(\.\d+)?", "0", one).splitlines() for one in (text, written))
    differences = [f"not in docs/prompts.md: {line}" for line in now if line not in set(then)]
    differences += [f"in docs/prompts.md, but not sent: {line}" for line in then if line not in set(now)]
    shown = {path.name for path in (HERE / PICTURES).glob("*.webp")}
    differences += [f"picture {name}" for name in sorted(shown ^ {path.name for path in images.iterdir()})]
    return [*differences[:20], *(["run `make prompts`"] if differences else [])]


if __name__ == "__main__":
    main()
