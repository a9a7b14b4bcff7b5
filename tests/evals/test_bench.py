"""`bench`, `report`, `new` and `check` as a person types them, on our own tabletop and on files of one's own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import wonderful_team as wt
from tests.evals.own_files import LENIENT, METHOD
from wonderful_team import registry
from wonderful_team.api.known_suites import known_suites
from wonderful_team.api.trial import model_of, run_trial
from wonderful_team.api.trial_setup import reproduce
from wonderful_team.cli.app import run
from wonderful_team.core.caps import Caps
from wonderful_team.errors import ConfigError
from wonderful_team.evals.store import Store
from wonderful_team.evals.trials import Condition, RunSettings, TrialSpec
from wonderful_team.evals.workers import run_safely
from wonderful_team.images import to_png


def _bench(*words: str, store: Path) -> int:
    return run(["bench", *words, "--store", str(store), "--jobs", "1", "--json"])


def test_a_method_of_fifteen_lines_against_the_controls(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.py").write_text(METHOD, encoding="utf-8")
    name = f"{tmp_path / 'mine.py'}:Pusher"
    words = ("rotate", "--method", name, "--seeds", "1000:1002", "--no-control", "offline", "--record", "full")
    assert _bench(*words, store=tmp_path / "s.db") == 0
    told = json.loads(capsys.readouterr().out)["result"]
    rates = {one["method"]: (one["successes"], one["scored"]) for one in told["conditions"]}
    assert rates == {name: (0, 2), "oracle": (2, 2), "no-op": (0, 2), "random": (0, 2)}
    assert run(["report", str(tmp_path / "s.db"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["result"]
    page = Path(told["page"])
    html = page.read_text(encoding="utf-8")
    links = [part.split('"')[0] for part in html.split('<a href="')[1:]]
    pages = [page.parent / link for link in links if link.endswith("page.html")]
    assert pages
    assert all(path.is_file() for path in pages)
    # Nothing is left to do the second time.
    assert _bench(*words, store=tmp_path / "s.db") == 0
    with Store(tmp_path / "s.db") as store:
        assert len(store.rows()) == 8


def test_offline_runs_through_the_study_like_any_model(tmp_path: Path) -> None:
    study = wt.Study("rotate", seeds=[1000], store=tmp_path / "s.db", controls=("offline",), jobs=1, record="none")
    ended = study.run()
    assert ended.status.done == 1
    summary = study.summary()
    cell = summary.cell(summary.compared[0])
    assert cell.badges == ("OFFLINE",)
    assert cell.results[0].calls > 0
    assert 0 < cell.results[0].rounds <= cell.results[0].calls
    assert "offline" in cell.results[0].provenance
    frame = study.to_pandas()
    assert list(frame["outcome"]) == [cell.results[0].outcome]
    assert "OFFLINE" in "\n".join(study.lines())


def test_a_wrong_scorer_and_wrong_units_are_caught(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "desk.py").write_text(LENIENT, encoding="utf-8")
    name = f"{tmp_path / 'desk.py'}:AgentSession"
    assert run(["check", name, "--seeds", "4"]) == 1
    said = capsys.readouterr().out
    assert "doing nothing succeeds in 4 of 4" in said
    assert "the median depth is 1e+03; in metres" in said
    assert "the seed is not used" in said
    assert (
        _bench(name, "--seeds", "1000:1002", "--no-control", "offline", "--method", "no-op", store=tmp_path / "s.db")
        == 0
    )
    assert any("doing nothing succeeds" in text for text in json.loads(capsys.readouterr().out)["result"]["warnings"])


REFUSED = """
import wonderful_team as wt


class Careless:
    name = "careless"
    made = 0

    def __init__(self):
        Careless.made += 1
        self.far = {far}

    def decide(self, situation):
        if situation.refused is not None or situation.executed:
            return wt.Done("tried once")
        high = situation.limits.high_m
        step = wt.PickPlaceStep("G1", pick="it", place=wt.At("there"))
        if not self.far:
            return wt.Done("nothing")
        return wt.Act((wt.PlannedAction(step, wt.PickPlace([high[0] + 1.0, 0.0, 0.0], [high[0] + 2.0, 0.0, 0.0])),))
"""


def test_a_plan_that_the_gate_refuses_now_and_then_is_told_and_is_nothing_wrong(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "careless.py"
    file.write_text(REFUSED.format(far="Careless.made % 2"), encoding="utf-8")
    assert run(["check", f"{file}:Careless", "--seeds", "6"]) == 0, capsys.readouterr().out
    said = capsys.readouterr().out
    assert "note  the gate refused a plan in " in said
    assert said.rstrip().endswith("checked: nothing wrong")
    always = tmp_path / "always.py"
    always.write_text(REFUSED.format(far="True"), encoding="utf-8")
    assert run(["check", f"{always}:Careless", "--seeds", "2"]) == 1
    assert "BAD   the gate refused a plan in every trial: " in capsys.readouterr().out


@pytest.mark.parametrize(
    ("kind", "name", "seeds"),
    [
        ("task", "cups", "2"),
        ("world", "AgentSession", "4"),
        ("method", "Mine", "2"),
        ("model", "Mine", "1"),
        ("detector", "Mine", "2"),
    ],  # fmt: skip
)
def test_new_files_run_pass_their_check_and_their_own_test(
    tmp_path: Path, kind: str, name: str, seeds: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["new", kind, name, "--out", str(tmp_path)]) == 0
    file = tmp_path / f"{name.lower()}.py"
    assert run(["check", f"{file}:{name}", "--seeds", seeds]) == 0, capsys.readouterr().out
    if kind in ("task", "world", "detector"):
        if kind != "detector":
            sheet = tmp_path / f"{name.lower()}_{name}.png"
            assert sheet.read_bytes().startswith(b"\x89PNG")
            assert "the scorer tells the oracle from doing nothing" in capsys.readouterr().out
        environment = {**os.environ, "PYTEST_ADDOPTS": ""}
        tested = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", f"test_{file.name}"],
            cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert tested.returncode == 0, tested.stdout
    assert run(["new", kind, name, "--out", str(tmp_path)]) == 2, "nothing is overwritten"
    assert run(["new", kind, "no name", "--out", str(tmp_path)]) == 2


def test_grounding_on_photos_needs_no_simulator(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    world = wt.make_world("tabletop/fruit_placement/all_match", seed=1000)
    view = world.observe().main
    mask = world.privileged.mask(next(iter(world.privileged.truth()["things"])))  # type: ignore[attr-defined]
    thing = next(iter(world.privileged.truth()["things"]))  # type: ignore[attr-defined]
    world.close()
    rows, columns = mask.any(axis=1).nonzero()[0], mask.any(axis=0).nonzero()[0]
    box = [int(columns[0]), int(rows[0]), int(columns[-1] - columns[0] + 1), int(rows[-1] - rows[0] + 1)]
    (tmp_path / "a.png").write_bytes(to_png(view.rgb))
    coco = {
        "images": [{"id": 7, "file_name": "a.png"}],
        "annotations": [{"image_id": 7, "bbox": box, "instruction": str(thing)}],
    }
    (tmp_path / "photos.json").write_text(json.dumps(coco), encoding="utf-8")
    (tmp_path / "mine.py").write_text(
        "class Corner:\n    name = 'corner'\n    def decide(self, situation): ...\n"
        "    def locate(self, observation, words):\n        return [(0.0, 0.0, 5.0, 5.0) for _ in words]\n",
        encoding="utf-8",
    )
    words = (str(tmp_path / "photos.json"), "--method", f"team,{tmp_path / 'mine.py'}:Corner")
    assert _bench(*words, store=tmp_path / "s.db") == 0
    told = json.loads(capsys.readouterr().out)["result"]
    won = {one["method"].rpartition(":")[2]: one["successes"] for one in told["conditions"]}
    assert won == {"team": 1, "Corner": 0}


def test_a_photo_that_meets_a_cap_or_an_own_method_that_gives_up_is_a_failure_with_its_stage(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(to_png(np.full((120, 160, 3), 200, np.uint8)))
    coco = {
        "images": [{"id": 7, "file_name": "a.png"}],
        "annotations": [{"image_id": 7, "bbox": [1, 1, 9, 9], "instruction": "the red block"}],
    }
    (tmp_path / "photos.json").write_text(json.dumps(coco), encoding="utf-8")
    (tmp_path / "mine.py").write_text(
        "from wonderful_team.errors import NotFoundError\n"
        "class Lost:\n    name = 'lost'\n    def decide(self, situation): ...\n"
        "    def locate(self, observation, words):\n        raise NotFoundError('nowhere')\n",
        encoding="utf-8",
    )
    photos = str(tmp_path / "photos.json")
    capped = RunSettings(Caps(calls=1))
    trial = run_trial(TrialSpec(photos, 0, Condition("team:paper", "offline")), capped)
    assert (trial.outcome, trial.stage, trial.calls) == ("failure", "budget", 1)
    assert "the cap of 1 calls is reached" in trial.reason
    own = run_trial(TrialSpec(photos, 0, Condition(f"{tmp_path / 'mine.py'}:Lost", "offline")), RunSettings())
    assert (own.outcome, own.stage, own.reason) == ("failure", "grounding", "nowhere")


def test_controls_draw_no_picture_and_a_world_that_breaks_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from wonderful_team.sims.tabletop.table import Table

    def drawn(*_: object) -> None:
        raise AssertionError("something was drawn")

    with monkeypatch.context() as patched:
        patched.setattr(Table, "draw", drawn)
        outcomes = [
            run_trial(TrialSpec("tabletop/rotate", 7, Condition(name, "-")), RunSettings()).outcome
            for name in ("oracle", "no-op", "random")
        ]
        assert outcomes == ["success", "failure", "failure"]
    (tmp_path / "far.py").write_text(
        "from wonderful_team.errors import WorldUnavailableError\n"
        "def far():\n    raise WorldUnavailableError('the simulator hangs')\n",
        encoding="utf-8",
    )
    spec = TrialSpec(f"{tmp_path / 'far.py'}:far", 7, Condition("team", "offline"))
    broken = run_safely(run_trial, spec, RunSettings())
    assert (broken.outcome, broken.stage) == ("error", "world")
    assert "the simulator hangs" in broken.reason


def test_an_estimate_runs_no_trial_of_the_study(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert (
        _bench(
            "rotate",
            "--estimate",
            "--pilot",
            "1",
            "--model",
            "simulated:perfect",
            "--no-control",
            "offline",
            store=tmp_path / "s.db",
        )
        == 0
    )
    told = json.loads(capsys.readouterr().out)["result"]
    assert told["pairs"] == 10
    assert told["total"]["calls"] > 0
    assert not (tmp_path / "s.db").exists()


@pytest.mark.parametrize(
    "words",
    [
        ("rotate", "--isolate", "memory"),
        ("rotate", "--perturb", "fog=1"),
        ("rotate", "--model", "offline,chequer=offline"),
        ("rotate", "--thinking", "loud"),
        ("rotate", "--local-only", "--model", "http://8.8.8.8/v1#big"),
        ("rotate", "--method", "nobody"),
        ("rotate", "--model", "nobody"),
        ("rotate", "--seeds", "5:5"),
        ("rotate", "--shard", "3/2"),
        ("rotate@L9",),
        ("nofile.py:cups",),
        ("nothing",),
        (),
    ],
)
def test_wrong_use_is_told_before_anything_runs(tmp_path: Path, words: tuple[str, ...]) -> None:
    assert _bench(*words, store=tmp_path / "s.db") == 2
    assert not (tmp_path / "s.db").exists()


def test_isolation_gives_the_other_roles_to_truth(monkeypatch: pytest.MonkeyPatch) -> None:
    truth = object()
    monkeypatch.setattr(registry, "make_model", lambda name, **more: truth)
    team = registry.grounding_roles("team")
    planning = model_of("mine", "planning", object(), team)  # type: ignore[arg-type]
    assert planning["*"] == "mine"
    assert {role for role, model in planning.items() if model is truth} == {"manager", "checker", "mover"}
    grounding = model_of("mine", "grounding", object(), team)  # type: ignore[arg-type]
    assert grounding["*"] is truth
    assert {role for role, model in grounding.items() if model == "mine"} == {"manager", "checker", "mover"}
    assert model_of("mine", "", object(), team) == "mine"  # type: ignore[arg-type]


def test_generalisation_levels_are_suites(tmp_path: Path) -> None:
    suites = known_suites()
    assert "tabletop/rotate@L3" in suites["vima17/L3"].tasks
    study = wt.Study("rotate@L2", seeds=[1000], store=tmp_path / "s.db", methods=["no-op"], controls=(), jobs=1)
    assert study.run().status.outcomes == {"failure": 1}


@pytest.mark.parametrize(
    ("condition", "command"),
    [
        (
            Condition("team", "big, checker=small", replans=3),
            "wonderful-team run tabletop/rotate --seed 5 --replans 3 --method team --model big --model checker=small --thinking low",
        ),
        (
            Condition("team", "big, checker=small", "planning", "clutter=2"),
            "wonderful-team bench tabletop/rotate --seeds 5 --no-control all --record full --isolate planning --perturb clutter=2 "
            "--replans 0 --method team --model big,checker=small --thinking low",
        ),
        (
            Condition("oracle", "-", perturb="camera=1"),
            "wonderful-team bench tabletop/rotate --seeds 5 --no-control all --record full --perturb camera=1 --replans 0 "
            "--method oracle",
        ),
    ],
)
def test_a_trial_says_the_command_that_runs_it_again(condition: Condition, command: str) -> None:
    assert reproduce(TrialSpec("tabletop/rotate", 5, condition), {"thinking": {"*": "low"}}) == command


def test_a_study_takes_names_only(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="a study takes names"):
        wt.Study("rotate", models=[object()], store=tmp_path / "s.db")  # type: ignore[list-item]


BY_ROLE = """
from pathlib import Path
import wonderful_team as wt

class Big:
    name = "big"
    def __init__(self):
        self.inner = wt.make_model("offline")
    def answer(self, request):
        with Path(__file__).with_name("heard").open("a") as file:
            file.write(f"{self.name} {request.role}\\n")
        return self.inner.answer(request)

class Small(Big):
    name = "small"
"""


def test_models_by_role_answer_for_their_roles_and_stand_in_the_label(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.py").write_text(BY_ROLE, encoding="utf-8")
    file = tmp_path / "mine.py"
    words = ("rotate", "--seeds", "1000", "--no-control", "all", "--record", "none", "--thinking", "checker=low")
    models = f"{file}:Big,checker={file}:Small"
    assert _bench(*words, "--model", models, "--concurrency", "2", store=tmp_path / "s.db") == 0
    told = json.loads(capsys.readouterr().out)["result"]["conditions"]
    assert [(one["model"], one["how"]) for one in told] == [
        (f"{file}:Big, checker={file}:Small", "checker thinking low")
    ]
    heard = {tuple(line.split()) for line in (tmp_path / "heard").read_text(encoding="utf-8").splitlines()}
    assert ("small", "checker") in heard
    assert ("big", "supervisor") in heard
    assert {role for name, role in heard if name == "small"} == {"checker"}
    # Another level of thinking is another trial, not the same one resumed.
    keys = [
        {spec.key for spec in wt.Study("rotate", thinking=level, store=tmp_path / "s.db").plan.trials()}
        for level in (None, "low", "high")
    ]
    asked = [{key for key in one if '"team"' in key} for one in keys]
    assert not asked[0] & asked[1]
    assert not asked[1] & asked[2]
    assert keys[0] & keys[1], "controls ask no model: they are the same"
