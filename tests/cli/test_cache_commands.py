"""Kept answers as a user meets them: `--cache`, `--cache-file`, `cache`, `doctor`."""

from __future__ import annotations

import json

import pytest

from tests.desk import WORDS, draw_desk
from wonderful_team import load_run
from wonderful_team.cli.app import run


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    return draw_desk(tmp_path_factory.mktemp("desk"))


def test_cache_only_without_an_answer_ends_with_exit_code_3(desk, tmp_path, capsys):
    file = tmp_path / "answers.sqlite"
    words = ["plan", str(desk / "desk.png"), WORDS, "--cache-file", str(file), "--cache"]
    assert run([*words, "only"]) == 3
    # Nothing was asked: the run has the request, and no call.
    record = load_run("latest").record
    assert record["planner"]["requests"][0]["failed"]["sent"] is False
    page = load_run("latest").page.read_text(encoding="utf-8")
    assert "<dt>calls</dt><dd>0</dd>" in page
    assert "refused before it was sent: --cache only" in page
    assert "holds no answer of offline to DraftPlan" in capsys.readouterr().err
    assert run([*words, "on"]) == 0
    first = capsys.readouterr().out.splitlines()[0]
    assert run([*words, "only"]) == 0
    again = capsys.readouterr()
    assert again.out.splitlines()[0] == first
    assert "0 calls, 0 pictures" in again.err
    assert "4 answers from the cache" in again.err


def test_cache_shows_and_clears_what_is_kept(desk, tmp_path, capsys, monkeypatch):
    file = tmp_path / "answers.sqlite"
    monkeypatch.setenv("WONDERFUL_TEAM_CACHE", str(file))
    assert run(["cache"]) == 0
    assert "nothing is kept" in capsys.readouterr().out
    assert run(["plan", str(desk / "desk.png"), WORDS, "--cache", "on"]) == 0
    capsys.readouterr()
    assert run(["cache", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)["result"]
    assert (result["by_model"], result["answers"]) == ({"offline": 4}, 4)
    assert run(["cache", "clear"]) == 0
    assert "4 answers dropped" in capsys.readouterr().out
    file.write_bytes(b"notes " * 1000)
    assert run(["cache", "clear"]) == 2
    assert file.read_bytes() == b"notes " * 1000


def test_nothing_is_kept_for_offline_unless_asked(desk, tmp_path, monkeypatch):
    file = tmp_path / "answers.sqlite"
    monkeypatch.setenv("WONDERFUL_TEAM_CACHE", str(file))
    assert run(["plan", str(desk / "desk.png"), WORDS]) == 0
    assert not file.exists()


def test_a_broken_file_is_wrong_use_before_anything_is_asked(desk, tmp_path, capsys):
    file = tmp_path / "answers.sqlite"
    file.write_text("my notes " * 500, encoding="utf-8")
    assert run(["plan", str(desk / "desk.png"), WORDS, "--cache", "on", "--cache-file", str(file)]) == 2
    assert "--cache-file FILE" in capsys.readouterr().err
    assert file.read_text(encoding="utf-8").startswith("my notes")


def test_doctor_tells_the_size_and_what_is_broken(tmp_path, monkeypatch):
    from wonderful_team.cli.doctor import _cache
    from wonderful_team.models.cache_store import CacheStore, Stored

    file = tmp_path / "answers.sqlite"
    monkeypatch.setenv("WONDERFUL_TEAM_CACHE", str(file))
    assert "nothing is kept yet" in _cache().text
    CacheStore(file).put("k", Stored({}, "", "m", "c"))
    assert "1 answer," in _cache().text
    file.write_text("my notes " * 500, encoding="utf-8")
    found = _cache()
    assert (found.ok, found.fix.startswith("mv ")) == (False, True)
