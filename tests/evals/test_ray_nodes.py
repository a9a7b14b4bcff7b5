"""Studies on a Ray cluster of two node processes that have no copy of this package: what travels, what is bounded, what survives."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.evals import ray_runners, runners
from tests.evals.ray_cluster import NODE_KEY, ROOT, TOKEN, Cluster, cluster
from tests.evals.runners import toy_plan
from wonderful_team.core.caps import Caps
from wonderful_team.errors import ClusterLostError, ConfigError
from wonderful_team.evals.monitor import StudyStatus
from wonderful_team.evals.on_ray import run_on_ray
from wonderful_team.evals.store import Store
from wonderful_team.evals.study import StudyMonitor, StudyResult, run_study
from wonderful_team.evals.trials import RunSettings
from wonderful_team.evals.workers import Work

pytestmark = [
    pytest.mark.slow,
    pytest.mark.timeout(600),
    pytest.mark.enable_socket,
    pytest.mark.filterwarnings("ignore"),
]
pytest.importorskip("ray")
DRIVER_KEY = "driver-canary-d41c55e0"
OWN = """
import os
from pathlib import Path

import wonderful_team as wt
from beside import WORD


class Witness:
    name = "witness"

    def decide(self, situation):
        data = (Path(__file__).parent / "data" / "numbers.txt").read_text()
        print("the key is", os.environ["OPENAI_API_KEY"])
        key = "node" if os.environ["OPENAI_API_KEY"].startswith("node") else "driver"
        raise RuntimeError(f"package={wt.__file__} beside={WORD} data={data} key={key} file={__file__}")
"""


@pytest.fixture(scope="module")
def two_nodes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    with cluster(tmp_path_factory.mktemp("cluster"), 2) as made:
        yield made


@pytest.fixture(autouse=True)
def _token(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in TOKEN.items():
        monkeypatch.setenv(name, value)


def told(lines: list[str]) -> Callable[[str, StudyStatus | None], None]:
    return lambda text, status: lines.append(text) if text else None


class Background(threading.Thread):
    """A study that goes on while the test does something to its cluster."""

    def __init__(self, run: Callable[[], StudyResult]) -> None:
        super().__init__(daemon=True)
        self._run, self.ended, self.error = run, None, None  # type: ignore[assignment]
        self.start()

    def run(self) -> None:
        try:
            self.ended: StudyResult | None = self._run()
        except BaseException as error:  # noqa: BLE001  the test looks at it
            self.error: BaseException | None = error

    def wait(self, within_s: float) -> None:
        self.join(within_s)
        assert not self.is_alive()


def gates(folder: Path) -> tuple[Path, Path, RunSettings]:
    """A log, the file that lets trials end, and the settings that name both."""
    log, go = folder / "log.txt", folder / "go"
    log.touch()
    return log, go, RunSettings(extra={"log": str(log), "go": str(go)})


def wait_for(what: Callable[[], bool], within_s: float = 120) -> None:
    until = time.monotonic() + within_s
    while not what():
        assert time.monotonic() < until
        time.sleep(0.05)


def begun(log: Path) -> list[tuple[int, str]]:
    return [(int(line.split()[1]), line.split(maxsplit=2)[2]) for line in log.read_text().splitlines()]


def test_own_files_travel_and_keys_do_not(
    two_nodes: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, runs_folder: Path
) -> None:
    own = tmp_path / "mine"
    (own / "data").mkdir(parents=True)
    (own / "witness.py").write_text(OWN, encoding="utf-8")
    (own / "beside.py").write_text("WORD = 'imported'\n", encoding="utf-8")
    (own / "data" / "numbers.txt").write_text("42", encoding="utf-8")
    (own / "keys.py").write_text(f"KEY = {DRIVER_KEY!r}\n", encoding="utf-8")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    monkeypatch.setenv("OPENAI_API_KEY", DRIVER_KEY)
    missing = "import importlib.util as u; print(u.find_spec('ray') is None, u.find_spec('wonderful_team') is None)"
    assert two_nodes.python("-c", missing).split() == ["False", "True"]
    import wonderful_team as wt

    lines: list[str] = []
    study = wt.Study(
        "rotate", methods=["../mine/witness.py:Witness", f"{own}/witness.py:Witness"], seeds=range(1000, 1002), controls=(),
        store=tmp_path / "s.db", ray=two_nodes.address, ship=["../mine/data"],
    )  # fmt: skip
    ended = study.run(told(lines))
    assert (ended.status.done, ended.why) == (4, ""), lines
    with Store(tmp_path / "s.db") as store:
        rows = [row.result for row in store.rows() if row.result is not None]
    for row in rows:
        said = dict(word.split("=", 1) for word in row.reason.split() if "=" in word)
        assert "runtime_resources" in said["package"]
        assert "runtime_resources" in said["file"]
        assert (said["beside"], said["data"], said["key"]) == ("imported", "42", "node")
        # The record came here, and links to nothing on the node.
        assert Path(row.page).is_file()
        assert Path(row.page).is_relative_to(runs_folder)
        assert json.loads((Path(row.page).parent / "record.json").read_text(encoding="utf-8"))
        assert row.versions == {**row.versions, **(study._shipment().versions)}
    for node in two_nodes.nodes:
        for file in node.folder.rglob("*"):
            if file.is_file() and not file.is_symlink():
                held = file.read_bytes()
                assert DRIVER_KEY.encode() not in held, file
                assert NODE_KEY.encode() not in held, file
                assert file.suffix != ".db"


def test_model_calls_of_both_nodes_share_one_limit(two_nodes: Cluster, tmp_path: Path) -> None:
    log, _, settings = gates(tmp_path)
    plan = toy_plan(4)
    with Store(tmp_path / "s.db") as store:
        store.want(plan.name, plan.trials(), plan.request())
        work = Work(store.path, plan.name, ray_runners.calling, settings, at_once=3)
        most = run_on_ray(work, store, StudyMonitor(store, plan.name, told([])), two_nodes.address, 2, 2)
        assert store.count(plan.name, "done") == 16
    lines = [line.split() for line in log.read_text().splitlines()]
    assert len({line[1] for line in lines if line[0] == "by"}) == 2
    spans = [(float(line[0]), float(line[1])) for line in lines if line[0] != "by"]
    at_once = [sum(began <= start < ended for began, ended in spans) for start, _ in spans]
    assert len(spans) == 16
    assert max(at_once) == most == 2


def test_workers_never_open_the_store(two_nodes: Cluster, tmp_path: Path) -> None:
    ended = run_study(toy_plan(2), tmp_path / "s.db", ray_runners.watched, ray=two_nodes.address)
    assert ended.status.done == 8
    with Store(tmp_path / "s.db") as store:
        facts = {tuple(sorted(row.result.facts.items())) for row in store.rows() if row.result is not None}
    assert facts == {(("held", 0.0), ("opened", 0.0), ("seen", 1.0))}


def test_trials_of_a_node_that_is_killed_run_again_elsewhere(two_nodes: Cluster, tmp_path: Path) -> None:
    third = two_nodes.add()
    log, go, settings = gates(tmp_path)
    lines: list[str] = []
    study = Background(
        lambda: run_study(
            toy_plan(3),
            tmp_path / "s.db",
            ray_runners.gated,
            settings=settings,
            ray=two_nodes.address,
            report=told(lines),
        )
    )
    try:
        wait_for(lambda: len({pid for pid, _ in begun(log)}) == 3)
        doomed = set(third.pids())
        third.kill()
    finally:
        go.touch()
    study.wait(180)
    assert study.error is None
    assert study.ended is not None
    assert (study.ended.status.done, study.ended.why) == (12, ""), lines
    times = Counter(key for _, key in begun(log))
    lost = {key for pid, key in begun(log) if pid in doomed}
    assert lost
    assert {key for key, count in times.items() if count > 1} == lost
    with Store(tmp_path / "s.db") as store:
        assert [row.discarded for row in store.rows() if row.spec.key in lost] == [1] * len(lost)
        here = tmp_path / "here.db"
        run_study(toy_plan(3), here, runners.quick, jobs=1)
        with Store(here) as other:
            assert [(row.spec, row.result) for row in store.rows()] == [(row.spec, row.result) for row in other.rows()]
    warnings = [line for line in lines if line.startswith("warning")]
    assert len(warnings) == 1, lines
    assert "died; run again elsewhere: toy/" in warnings[0]
    assert "warning: node " in warnings[0]


def test_a_trial_that_kills_its_worker_three_times_is_an_error_and_the_rest_goes_on(
    two_nodes: Cluster, tmp_path: Path
) -> None:
    lines: list[str] = []
    ended = run_study(toy_plan(3), tmp_path / "s.db", ray_runners.deadly, ray=two_nodes.address, report=told(lines))
    assert ended.status.done == 12, lines
    assert ended.status.outcomes["error"] == 1
    with Store(tmp_path / "s.db") as store:
        errors = [row.result for row in store.rows() if row.result is not None and row.result.outcome == "error"]
    assert errors[0].reason.startswith("the worker process died 3 times")


def test_a_study_that_no_worker_can_run_says_why(
    two_nodes: Cluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import wonderful_team as wt

    monkeypatch.setenv("ANTHROPIC_API_KEY", DRIVER_KEY)
    study = wt.Study(
        "rotate", models="anthropic:claude-none", seeds=[1000], controls=(), store=tmp_path / "s.db",
        ray=two_nodes.address, allow_unpriced=True, trial_caps=Caps(tokens=10),
    )  # fmt: skip
    with pytest.raises(ConfigError, match="no worker of the cluster can run this study.*ANTHROPIC_API_KEY"):
        study.run()


def test_another_version_on_the_cluster_is_told(two_nodes: Cluster, tmp_path: Path) -> None:
    change = f"""
import json
from ray._raylet import GcsClient
gcs = GcsClient(address="{two_nodes.address}")
held = json.loads(gcs.internal_kv_get(b"CLUSTER_METADATA", b"cluster"))
python, held["python_version"] = held["python_version"], "NEW"
gcs.internal_kv_put(b"CLUSTER_METADATA", json.dumps(held).encode(), True, b"cluster")
print(python)
"""
    before = two_nodes.python("-c", change.replace("NEW", "3.9.1")).strip()
    try:
        with pytest.raises(ConfigError, match=r"Version mismatch.*Python: 3\.9\.1.*Python: 3\.1"):
            run_study(toy_plan(1), tmp_path / "s.db", ray_runners.watched, ray=two_nodes.address)
    finally:
        two_nodes.python("-c", change.replace("NEW", before))


def test_an_interrupt_lets_trials_end_and_a_second_one_drops_them(two_nodes: Cluster, tmp_path: Path) -> None:
    (tmp_path / "slow.py").write_text(
        "import time\nfrom pathlib import Path\n\n\nclass Slow:\n    name = 'slow'\n\n    def decide(self, situation):\n"
        f"        Path({str(tmp_path / 'began')!r}).touch()\n        time.sleep(300)\n",
        encoding="utf-8",
    )
    words = ["bench", "rotate", "--method", f"{tmp_path}/slow.py:Slow", "--seeds", "1000:1004", "--no-control", "all"]
    words += ["--ray", two_nodes.address, "--store", str(tmp_path / "s.db"), "--out", str(tmp_path / "runs")]
    running = subprocess.Popen(
        [sys.executable, "-m", "wonderful_team", *words],
        cwd=ROOT,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        wait_for((tmp_path / "began").exists)
        running.send_signal(signal.SIGINT)
        assert running.stderr is not None
        line = ""
        while "interrupted: waiting" not in line:
            line = running.stderr.readline()
            assert line
        running.send_signal(signal.SIGINT)
        running.stderr.read()
        assert running.wait(60) == 130
    finally:
        running.kill()
    with Store(tmp_path / "s.db") as store:
        assert all(row.result is None for row in store.rows())
        states = store._base.execute("SELECT DISTINCT state FROM trials").fetchall()
        assert [row[0] for row in states] == ["pending"]


def test_when_the_head_dies_the_study_ends_and_goes_on_without_ray(tmp_path: Path) -> None:
    log, go, settings = gates(tmp_path)
    store, plan = tmp_path / "s.db", toy_plan(2)
    with cluster(tmp_path / "cluster", 1) as made:
        run_study(toy_plan(1), store, runners.quick, jobs=1)
        study = Background(lambda: run_study(plan, store, ray_runners.gated, settings=settings, ray=made.address))
        wait_for(lambda: bool(begun(log)))
        made.nodes[0].kill()
        study.wait(50)
    assert isinstance(study.error, ClusterLostError)
    assert "the head of the Ray cluster at" in str(study.error)
    assert "what ended before is kept; the same command goes on, also without --ray" in str(study.error)
    with Store(store) as opened:
        assert (opened.count(plan.name, "done"), opened.count(plan.name, "claimed")) == (4, 0)
    assert run_study(plan, store, runners.quick, jobs=1).status.done == 8
