"""The report says what the store holds, recomputed here by hand with SQL and arithmetic alone."""

from __future__ import annotations

import csv
import re
import sqlite3
import warnings
from dataclasses import replace
from math import comb
from pathlib import Path

import numpy as np
import pytest

from tests.evals import runners
from tests.evals.runners import toy_plan
from wonderful_team.errors import ConfigError
from wonderful_team.evals.leases import Owner
from wonderful_team.evals.paper import paper_figure
from wonderful_team.evals.report import latex_tables
from wonderful_team.evals.report.content import page_content
from wonderful_team.evals.report.latex import tex
from wonderful_team.evals.report.page import read_stores, write_all
from wonderful_team.evals.report.plots import cost_plot, rate_plot
from wonderful_team.evals.store import Store
from wonderful_team.evals.study import run_study
from wonderful_team.evals.summary import Cell, summarise
from wonderful_team.evals.trials import Condition, Row, TrialRow, TrialSpec
from wonderful_team.images import to_png


@pytest.fixture
def store(tmp_path: Path) -> Path:
    path = tmp_path / "study.db"
    run_study(toy_plan(15), path, runners.quick, jobs=1)
    return path


def test_figures_recomputed_by_hand_from_the_store(store: Path) -> None:
    base = sqlite3.connect(store)
    won = dict(base.execute("SELECT method, SUM(outcome='success') FROM trials GROUP BY method"))
    usd = dict(base.execute("SELECT method, SUM(usd) FROM trials GROUP BY method"))
    both = (
        "SELECT COUNT(*) FROM trials a JOIN trials b USING(task, seed, repeat) WHERE a.method='good' AND b.method='bad'"
    )
    only_good = base.execute(f"{both} AND a.outcome='success' AND b.outcome='failure'").fetchone()[0]
    only_bad = base.execute(f"{both} AND a.outcome='failure' AND b.outcome='success'").fetchone()[0]
    base.close()
    made = write_all([store], store.with_name("page.html"))
    good, bad = (made.summary.cell(one) for one in made.summary.compared)
    assert (good.rate.successes, good.rate.n, bad.rate.successes, bad.rate.n) == (won["good"], 30, won["bad"], 30)
    assert good.usd_per_trial == pytest.approx(usd["good"] / 30)
    assert good.usd_per_success == pytest.approx(usd["good"] / won["good"])
    (pair,) = made.summary.pairs()
    assert (pair.only_first, pair.only_second) == (only_good, only_bad)
    discordant, fewer = only_good + only_bad, min(only_good, only_bad)
    by_hand = min(1.0, 2 * sum(comb(discordant, k) for k in range(fewer + 1)) / 2**discordant)
    assert pair.p == pytest.approx(by_hand)
    html = made.page.read_text(encoding="utf-8")
    # Wilson's interval as his paper has it: the roots of (share - p)^2 = z^2 p (1 - p) / n.
    z, n, share = 1.959964, 30, won["good"] / 30
    roots = np.roots([1 + z * z / n, -(2 * share + z * z / n), share * share])
    assert f"<td>{100 * won['good'] / 30:.1f} %</td><td>{100 * min(roots):.1f} to {100 * max(roots):.1f}</td>" in html
    assert f"n = 30 pairs, exact p = {by_hand:.3g}" in html
    with made.csv.open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert sum(line["method"] == "good" and line["outcome"] == "success" for line in lines) == won["good"]


def test_the_page_has_its_parts_in_order_and_loads_nothing_from_elsewhere(store: Path) -> None:
    html = write_all([store], store.with_name("page.html"), latex=store.with_name("tex")).page.read_text(
        encoding="utf-8"
    )
    heads = (
        "What was run",
        "Methods and models",
        "Success, and",
        "Per task",
        "All pairs",
        "Where it fails",
        "Planning alone",
    )
    places = [html.index(f"<h2>{head}") for head in (*heads, "Trials", "Reproduce")]
    assert places == sorted(places)
    assert not re.search(r"(src|href)=\"https?://", html)
    assert "discordant trials" in html
    assert (store.with_name("tex") / "conditions.tex").read_text(encoding="utf-8").count(r"\toprule") == 1


def test_latex_tables_hold_the_same_figures_and_escape_what_latex_reads(store: Path) -> None:
    made = write_all([store], store.with_name("page.html"), latex=store.with_name("tex"))
    texts = {path.stem: path.read_text(encoding="utf-8") for path in made.latex}
    assert set(texts) == {"conditions", "tasks", "pairs"}
    good = made.summary.cell(made.summary.compared[0])
    assert good.condition.method == "good"
    assert rf"good $\cdot$ m & {100 * good.rate.successes / 30:.1f} & " in texts["conditions"]
    assert texts["pairs"].count(r"\\") >= 2
    for text in texts.values():
        assert text.count("{") == text.count("}")
        assert not re.search(r"(?<!\\)[#_]|(?<!\\)%(?! needs)", text)
    rows = [_row("a_b", 1000, "success", task="tabletop/rotate"), _row("/x/y.py:C", 1000, "failure", "50%")]
    tables = latex_tables(summarise(rows, []))
    assert r"a\_b" in tables["conditions"]
    assert r"y.py:C $\cdot$ 50\%" in tables["conditions"]
    # Without its name it is printed as a dash in LaTeX's first font encoding.
    assert tex("nlap | truth") == r"nlap \textbar{} truth"


def test_the_table_of_trials_has_a_line_for_each_with_its_condition(store: Path) -> None:
    made = write_all([store], store.with_name("page.html"))
    with made.csv.open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert len(lines) == 60
    columns = (
        "task seed repeat method model isolate perturb replans how looks outcome stage reason calls tokens pictures usd"
    )
    assert list(lines[0])[:17] == columns.split()


def test_shards_merge_to_the_whole(store: Path, tmp_path: Path) -> None:
    parts = []
    for part in (1, 2, 3):
        parts.append(tmp_path / f"part{part}.db")
        run_study(toy_plan(15, shard=(part, 3)), parts[-1], runners.quick, jobs=1)
    rows, requests, conflicts = read_stores(parts)
    whole, asked, _ = read_stores([store])
    assert conflicts == []
    assert {row.spec.key: row.result for row in rows} == {row.spec.key: row.result for row in whole}
    merged, single = summarise(rows, requests), summarise(whole, asked)
    assert [merged.cell(one).rate for one in merged.compared] == [single.cell(one).rate for one in single.compared]


def test_a_trial_that_ended_differently_in_two_stores_is_told(store: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.db"
    run_study(toy_plan(15), other, runners.capped, jobs=1)
    _, _, conflicts = read_stores([store, other])
    assert conflicts
    assert "the first is kept" in conflicts[0]


def _row(method: str, seed: int, outcome: str, model: str = "m", task: str = "toy/a", perturb: str = "") -> Row:
    condition = Condition(method, model, perturb=perturb)
    return Row(TrialSpec(task, seed, condition), TrialRow(outcome, calls=1))  # type: ignore[arg-type]


def test_no_method_is_called_the_best_of_those_run_on_other_tasks() -> None:
    asked = [{"methods": list("abcd"), "models": ["m"]}]
    rows = [_row(name, seed, "success" if name < "c" else "failure") for name in "abcd" for seed in (1000, 1001)]
    assert summarise(rows, asked).headline()[0].startswith("Of 4 compared")
    rows.append(_row("d", 1000, "success", task="toy/b"))
    told = summarise(rows, asked).headline()
    assert told[0] == "4 were run, not all on the same tasks: none of them is the best of all."
    assert len(told) > 1
    assert not any("no data" in one for one in told)


def test_a_page_of_many_methods_can_be_read(tmp_path: Path) -> None:
    names = ["nlap:privileged:no-cot", *(f"a-method-with-a-rather-long-name-{n}" for n in range(8))]
    model = "simulated:a-profile-with-a-long-name-too"
    rows = [_row(name, seed, "success", model) for name in names for seed in (1000, 1001)]
    rows += [_row(name, 1000, "failure", model, task=f"toy/{name[-1]}") for name in ("b", "c")]
    asked = [
        {"methods": [*names, "b", "c"], "models": [model], "suites": ["toy/a"], "protocols": ["p"], "controls": []}
    ]
    summary = summarise(rows, [{**asked[0], "repeats": 1, "notes": [], "shard": [1, 1]}] * 2)
    with warnings.catch_warnings():
        # Labels that leave no room for figures are a warning of matplotlib's.
        warnings.simplefilter("error")
        plot = rate_plot(summary)
        cost_plot(summary)
    assert "nlap:privileged:no-cot · PRIVILEGED (2/2)" in plot
    assert f"success with {model} [%]," in plot, "whose figures they are stands at the axis, once"
    content = page_content(summary, [], None, tmp_path / "p.html")
    assert (len(content["pairs"]), content["apart"]) == (36, 19), "what shares no scene is counted, not compared"


def test_errors_are_not_failures_and_more_than_two_percent_of_them_warn() -> None:
    asked = [{"methods": ["a"], "models": ["m"]}]
    rows = [_row("a", seed, "success") for seed in range(1000, 1050)]
    quiet = summarise([*rows, _row("a", 1050, "error")], asked)
    assert not any("errors" in text for text in quiet.warnings())  # 1 of 51 is 1.96 %
    loud = summarise([*rows, _row("a", 1050, "error"), _row("a", 1051, "error")], asked)
    assert any("errors in toy/a 2 of 52: not scored" in text for text in loud.warnings())
    cell = loud.cell(Condition("a", "m"))
    assert (cell.rate.successes, cell.rate.n) == (50, 50)


def test_nothing_scored_is_no_data(tmp_path: Path) -> None:
    cell = Cell(Condition("a", "m"), (TrialRow("error"), TrialRow("unscored")), (1000, 1001))
    assert str(cell.rate) == "no data"
    assert cell.usd_per_success is None
    with Store(tmp_path / "s.db") as store:
        plan = toy_plan(2)
        store.want(plan.name, plan.trials(), plan.request())
    made = write_all([tmp_path / "s.db"], tmp_path / "p.html")
    assert "no data" in made.page.read_text(encoding="utf-8")
    assert any("not ended yet" in text for text in made.warnings)


def test_controls_accuse_a_wrong_scorer() -> None:
    asked = [{"methods": ["a"], "models": ["m"]}]
    rows = [_row("oracle", seed, "success", "-") for seed in range(1000, 1010)]
    right = summarise([*rows, *(_row("no-op", seed, "failure", "-") for seed in range(1000, 1010))], asked)
    assert right.warnings() == []
    wrong = summarise([*rows, *(_row("no-op", seed, "success", "-") for seed in range(1000, 1003))], asked)
    assert any("doing nothing succeeds in 3 of 3" in text for text in wrong.warnings())
    missed = summarise([*rows, _row("oracle", 1010, "failure", "-")], asked)
    assert any("the oracle fails 1 of 11" in text for text in missed.warnings())


def test_controls_are_judged_tier_by_tier() -> None:
    rows = [_row("oracle", seed, "success", "-", perturb="clutter=1") for seed in range(1000, 1010)]
    rows += [_row("oracle", seed, "failure", "-", perturb="clutter=3") for seed in range(1000, 1003)]
    found = summarise(rows, [{"methods": ["a"], "models": ["m"]}]).warnings()
    assert [text for text in found if "oracle" in text] == [
        "toy/a: clutter=3: the oracle fails 3 of 3: its solution or the scorer is wrong, or the scene is unsolvable"
    ]


def test_parts_and_tiers_stand_apart_and_are_paired_with_the_whole(tmp_path: Path) -> None:
    path = tmp_path / "s.db"
    run_study(toy_plan(15, isolate=("", "planning"), perturb=("", "lighting=3")), path, runners.quick, jobs=1)
    made = write_all([path], tmp_path / "page.html")
    assert {one.label for one in made.summary.main} == {"good · m", "bad · m"}
    assert [(one.first.label, one.second.label) for one in made.summary.pairs()][0] == ("good · m", "bad · m")
    assert all(
        (one.first.isolate, one.first.perturb) == (one.second.isolate, one.second.perturb)
        for one in made.summary.pairs()
    )
    base = sqlite3.connect(path)
    lost, gained = base.execute(
        "SELECT SUM(a.outcome='success' AND b.outcome='failure'), SUM(a.outcome='failure' AND b.outcome='success') "
        "FROM trials a JOIN trials b USING(task, seed, repeat, method) WHERE a.method='good' AND a.isolate='' AND "
        "b.isolate='' AND a.perturb='' AND b.perturb='lighting=3'"
    ).fetchone()
    base.close()
    ((whole, members), _) = made.summary.variants()
    assert whole.label == "good · m"
    (tier,) = [against for one, against in members if one.perturb == "lighting=3" and not one.isolate]
    assert tier is not None
    assert (tier.only_second, tier.only_first) == (lost, gained)
    html = made.page.read_text(encoding="utf-8")
    assert "<td>planning alone · lighting=3</td>" in html
    assert f"<td>{100 * (gained - lost) / 30:+.1f}</td>" in html


def test_the_page_shows_the_plan_of_trials_and_stands_alone(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    for name in ("a", "b"):
        (runs / name).mkdir(parents=True)
        (runs / name / "final.png").write_bytes(to_png(np.full((40, 80, 3), 90, np.uint8)))
        (runs / name / "page.html").write_text("a page", encoding="utf-8")
    rows = [_row("a", 1000, "success"), _row("a", 1001, "failure")]
    with Store(tmp_path / "s.db") as store:
        plan = toy_plan(1)
        store.want(plan.name, plan.trials(), plan.request())
        owner = Owner.this_process()
        for name in ("a", "b"):
            claim = store.claim(plan.name, owner)
            assert claim is not None
            store.finish(claim.trial, owner, replace(rows[0].result, page=str(runs / name / "page.html")))  # type: ignore[type-var]
    html = write_all([tmp_path / "s.db"], tmp_path / "out" / "p.html").page.read_text(encoding="utf-8")
    assert html.count('<img src="data:image/webp;base64,') == 2
    assert 'href="../runs/a/page.html"' in html


def test_development_seeds_and_offline_rows_are_told() -> None:
    found = summarise([_row("team", 3, "success", "offline")], [{"methods": ["team"], "models": ["offline"]}])
    assert any("development seeds" in text for text in found.warnings())
    assert any("OFFLINE" in text for text in found.warnings())


def test_the_papers_figures_carry_n_and_source() -> None:
    figure = paper_figure("tabletop/rotate", "team")
    assert figure is not None
    assert (figure.percent, figure.n) == (100.0, 10)
    assert figure.interval is not None
    assert figure.interval[0] == pytest.approx(0.7225, abs=1e-3)
    ablated = paper_figure("tabletop/rotate", "team:s1")
    assert ablated is not None
    assert ablated.percent == 60.0
    assert paper_figure("tabletop/rotate", "team:-verification") == ablated
    assert paper_figure("tabletop/rotate", "team:-mover") is None
    rival = paper_figure("tabletop/novel_adj", "nlap:privileged")
    assert rival is not None
    assert (rival.percent, rival.n) == (43.0, None)
    assert paper_figure("tabletop/mine/cups", "team") is None


def test_an_unknown_baseline_and_a_missing_store_are_told(store: Path) -> None:
    with pytest.raises(ConfigError, match="the stores compare bad, good"):
        write_all([store], store.with_name("p.html"), baseline="nobody")
    with pytest.raises(ConfigError, match="no such file"):
        write_all([store.with_name("none.db")], store.with_name("p.html"))
    made = write_all([store], store.with_name("p.html"), baseline="good")
    assert [one.first.method for one in made.summary.pairs("good")] == ["bad"]


def test_it_says_what_was_run_here_and_may_run_no_script(store: Path) -> None:
    html = write_all([store], store.with_name("page.html")).page.read_text(encoding="utf-8")
    assert "<tr><th>run here</th><td>15 runs a task for each method and model</td></tr>" in html
    assert "default-src 'none'; img-src data:; style-src 'unsafe-inline'\">" in html
    assert "<script" not in html


def test_hidden_characters_of_a_reason_are_escapes_in_the_table_and_the_page(tmp_path: Path) -> None:
    with Store(tmp_path / "s.db") as store:
        plan = toy_plan(1)
        store.want(plan.name, plan.trials(), plan.request())
        owner = Owner.this_process()
        claim = store.claim(plan.name, owner)
        assert claim is not None
        reason = "no\x1b[2J \u202eway"
        store.finish(claim.trial, owner, TrialRow("failure", "plan", reason))
    made = write_all([tmp_path / "s.db"], tmp_path / "p.html")
    for path in (made.csv, made.page):
        text = path.read_text(encoding="utf-8")
        assert "no\\x1b[2J \\u202eway" in text
        assert not set(text) & set("\x1b\u202e")
