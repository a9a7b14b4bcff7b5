"""Every page that we write forbids scripts of others and loads nothing from elsewhere, in the same words."""

from __future__ import annotations

import re

import wonderful_team as wt
from tests.evals import runners
from tests.evals.runners import toy_plan
from wonderful_team.evals.report.content import link
from wonderful_team.evals.report.page import write_all
from wonderful_team.evals.study import run_study
from wonderful_team.pages.runs import write_runs_table

POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"


def policies(html: str) -> list[str]:
    return re.findall(r'<meta http-equiv="Content-Security-Policy" content="([^"]*)">', html)


def test_run_page_table_of_runs_and_report(tmp_path):
    world = wt.make_world("tabletop/visual_manipulation", seed=3)
    try:
        plan = wt.Team(out=tmp_path / "runs").plan(world.observe(), world.instruction)
    finally:
        world.close()
    run_study(toy_plan(3), tmp_path / "s.db", runners.quick, jobs=1)
    report = write_all([tmp_path / "s.db"], tmp_path / "report.html").page
    table = write_runs_table([plan.folder], tmp_path / "table.html")
    page, report, table = (path.read_text(encoding="utf-8") for path in (plan.page, report, table))
    assert policies(page) == policies(report) == [POLICY]
    # The table of runs has one script of ours, named by its hash.
    (allowed,) = policies(table)
    assert re.fullmatch(re.escape(POLICY) + r"; script-src 'sha256-[A-Za-z0-9+/]{43}='", allowed)
    assert table.count("<script") == 1
    for html in (page, report):
        assert "<script" not in html
    for html in (page, report, table):
        # Before the policy nothing that it could forbid has been read.
        assert not re.search(r"<(?:img|link|style|script|iframe)", html[: html.index("Content-Security-Policy")])


def test_a_link_is_always_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert link("javascript:alert(1)", tmp_path / "page.html") == "./javascript:alert(1)"
    assert link("runs/x/page.html", tmp_path / "page.html") == "runs/x/page.html"
