"""Every kind of file and option that somebody can hand in, damaged: the commands that read it, and what must hold."""

from __future__ import annotations

import contextlib
import io
import json
import os
import shutil
import sqlite3
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import cv2
import numpy as np
from hypothesis import strategies as st

import wonderful_team as wt
from tests.damage import WRONG, WRONG_TEXTS, damaged_bytes, damaged_json, damaged_text, lying_array
from tests.desk import WORDS, draw_desk
from wonderful_team.cli.app import run

CODES = {0, 1, 2, 3, 4, 5, 6, 7}
"""All exit codes that say something about the input; 70 is a defect."""

TASK = "tabletop/visual_manipulation"
OWN_FILES = (
    "", "def (", "W = 3", "W = None", "raise KeyError('x')", "import no_such_module", "class W: pass", "import sys; sys.exit(3)",
    "class W:\n    def __init__(self): raise ValueError('x')", "class W:\n    def answer(self, request): return request",
    "class W:\n    name = 3\n    def decide(self, situation): return 3", "def W(scene, rng): raise OSError('x')", "\x00", "\udc80",
    "class W:\n    def __getattr__(self, name): raise ValueError(name)", "class W:\n    def __init__(self, seed): self.limits = 3",
    "class W:\n    name = 'w'\n    async def answer(self, request): return '{' * 10000",
    "import wonderful_team as wt\nclass W:\n    vocabulary = limits = 3\n    instruction = wt.Instruction('x')\n    observe = execute = lambda *_: 1",
    "class W:\n    vocabulary = limits = instruction = 3\n    observe = execute = stop = close = lambda *_: None",
)  # fmt: skip


class AgentSession:
    """Good files of every kind, and a place where an example may spoil copies of them."""

    def __init__(self, folder: Path) -> None:
        self.folder = draw_desk(folder)
        self.runs = folder / "runs"
        self.plan = self._plan()
        self.trial = self._trial()
        np.save(folder / "depth.npy", np.full((240, 320), 0.8, np.float32))
        self.store = folder / "study.db"
        wt.Study(TASK, seeds=[0], store=self.store, controls=(), jobs=1, out=self.runs, record="none").run()
        self.kept = self.good("desk.png")
        self.scratch = folder

    def _plan(self) -> Path:
        seen = wt.Observation.from_files(
            self.folder / "desk.png", depth=self.folder / "depth.png", camera=self.folder / "camera.json"
        )
        made = wt.Team(out=self.runs).plan(seen, WORDS)
        assert made.folder is not None
        return made.folder

    def _trial(self) -> Path:
        made = wt.rollout(wt.Team(out=self.runs), TASK, seed=3)
        assert made.folder is not None
        return made.folder

    def file(self, name: str, held: bytes | str) -> str:
        path = self.scratch / name
        path.write_bytes(held if isinstance(held, bytes) else held.encode("utf-8", "surrogateescape"))
        return str(path)

    def good(self, name: str) -> bytes:
        return (self.folder / name).read_bytes()

    @property
    def picture(self) -> str:
        """A copy for one example: an option may name it as what is to be written."""
        return self.file("desk.png", self.kept)


Argv = list[str]
Kind = Callable[["AgentSession", st.DrawFn], Argv]


def pictures(desk: AgentSession, draw: st.DrawFn) -> Argv:
    name = draw(st.sampled_from([".png", ".jpg", ".bmp", ".tif", ".webp"]))
    good = cv2.imencode(name, cv2.resize(cv2.imread(desk.picture), (64, 48)))[1].tobytes()
    shown = desk.file(f"shown{draw(st.sampled_from(['.png', name, '']))}", draw(damaged_bytes(good)))
    if draw(st.booleans()):
        return [
            "plan",
            desk.picture,
            "put the {this} on the blue square",
            "--picture",
            f"this={shown}",
            "--until",
            "draft",
        ]
    return ["plan", shown, WORDS, "--until", "draft"]


def depths(desk: AgentSession, draw: st.DrawFn) -> Argv:
    if draw(st.booleans()):
        depth = desk.file("depth.npy", draw(st.one_of(lying_array(), damaged_bytes(desk.good("depth.npy")))))
    else:
        depth = desk.file("depth.png", draw(damaged_bytes(desk.good("depth.png"))))
    return ["plan", desk.picture, WORDS, "--depth", depth, "--camera", str(desk.folder / "camera.json")]


def cameras(desk: AgentSession, draw: st.DrawFn) -> Argv:
    camera = json.loads(desk.good("camera.json"))
    camera["workspace_m"] = {"low": [0.2, -0.4, 0.0], "high": [0.8, 0.4, 0.3]}
    spoiled = desk.file("camera.json", draw(damaged_json(json.dumps(camera))))
    return ["plan", desk.picture, WORDS, "--depth", str(desk.folder / "depth.png"), "--camera", spoiled]


def records(desk: AgentSession, draw: st.DrawFn) -> Argv:
    source = draw(st.sampled_from([desk.plan, desk.trial]))
    folder = desk.scratch / "runs" / source.name
    shutil.copytree(source, folder)
    name = "record.json"
    spoil = damaged_json((source / name).read_text(encoding="utf-8"))
    if draw(st.integers(0, 4)) == 0:
        name = draw(st.sampled_from(sorted(str(one.relative_to(source)) for one in source.rglob("*") if one.is_file())))
        spoil = damaged_bytes((source / name).read_bytes())
    (folder / name).write_bytes(draw(spoil))
    out = ["--out", str(desk.scratch / "runs")]
    return draw(st.sampled_from([
        ["show", str(folder)], ["show", str(folder), "--role", "supervisor"], ["show", str(folder), "--replay"],
        ["show", str(folder), "--replay", "--tolerant"], ["show", str(folder), "--diff", str(desk.plan)],
        ["show", str(folder), "--from", "act", "--model", "offline"], ["list", "runs", *out],
        ["list", "runs", *out, "--html", str(desk.scratch / "runs.html")],
        ["run", TASK, "--seed", "3", "--plan", str(folder), "--replans", "0", *out],
    ]))  # fmt: skip


def stores(desk: AgentSession, draw: st.DrawFn) -> Argv:
    store = desk.file("study.db", desk.good("study.db"))
    if draw(st.booleans()):
        desk.file("study.db", draw(damaged_bytes(desk.good("study.db"))))
    else:
        _spoil_table(store, draw)
    report = ["report", store, "--out", str(desk.scratch / "report.html")]
    bench = [
        "bench",
        TASK,
        "--seeds",
        "0:1",
        "--store",
        store,
        "--jobs",
        "1",
        "--no-control",
        "all",
        "--record",
        "none",
    ]
    return draw(st.sampled_from([report, bench, [*bench, "--estimate"]]))


def _spoil_table(store: str, draw: st.DrawFn) -> None:
    base = sqlite3.connect(store)
    with contextlib.closing(base), base:
        columns = [
            (table, column[1])
            for (table,) in base.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall()
            for column in base.execute(f"PRAGMA table_info({table})").fetchall()
        ]
        table, column = draw(st.sampled_from(columns))
        (good,) = base.execute(f"SELECT {column} FROM {table} LIMIT 1").fetchone() or ("",)  # noqa: S608
        wrong = draw(
            st.sampled_from(WRONG_TEXTS + [one for one in WRONG if isinstance(one, float)] + [None, -1, b"\xff"])
        )
        if isinstance(good, str) and good.startswith(("{", "[")) and draw(st.integers(0, 3)):
            wrong = draw(damaged_json(good)).decode("utf-8", "replace")
        with contextlib.suppress(sqlite3.Error):
            base.execute(f"UPDATE {table} SET {column} = ?", (wrong,))  # noqa: S608


def photos(desk: AgentSession, draw: st.DrawFn) -> Argv:
    coco = {
        "images": [{"id": 1, "file_name": desk.picture, "width": 320, "height": 240}],
        "categories": [{"id": 1, "name": "red circle"}],
        "annotations": [
            {"id": 1, "image_id": 1, "category_id": 1, "bbox": [54, 124, 52, 52], "iscrowd": 0, "caption": "red circle"}
        ],
    }
    spoiled = desk.file("photos.json", draw(damaged_json(json.dumps(coco))))
    store = str(desk.scratch / "photos.db")
    questions = json.dumps({"image": desk.picture, "text": "red circle"})
    desk.file("point_questions.jsonl", draw(damaged_text(questions, f"{questions}\n{questions}")))
    asked = draw(st.sampled_from([
        [spoiled], ["pointing", "--set", spoiled], ["boxcheck", "--set", spoiled, "--format", "coco"],
        ["pointing", "--set", str(desk.scratch), "--format", draw(damaged_text("where2place", "refspatial"))],
    ]))  # fmt: skip
    return [
        "bench",
        *asked,
        "--store",
        store,
        "--jobs",
        "1",
        "--no-control",
        "all",
        "--record",
        "none",
        "--max-seconds",
        "2",
    ]


def profiles(desk: AgentSession, draw: st.DrawFn) -> Argv:
    from wonderful_team.models.profiles import Profile, profile_to_json, profiles_folder

    profiles_folder().mkdir(parents=True, exist_ok=True)
    good = profile_to_json(Profile("mine", "offline"))
    (profiles_folder() / "mine.json").write_bytes(draw(damaged_json(good)))
    plan = ["plan", desk.picture, WORDS, "--model", "mine", "--until", "draft", "--max-seconds", "1"]
    return draw(st.sampled_from([plan, ["list", "models"]]))


def caches(desk: AgentSession, draw: st.DrawFn) -> Argv:
    good = desk.folder / "answers.sqlite"
    plan = ["plan", desk.picture, WORDS, "--until", "draft", "--cache", "on", "--cache-file"]
    if not good.exists():
        run_quietly([*plan, str(good)])
    file = desk.file("answers.sqlite", draw(damaged_bytes(good.read_bytes())))
    return draw(
        st.sampled_from([[*plan, file], ["cache", "--cache-file", file], ["cache", "clear", "--cache-file", file]])
    )


def prompts(desk: AgentSession, draw: st.DrawFn) -> Argv:
    words = desk.scratch / "words"
    run_quietly(["list", "prompts", "--out", str(words)])
    file = draw(st.sampled_from(sorted(one for one in words.rglob("*") if one.is_file())))
    file.write_bytes(draw(damaged_bytes(file.read_bytes())))
    return ["plan", desk.picture, WORDS, "--prompts", str(words), "--until", "draft"]


def own_files(desk: AgentSession, draw: st.DrawFn) -> Argv:
    code = draw(st.sampled_from(OWN_FILES))
    file = desk.file(draw(st.sampled_from(["own.py", "o w n.py", "json.py"])), code)
    name = f"{file}:{draw(st.sampled_from(['W', 'W', 'W', '', 'x.y', 'W?x=1', 'W?', 'W?seed=3&seed=4']))}"
    return draw(st.sampled_from([
        ["run", name], ["run", name, "do it"], ["plan", desk.picture, WORDS, "--model", name, "--until", "draft"],
        ["run", "tabletop/rotate", "--method", name], ["check", name, "--seeds", "1", "--sheet", str(desk.scratch / "s.png")],
        ["bench", name, "--seeds", "0:1", "--store", str(desk.scratch / "s.db"), "--jobs", "1", "--no-control", "all"],
    ]))  # fmt: skip


def plan_options(desk: AgentSession, draw: st.DrawFn) -> Argv:
    options = {
        "--corners": ("20,10 300,10 300,230 20,230=1.0x0.5",), "--keep-out": ("wall=0,0,10,10px", "0.1,0.1,0.2,0.2m"),
        "--price": ("0,0", "planner=1,2"), "--thinking": ("low", "checker=off"), "--picture": ("this=desk.png", "this:scene=x.png"),
        "--model": ("offline", "checker=offline", "http://127.0.0.1:9/v1#x", "openai:x", "simulated:perfect", "scripted"),
        "--method": ("team", "team:s3", "x.py:Y"), "--vocabulary": ("push",), "--until": ("draft",), "--max-calls": ("3",),
        "--max-usd": ("1.5",), "--max-seconds": ("1",), "--concurrency": ("2",), "--cache": ("only",), "--prompts": ("x",),
    }  # fmt: skip
    argv = ["plan", desk.picture, WORDS, "--max-seconds", "2"]
    for option in draw(st.lists(st.sampled_from(sorted(options)), min_size=1, max_size=3)):
        argv += [option, draw(damaged_text(*options[option]))]
    return argv


def words(desk: AgentSession, draw: st.DrawFn) -> Argv:
    said = draw(
        damaged_text(
            WORDS, "put {this} into {that}", "rotate the red circle 1e9 degrees", "put 10**9 red circles on it"
        )
    )
    if draw(st.booleans()):
        return ["ground", desk.picture, said, "--area", draw(damaged_text("free area left of the red circle"))]
    return ["plan", desk.picture, said]


def worlds(desk: AgentSession, draw: st.DrawFn) -> Argv:
    name = draw(
        damaged_text(
            "tabletop/rotate@L3@clutter=2",
            "tabletop/rotate",
            "vimabench/rotate",
            "x.py:W?a=b",
            "tabletop/rotate@lighting=3",
        )
    )
    argv = ["run", name, "--max-calls", "1", "--replans", "0"]
    option = draw(st.sampled_from(["--seed", "--plan", "--video", "--keep-out", "--looks"]))
    good = {"--seed": "3", "--plan": "latest", "--video": "a.webp", "--keep-out": "x=0,0,1,1m", "--looks": "2"}[option]
    return [*argv, option, draw(damaged_text(good))] if draw(st.booleans()) else argv


def study_options(desk: AgentSession, draw: st.DrawFn) -> Argv:
    options = {
        "--seeds": ("0:2", "1000:1001"), "--perturb": ("lighting=0..3", "clutter=2"), "--shard": ("1/2",), "--isolate": ("whole,planning",),
        "--no-control": ("oracle", "all"), "--method": ("team,team:s1",), "--model": ("offline,checker=offline", "simulated:perfect:wrong_plan=1:edge=0.1"),
        "--price": ("1,2",), "--thinking": ("low",), "--repeats": ("2",), "--max-usd": ("1",), "--trial-max-calls": ("1",),
        "--store": (str(desk.scratch / "s.db"),), "--ray": (), "--record": ("none",),
    }  # fmt: skip
    suite = draw(st.sampled_from(["rotate", draw(damaged_text("vima17/L1", "rotate@L2", "fruit", "photos.json"))]))
    argv = [
        "bench",
        suite,
        "--store",
        str(desk.scratch / "s.db"),
        "--jobs",
        "1",
        "--max-seconds",
        "0.3",
        "--out",
        str(desk.scratch / "o"),
    ]
    for option in draw(st.lists(st.sampled_from(sorted(set(options) - {"--ray"})), min_size=1, max_size=3)):
        argv += [option, draw(damaged_text(*options[option]))]
    return argv


def names(desk: AgentSession, draw: st.DrawFn) -> Argv:
    """Names of runs, files and folders, roles, stages, and what a variable of the environment says."""
    wrong = damaged_text("latest", "runs/x", "supervisor", "a.html", desk.picture, "plan")
    one = draw(wrong)
    return draw(st.sampled_from([
        ["show", one], ["show", str(desk.plan), "--role", one], ["show", str(desk.plan), "--diff", one], ["report", one],
        ["show", str(desk.plan), "--from", one], ["new", "task", one, "--out", str(desk.scratch)], ["list", "runs", "--out", one],
        ["cache", "--cache-file", str(desk.scratch / one)], ["doctor", "--out", f"{desk.picture}/{one}"], [one], ["list", one],
        ["plan", desk.picture, WORDS, "--until", "draft", "--out", f"{desk.picture}/{one}"], ["check", one], ["probe", one],
        ["plan", one, WORDS], ["plan", desk.picture, WORDS, "--camera", one], ["plan", desk.picture, WORDS, "--depth", one],
        ["ground", desk.picture, "red circle", "--coco", f"{desk.picture}/{one}"],
    ]))  # fmt: skip


KINDS: tuple[Kind, ...] = (
    pictures, depths, cameras, records, stores, photos, profiles, caches, prompts, own_files, plan_options, words, worlds,
    study_options, names,
)  # fmt: skip


def run_quietly(argv: Argv) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of one command."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = run(argv)
    return code, out.getvalue(), err.getvalue()


def attempt(desk: AgentSession, kind: Kind, draw: st.DrawFn) -> tuple[Argv, str]:
    """Run one damaged input; what it did that it must not, or ""."""
    with in_scratch(desk):
        argv = kind(desk, draw)
        if as_json := draw(st.booleans()):
            argv = [*argv, "--json"]
        try:
            code, out, err = run_quietly(argv)
        except (Exception, SystemExit) as error:  # noqa: BLE001  what comes through the top is what is looked for
            return argv, f"raised {error!r}"
    if code not in CODES:
        return argv, f"exit {code}: {err.strip()[-600:]}"
    if "defect of wonderful-team" in out + err:
        return argv, err.strip()[-600:]
    if code == 2 and not (out + err).strip():
        return argv, "exit 2 without a word"
    if as_json and code != 2:
        try:
            json.loads(out)
        except ValueError as error:
            return argv, f"--json printed something else ({error}): {out[:300]!r}"
    return argv, ""


@contextlib.contextmanager
def in_scratch(desk: AgentSession) -> Iterator[None]:
    """An empty folder to spoil files in; where runs, profiles and relative paths lead meanwhile."""
    before, kept = Path.cwd(), dict(os.environ)
    desk.scratch = Path(tempfile.mkdtemp(dir=desk.folder))
    os.environ.update(
        WONDERFUL_TEAM_RUNS=str(desk.scratch / "made"),
        WONDERFUL_TEAM_CONFIG=str(desk.scratch / "config"),
        WONDERFUL_TEAM_CACHE=str(desk.scratch / "kept.sqlite"),
    )
    os.chdir(desk.scratch)
    try:
        yield
    finally:
        os.chdir(before)
        os.environ.clear()
        os.environ.update(kept)
        shutil.rmtree(desk.scratch, ignore_errors=True)
